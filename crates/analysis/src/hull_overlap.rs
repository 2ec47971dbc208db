//! Whether two hulls touch, approximated by their bounding rectangles.

use primitives::{Ned, Pose};

/// A hull as its bounding rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullRectangle {
    /// Position of its centre, and heading.
    pub pose: Pose,
    /// Length, m.
    pub length_m: f64,
    /// Beam, m.
    pub beam_m: f64,
}

impl HullRectangle {
    /// Half of its extent along an axis (a unit vector), m.
    fn half_m(&self, axis: Ned) -> f64 {
        let rotation = self.pose.rotation();
        let ahead = rotation.ahead().dot(axis).abs();
        let starboard = rotation.starboard().dot(axis).abs();
        0.5 * (self.length_m * ahead + self.beam_m * starboard)
    }

    /// Whether this rectangle overlaps `other`: no side of either is a separating axis.
    pub fn overlaps(&self, other: &HullRectangle) -> bool {
        let line = other.pose.at - self.pose.at;
        let axes = [self.pose.rotation(), other.pose.rotation()]
            .map(|rotation| [rotation.ahead(), rotation.starboard()]);
        axes.into_iter()
            .flatten()
            .all(|axis| line.dot(axis).abs() < self.half_m(axis) + other.half_m(axis))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_touch_where_no_side_separates_them() {
        let hull = |north, east, deg: f64| HullRectangle {
            pose: Pose {
                at: Ned { north, east },
                psi_rad: deg.to_radians(),
            },
            length_m: 2.0,
            beam_m: 1.0,
        };
        for (what, other, want) in [
            ("side by side, apart", hull(0.0, 1.01, 0.0), false),
            ("side by side, touching", hull(0.0, 0.99, 0.0), true),
            ("bow to stern, apart", hull(2.01, 0.0, 0.0), false),
            ("bow to stern, touching", hull(1.99, 0.0, 0.0), true),
            ("a bow at the side, apart", hull(0.0, 1.51, 90.0), false),
            ("a bow at the side, touching", hull(0.0, 1.49, 90.0), true),
            // The corner is 1.5 / sqrt(2) = 1.06 m from its centre.
            ("a corner at the side, apart", hull(0.0, 1.57, 45.0), false),
            (
                "a corner at the side, touching",
                hull(0.0, 1.55, 45.0),
                true,
            ),
        ] {
            assert_eq!(hull(0.0, 0.0, 0.0).overlaps(&other), want, "{what}");
            assert_eq!(
                other.overlaps(&hull(0.0, 0.0, 0.0)),
                want,
                "{what}, the other way round"
            );
        }
    }
}
