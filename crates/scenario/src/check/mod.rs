//! From files as typed to what the program believes: estimates, and rules that combine several values.
//!
//! What a single value may be says its declaration, and has been checked when a check gets it. Every check
//! notes all it finds in the [`Diagnostics`] and returns `None` if anything was wrong.

mod boat;
mod fault;
mod field;
mod file_cache;
mod game;
mod polygon;
mod rules;
mod sea;
mod start_position;
mod strategy;

pub(super) use boat::boat;
pub(super) use field::field;

pub use boat::check_thrust_map;
pub(super) use game::game;
pub use polygon::check_corners;
pub(super) use rules::rules;
pub(super) use sea::sea;
pub use strategy::StrategyFiles;
pub(super) use strategy::{strategy, strategy_file};

#[cfg(doc)]
use super::diagnostics::Diagnostics;
