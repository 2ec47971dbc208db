//! The door to real boats: Surveyor NMEA both ways, links, a safety supervisor, and an emulated boat.
//!
//! Open [`supervisor`] first (when a boat may be driven), then [`bridge`] (how sentences, orders and navigation meet), then
//! [`nmea`]. [`emulator`] is the other end of the line. Sockets and clocks are in [`link`] and `node` alone.

pub mod bridge;
pub mod declination;
pub mod emulator;
pub mod estimate;
pub mod geodesy;
pub mod geofence;
pub mod link;
pub mod nmea;
#[cfg(feature = "net")]
pub mod node;
pub mod record;
pub mod replay;
pub mod set_point;
pub mod supervisor;
pub mod survey;
mod thrust_map;
pub mod utc;
