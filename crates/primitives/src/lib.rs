//! Foundations of all crates: angles, frames, time, IDs, random streams, byte encoding.
//!
//! Every transcendental function and every random number in the simulation comes from [`math`] or
//! [`stream`], so that the same seed gives the same bits on every machine.

pub mod angle;
pub mod codec;
pub mod frame;
pub mod id;
pub mod input_file;
pub mod instructions;
pub mod math;
pub mod near;
mod normal;
pub mod output_file;
pub mod printable;
pub mod reseed;
pub mod stamp;
pub mod stream;
pub mod time;

pub use frame::{Body, LatLon, Leg, Ned, Pose, Rotation};
pub use id::{FlagId, TeamId, VehicleId};
pub use time::SimTime;

/// The version of Squall, which every node reports when it joins a game.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
