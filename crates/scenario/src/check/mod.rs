//! Converts files as written to checked types: estimates missing values, and checks rules that
//! involve several values.
//!
//! The schema has already checked the range of each value. Every check reports all faults in the
//! `Diagnostics` of the loader and returns `None` if there were any.

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

pub use boat::check_thrust_map;
pub use polygon::check_corners;
