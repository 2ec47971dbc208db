//! Angles, and the two conversions between degrees and radians.

use std::f64::consts::{PI, TAU};

/// Wraps an angle to -pi (excluded) to pi (included).
///
/// An angle already in range costs two comparisons.
#[inline]
pub fn wrap_pi(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let turned = angle_rad - TAU * (angle_rad / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

/// A compass heading in degrees (0 to 360) from an angle in radians.
pub fn compass_deg_from_rad(angle_rad: f64) -> f64 {
    let degrees = angle_rad.to_degrees();
    let turned = degrees - 360.0 * (degrees / 360.0).floor();
    if turned >= 360.0 { 0.0 } else { turned }
}

/// An angle in radians (-pi to pi) from a compass heading in degrees.
pub fn rad_from_compass_deg(heading_deg: f64) -> f64 {
    wrap_pi(heading_deg.to_radians())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_and_a_bit_is_just_the_bit() {
        for (input_deg, want_deg) in [
            (0.0, 0.0),
            (190.0, -170.0),
            (-190.0, 170.0),
            (540.0, 180.0),
            (-180.0, 180.0),
            (725.0, 5.0),
        ] {
            let got_deg = wrap_pi(f64::to_radians(input_deg)).to_degrees();
            assert!(
                (got_deg - want_deg).abs() < 1e-9,
                "{input_deg} -> {got_deg}"
            );
        }
    }

    #[test]
    fn a_compass_never_shows_360() {
        for (input_rad, want_deg) in [(0.0, 0.0), (-1e-18, 0.0), (-PI / 2.0, 270.0), (TAU, 0.0)] {
            let got_deg = compass_deg_from_rad(input_rad);
            assert!(
                (got_deg - want_deg).abs() < 1e-9,
                "{input_rad} -> {got_deg}"
            );
        }
    }
}
