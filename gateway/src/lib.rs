//! The door to real boats.

pub mod declination;
pub mod geodesy;
pub mod nmea;
