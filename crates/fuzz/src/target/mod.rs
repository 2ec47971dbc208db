//! The kinds of input, and what is promised of each.

mod address;
mod exo2;
mod keys;
mod mavlink;
mod message;
mod model;
mod nmea;
mod page;
mod recording;
mod request;
mod scenario;
mod sheet;

use crate::Dice;

/// Makes another input of real ones.
pub type Change = Box<dyn Fn(&mut Dice) -> Vec<u8>>;

/// A kind of input.
#[derive(Clone, Copy)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    /// Real inputs.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// What makes others of them.
    pub change: fn(Vec<Vec<u8>>) -> Change,
    /// Checks every promise on an input; panics where one is broken.
    pub check: fn(&[u8]),
    /// What a check may allocate in all, bytes: so much, and so many times the input's length.
    pub allocated_max: (usize, usize),
}

/// All of them.
pub const TARGETS: [Target; 12] = [
    address::TARGET,
    exo2::TARGET,
    keys::TARGET,
    mavlink::TARGET,
    message::TARGET,
    model::TARGET,
    nmea::TARGET,
    page::TARGET,
    recording::TARGET,
    request::TARGET,
    scenario::TARGET,
    sheet::TARGET,
];

/// The target of this name.
#[must_use]
pub fn named(name: &str) -> Option<Target> {
    TARGETS.into_iter().find(|target| target.name == name)
}

/// Changes of texts.
fn texts(seeds: Vec<Vec<u8>>) -> Change {
    let pieces = crate::change::text::Pieces::of(&seeds);
    Box::new(move |dice| pieces.change(&seeds, dice))
}

/// Changes of binary inputs.
fn binaries(seeds: Vec<Vec<u8>>) -> Change {
    Box::new(move |dice| crate::change::binary::change(&seeds, dice))
}

/// Checks what a person is shown: so many lines at most, none of which is endless or steers the terminal.
fn check_shown(error: &dyn std::fmt::Display) {
    let shown = primitives::printable::message(&error.to_string());
    assert!(!shown.trim().is_empty(), "an error that says nothing");
    for line in shown.lines() {
        assert!(line.chars().count() < 2100, "{} characters: {line:.200}", line.chars().count());
        assert!(!line.contains(|c: char| c.is_control()), "{line:?}");
    }
}
