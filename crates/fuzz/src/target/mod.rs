//! The kinds of input and their guarantees.

mod address;
mod import;
mod keys;
mod mavlink;
mod message;
mod model;
mod moos;
mod nmea;
mod page;
mod recording;
mod request;
mod scenario;
mod sheet;

use crate::Dice;
use crate::change::change;
use std::fmt::{Debug, Display};

/// Generates a new input from real ones.
pub type Change = Box<dyn Fn(&mut Dice) -> Vec<u8>>;

/// A kind of input.
#[derive(Clone, Copy)]
pub struct Target {
    /// The name on the command line.
    pub name: &'static str,
    /// Real inputs.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Builds the mutator for real inputs.
    pub change: fn(Vec<Vec<u8>>) -> Change,
    /// Checks all guarantees on an input. Panics if one is violated.
    pub check: fn(&[u8]),
    /// Limit on the total bytes allocated by a check: a constant, and a multiple of the input's
    /// length.
    pub allocated_max: (usize, usize),
}

/// All targets.
pub const TARGETS: [Target; 13] = [
    address::TARGET,
    import::TARGET,
    keys::TARGET,
    mavlink::TARGET,
    message::TARGET,
    model::TARGET,
    moos::TARGET,
    nmea::TARGET,
    page::TARGET,
    recording::TARGET,
    request::TARGET,
    scenario::TARGET,
    sheet::TARGET,
];

/// The target with this name.
pub fn named(name: &str) -> Option<Target> {
    TARGETS.into_iter().find(|target| target.name == name)
}

fn mutations(seeds: Vec<Vec<u8>>) -> Change {
    Box::new(move |dice| {
        let seed = &seeds[dice.roll(seeds.len())];
        change(seed, &seeds, dice)
    })
}

/// The result of `read` for chunks of any size, which must be the same as for all bytes at once.
fn in_pieces<T: PartialEq + Debug>(bytes: &[u8], read: impl Fn(usize) -> T) -> T {
    let whole = read(usize::MAX);
    let step = 1 + usize::from(bytes.first().copied().unwrap_or_default()) % 97;
    for size in [1, step] {
        assert_eq!(read(size), whole, "in pieces of {size}");
    }
    whole
}

/// Checks an error as displayed: few lines, each of limited length and without terminal control
/// characters.
fn check_shown(error: &dyn Display) {
    let shown = primitives::printable::message(&error.to_string());
    assert!(!shown.trim().is_empty(), "an empty error");
    for line in shown.lines() {
        assert!(
            line.chars().count() < 2100,
            "{} characters: {line:.200}",
            line.chars().count()
        );
        assert!(!line.contains(|c: char| c.is_control()), "{line:?}");
    }
}
