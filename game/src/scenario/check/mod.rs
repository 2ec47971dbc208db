//! From files as typed to what the program believes: one function a kind of file.
//!
//! Every check notes all it finds in the [`Diagnostics`] and returns `None` if anything was wrong.

mod boat;
mod field;
mod game;
mod gateway;
mod link;
mod rules;
mod sea;
mod start_position;
mod strategy;
mod tournament;

pub(super) use boat::boat;
pub(super) use field::field;
pub(super) use game::game;
pub(super) use gateway::gateway;
pub(super) use rules::rules;
pub(super) use sea::sea;
pub(super) use strategy::strategy;
pub(super) use tournament::tournament;

use super::diagnostics::Diagnostics;
use super::raw::At;

/// Notes that `key` must name a file and does not.
fn missing_path(diagnostics: &mut Diagnostics, owner: usize, key: &str) {
    diagnostics.note_missing(owner, key, "the path of a file");
}

/// A copy of `given` for another type of value at the same place.
fn same_place<T, U>(given: &At<T>, value: U) -> At<U> {
    At { value, at: given.at }
}
