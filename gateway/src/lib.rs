//! The gateway to real boats: Surveyor NMEA both ways, links, a safety supervisor, and an emulated
//! boat.
//!
//! Open [`supervisor`] first (when a boat may be driven), then [`bridge`] (which combines reports,
//! orders and navigation), then [`protocol`] and [`nmea`]. `emulator` is the boat's end of the
//! link. Sockets and clocks are only in [`link`] and `node`.

mod bow_watch;
pub mod bridge;
mod compass_check;
pub mod config;
pub mod declination;
#[cfg(feature = "emulator")]
pub mod emulator;
#[cfg(feature = "net")]
mod game_clock;
pub mod geodesy;
pub mod geofence;
pub mod link;
mod lithium;
pub mod mavlink;
mod motion_check;
mod nav_estimate;
pub mod nmea;
#[cfg(feature = "net")]
pub mod node;
pub mod preflight;
pub mod protocol;
pub mod record;
pub mod replay;
pub mod sensor_check;
pub mod set_point;
pub mod supervisor;
pub mod thrust_check;
