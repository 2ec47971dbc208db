//! From files as typed to what the program believes: estimates, and rules that combine several values.
//!
//! What a single value may be says its declaration, and has been checked when a check gets it. Every check
//! notes all it finds in the [`Diagnostics`] and returns `None` if anything was wrong.

mod algorithm;
mod boat;
mod fault;
mod field;
mod file_cache;
mod game;
mod gateway;
mod polygon;
mod rewards;
mod rules;
mod sea;
mod start_position;
mod strategy;
mod sweep;
mod tournament;
mod training;

pub(super) use boat::boat;
pub(super) use field::field;

pub(super) use game::game;
pub(super) use gateway::gateway;
pub(super) use rewards::rewards;
pub(super) use rules::rules;
pub(super) use sea::sea;
pub(super) use strategy::strategy_file;
pub(super) use sweep::sweep;
pub(super) use tournament::tournament;
pub(super) use training::training;

#[cfg(doc)]
use super::diagnostics::Diagnostics;
