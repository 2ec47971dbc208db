//! The unit of a key, given by the end of its name.

/// A unit of numbers in files.
pub(super) struct Unit {
    /// The end of a key with this unit.
    end: &'static str,
    /// Its name in messages.
    pub(super) name: &'static str,
    /// Converts a number to the unit of its field: SI and radians, except per cent.
    pub(super) to_si: fn(f64) -> f64,
}

const fn unit(end: &'static str, name: &'static str, to_si: fn(f64) -> f64) -> Unit {
    Unit { end, name, to_si }
}

/// A unit that ends with another unit must precede it.
const UNITS: [Unit; 16] = [
    unit("_pct_per_deg_s", "per cent per degree/s", f64::to_degrees),
    unit("_pct_per_deg", "per cent per degree", f64::to_degrees),
    unit("_deg_s", "degrees/s", f64::to_radians),
    unit("_deg", "degrees", f64::to_radians),
    unit("per_hour", "1/h", |number| number / 3600.0),
    unit("_wh", "W h", |number| 3600.0 * number),
    unit("_h", "h", |number| 3600.0 * number),
    unit("_km", "km", |number| 1000.0 * number),
    unit("_rad_s", "rad/s", |number| number),
    unit("_m_s", "m/s", |number| number),
    unit("_newton", "newton", |number| number),
    unit("_kg", "kg", |number| number),
    unit("_pct", "per cent", |number| number),
    unit("_w", "W", |number| number),
    unit("_m", "m", |number| number),
    unit("_s", "s", |number| number),
];

impl Unit {
    /// The unit of a key, if its name has one.
    pub(super) fn of(key: &str) -> Option<&'static Unit> {
        UNITS.iter().find(|unit| key.ends_with(unit.end))
    }
}
