//! Positions in MAVLink messages, whose unit is 1e-7 degrees.

use primitives::frame::LatLon;

/// The latitude of a pole and the longitude of the date line, 1e-7 degrees.
pub(crate) const LAT_MAX_E7: u32 = 900_000_000;
pub(crate) const LON_MAX_E7: u32 = 1_800_000_000;

/// A latitude or longitude for a message.
pub(crate) fn e7(deg: f64) -> i32 {
    (1e7 * deg).round() as i32
}

/// The position in a message.
pub(crate) fn lat_lon((lat_e7, lon_e7): (i32, i32)) -> LatLon {
    LatLon {
        lat_deg: 1e-7 * f64::from(lat_e7),
        lon_deg: 1e-7 * f64::from(lon_e7),
    }
}

/// The position in a message if it is on the globe.
pub(crate) fn on_globe(at_e7: (i32, i32)) -> Option<LatLon> {
    let is_on_globe = at_e7.0.unsigned_abs() <= LAT_MAX_E7 && at_e7.1.unsigned_abs() <= LON_MAX_E7;
    is_on_globe.then(|| lat_lon(at_e7))
}
