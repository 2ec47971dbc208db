//! The coordinate frames of a boat: the field's north-east-down frame and the boat's own, with the
//! rotation between them.
//!
//! Inside Squall, positions are NED: `north_m` and `east_m` from the datum, headings in radians
//! clockwise from north. Files, the terminal and Python use x east, y north and compass degrees.

use crate::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A horizontal vector on the field: north and east, in metres or metres per second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ned {
    /// Towards true north.
    pub north: f64,
    /// Towards east.
    pub east: f64,
}

/// A vector in a boat's own frame: ahead and to starboard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Towards the bow.
    pub ahead: f64,
    /// Towards the starboard side.
    pub starboard: f64,
}

/// Position and heading of a boat.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of the midship point relative to the datum, m.
    pub at: Ned,
    /// Heading, radians clockwise from north.
    pub psi_rad: f64,
}

/// A boat's motion in the last tick: positions of the midship point before and after.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Position before the tick.
    pub from: Ned,
    /// Position after the tick.
    pub to: Ned,
}

/// A heading as its sine and cosine: the rotation between a boat's own frame and the field's.
///
/// Computed once per tick and boat, so that rotations need no further sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Sine of the heading.
    pub sin: f64,
    /// Cosine of the heading.
    pub cos: f64,
}

/// A geographic position, WGS 84.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LatLon {
    /// Latitude, degrees north.
    #[schemars(range(min = -90, max = 90))]
    pub lat_deg: f64,
    /// Longitude, degrees east.
    #[schemars(range(min = -180, max = 180))]
    pub lon_deg: f64,
}

impl Ned {
    /// The vector (`x` east, `y` north) of files and charts.
    pub fn from_xy(x_east: f64, y_north: f64) -> Ned {
        Ned {
            north: y_north,
            east: x_east,
        }
    }

    /// The unit vector along a compass bearing in degrees, exact at quarter turns.
    pub fn toward_deg(bearing_deg: f64) -> Ned {
        Rotation::from_heading_deg(bearing_deg).ahead()
    }

    /// This vector times `factor`.
    #[inline]
    pub fn scaled(self, factor: f64) -> Ned {
        Ned {
            north: self.north * factor,
            east: self.east * factor,
        }
    }

    /// The scalar product with `other`.
    #[inline]
    pub fn dot(self, other: Ned) -> f64 {
        self.north * other.north + self.east * other.east
    }

    /// The length.
    #[inline]
    pub fn length(self) -> f64 {
        math::length(self.north, self.east)
    }

    /// The squared distance to `other`.
    #[inline]
    pub fn distance_squared(self, other: Ned) -> f64 {
        let n = self.north - other.north;
        let e = self.east - other.east;
        n * n + e * e
    }

    /// The distance to `other`.
    #[inline]
    pub fn distance(self, other: Ned) -> f64 {
        self.distance_squared(other).sqrt()
    }

    /// The nearest of `places`; the first if several are equally near.
    pub fn nearest_of(self, places: impl Iterator<Item = Ned>) -> Option<Ned> {
        places.min_by(|x, y| {
            self.distance_squared(*x)
                .total_cmp(&self.distance_squared(*y))
        })
    }

    /// The bearing of `other` from this position, radians clockwise from north.
    #[inline]
    pub fn bearing_rad(self, other: Ned) -> f64 {
        math::atan2(other.east - self.east, other.north - self.north)
    }

    /// The direction of this vector, radians clockwise from north.
    #[inline]
    pub fn direction_rad(self) -> f64 {
        math::atan2(self.east, self.north)
    }

    /// Whether both components are finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.north.is_finite() && self.east.is_finite()
    }
}

impl std::ops::Add for Ned {
    type Output = Ned;
    #[inline]
    fn add(self, other: Ned) -> Ned {
        Ned {
            north: self.north + other.north,
            east: self.east + other.east,
        }
    }
}

impl std::ops::Sub for Ned {
    type Output = Ned;
    #[inline]
    fn sub(self, other: Ned) -> Ned {
        Ned {
            north: self.north - other.north,
            east: self.east - other.east,
        }
    }
}

impl Rotation {
    /// The rotation for heading north: both frames are parallel.
    pub const NORTH: Rotation = Rotation { sin: 0.0, cos: 1.0 };

    /// The rotation for a heading, radians clockwise from north.
    #[inline]
    pub fn from_heading(psi_rad: f64) -> Rotation {
        let (sin, cos) = math::sin_cos(psi_rad);
        Rotation { sin, cos }
    }

    /// The rotation for a compass heading in degrees, exact at quarter turns.
    pub fn from_heading_deg(heading_deg: f64) -> Rotation {
        let (sin, cos) = math::sin_cos_deg(heading_deg);
        Rotation { sin, cos }
    }

    /// The rotation for a heading further clockwise by `by`.
    #[inline]
    pub fn turned(self, by: Rotation) -> Rotation {
        Rotation {
            sin: self.sin * by.cos + self.cos * by.sin,
            cos: self.cos * by.cos - self.sin * by.sin,
        }
    }

    /// The unit vector ahead.
    #[inline]
    pub fn ahead(self) -> Ned {
        Ned {
            north: self.cos,
            east: self.sin,
        }
    }

    /// The unit vector to starboard.
    #[inline]
    pub fn starboard(self) -> Ned {
        Ned {
            north: -self.sin,
            east: self.cos,
        }
    }
}

impl Pose {
    /// The rotation of its heading.
    #[inline]
    pub fn rotation(self) -> Rotation {
        Rotation::from_heading(self.psi_rad)
    }
}

/// Converts a body vector to the field's frame.
#[inline]
pub fn ned_from_body(rotation: Rotation, body: Body) -> Ned {
    Ned {
        north: rotation.cos * body.ahead - rotation.sin * body.starboard,
        east: rotation.sin * body.ahead + rotation.cos * body.starboard,
    }
}

/// Converts a vector of the field's frame to body axes.
#[inline]
pub fn body_from_ned(rotation: Rotation, ned: Ned) -> Body {
    Body {
        ahead: rotation.cos * ned.north + rotation.sin * ned.east,
        starboard: -rotation.sin * ned.north + rotation.cos * ned.east,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ahead_of_a_boat_that_points_east_is_east() {
        let turn = Rotation::from_heading_deg(90.0);
        let ned = ned_from_body(
            turn,
            Body {
                ahead: 2.0,
                starboard: 1.0,
            },
        );
        assert_eq!(
            ned,
            Ned {
                north: -1.0,
                east: 2.0
            }
        );
        assert_eq!(
            body_from_ned(turn, ned),
            Body {
                ahead: 2.0,
                starboard: 1.0
            }
        );
    }

    #[test]
    fn bearings_are_clockwise_from_north() {
        let home = Ned::default();
        for (x, y, want_deg) in [
            (0.0, 1.0, 0.0),
            (1.0, 0.0, 90.0),
            (0.0, -1.0, 180.0),
            (-1.0, 0.0, -90.0),
        ] {
            let got_deg = home.bearing_rad(Ned::from_xy(x, y)).to_degrees();
            assert!((got_deg - want_deg).abs() < 1e-12, "{x},{y} -> {got_deg}");
        }
    }
}
