//! Functions of real numbers that give the same bits on every machine.
//!
//! Results of the platform's `sin` or `exp` differ between C libraries in the last bit, but a game
//! must not depend on the machine. `libm` is plain Rust; `sqrt` is exact by IEEE 754. `clippy.toml`
//! bans the platform's versions.

/// Sine and cosine of an angle in radians.
#[inline]
pub fn sin_cos(angle_rad: f64) -> (f64, f64) {
    libm::sincos(angle_rad)
}

/// Sine and cosine of an angle in degrees, exact at every quarter turn, so that fields along the
/// axes keep exact coordinates.
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
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power `x`.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Linear interpolation at `x` through `points` with ascending x, exact at each point and constant
/// beyond the ends.
///
/// # Panics
/// If `points` is empty.
pub fn interpolate(points: impl IntoIterator<Item = (f64, f64)>, x: f64) -> f64 {
    let mut points = points.into_iter();
    let mut before = points.next().expect("a line has a point");
    for after in points {
        if x < after.0 {
            let part = (after.1 - before.1) * (x - before.0) / (after.0 - before.0);
            return if x > before.0 {
                before.1 + part
            } else {
                before.1
            };
        }
        before = after;
    }
    before.1
}

/// The length of the vector (`x`, `y`).
#[inline]
pub fn length(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Formats a number to `places` decimal places; −0.0 becomes 0, because the two differ when
/// compared as strings.
pub fn decimal(number: f64, places: usize) -> String {
    let text = format!("{number:.places$}");
    if text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.trim_start_matches('-').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_goes_through_its_points_and_is_level_beyond_them() {
        let line = [
            (-100.0, -2.0),
            (0.0, 0.0),
            (40.0, 1.0),
            (80.0, 3.0),
            (100.0, 3.0),
        ];
        for (x, want) in [
            (-101.0, -2.0),
            (-100.0, -2.0),
            (-50.0, -1.0),
            (0.0, 0.0),
            (10.0, 0.25),
            (40.0, 1.0),
            (60.0, 2.0),
            (90.0, 3.0),
            (101.0, 3.0),
        ] {
            assert_eq!(interpolate(line, x), want, "{x}");
        }
        assert_eq!(interpolate([(1.0, 5.0)], 7.0), 5.0);
        assert_eq!(
            interpolate(line.map(|(x, y)| (y, x)), 3.0),
            100.0,
            "of two points at one place the last counts"
        );
    }
}
