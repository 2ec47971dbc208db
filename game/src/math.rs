//! Functions of real numbers that give the same bits on every machine.
//!
//! The platform's own `sin` or `exp` differ between C libraries in the last bit, and a game must not
//! depend on the machine it runs on. `libm` is plain Rust; `sqrt` is exact by IEEE 754. `clippy.toml`
//! bans the platform's versions in favour of these.

/// Sine and cosine of an angle in radians.
#[inline]
#[must_use]
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    libm::sincos(angle_rad)
}

/// Sine and cosine of an angle in degrees, exact at every quarter turn: fields laid along the axes
/// keep exact coordinates.
#[must_use]
pub fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    let turn = angle_deg - 360.0 * (angle_deg / 360.0).floor();
    match turn {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => sin_cos(angle_deg.to_radians()),
    }
}

/// The angle of the vector (`x`, `y`) from the x axis, in -pi to pi.
#[inline]
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power `x`.
#[inline]
#[must_use]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// The length of the vector (`x`, `y`).
#[inline]
#[must_use]
pub fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}
