//! The door to real boats.

pub mod bridge;
pub mod declination;
pub mod emulator;
pub mod estimate;
pub mod fence;
pub mod front_seat;
pub mod geodesy;
pub mod link;
pub mod nmea;
#[cfg(feature = "net")]
pub mod node;
pub mod record;
pub mod replay;
pub mod supervisor;
