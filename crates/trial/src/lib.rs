//! Sea trials: one boat in open water, with a recorded series of commands or a standard manoeuvre.
//!
//! Read [`replay`] first. The command line handles files, units and plots; this crate handles the
//! boat. [`identify`] fits a boat file to a recorded run.

mod command;
mod drift;
pub mod identify;
mod manoeuvre;
mod measure;
mod observed_sea;
mod orders;
mod replay;
mod sample;
mod sheet;
mod trial_boat;
mod water;

pub use command::{Command, Engine, Pair};
pub use drift::Drift;
pub use manoeuvre::{Manoeuvre, Plan, Sailed, sail, turned_rad};
pub use measure::{Measure, measures};
pub use observed_sea::{Measured, NoSea, ObservedDrift, ObservedSea, ObservedWaves, Track};
pub use orders::{LONGEST_S, Orders};
pub use replay::{ROW, Unsound, replay, ticks_per_row};
pub use sample::{COLUMNS, Sample, write_csv};
pub use sheet::{Mistake, Sheet, plain_head};
pub use trial_boat::{Start, TrialBoat};
pub use water::{open_field, set_mean_current, still_sea};
