//! Experiments: many games, what is measured of each, and what all of them say together.
//!
//! A plan says which games there are. The pipeline plays them on all cores and hands over a row for each, in order. Reports are made of rows:
//! [`tournament`] ranks strategies against each other, and remembers the games of a league; [`sweep`] varies a scenario.

mod estimate;
mod jobs;
mod packed;
mod pipeline;
pub mod sweep;
pub mod tournament;

pub use estimate::Estimate;
pub use jobs::threads;
pub use packed::{Packed, UnpackError};
pub use pipeline::Game;
