//! Experiments: many games, measurements of each, and statistics over all of them.
//!
//! A plan lists the games. The pipeline plays them on all cores and returns a row for each, in
//! order. Reports are made from rows: [`tournament`] ranks strategies and keeps the games of a
//! league; [`sweep`] varies a scenario; [`whatif`] plays futures of a recorded game, and
//! [`turning`] finds the moments that decided it.

mod checksum;
mod estimate;
mod jobs;
mod packed;
mod pipeline;
pub mod sweep;
pub mod tournament;
pub mod turning;
pub mod whatif;

pub use estimate::Estimate;
pub use jobs::threads;
pub use packed::{Packed, UnpackError};
pub use pipeline::{Game, run_in_order};
