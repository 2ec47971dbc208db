//! Converts files as typed to checked types: estimates missing values and applies rules that
//! combine several values.
//!
//! The schema has already checked the range of each value. Every check reports all faults in the
//! [`Diagnostics`] and returns `None` if there were any.

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
