//! The rate at which own ship closes on, or moves away from, a point or contact.

use super::cell::Cell;
use super::lanes::{larger, smaller};
use primitives::Ned;

/// Utility of the closing speed: linear from 0 (opening at the maximum possible rate) to 100
/// (closing at that rate).
///
/// The closing speed is the sum of both boats' speeds along the current line of sight. At zero
/// distance there is no line of sight, and all candidates get 50.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// The contact's position relative to own ship, m.
    pub offset: Ned,
    /// Velocity of the contact, m/s; 0 for a point.
    pub velocity: Ned,
}

impl Closing {
    /// The function in single precision; `None` if a number is non-finite.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let numbers = [
            self.offset.north,
            self.offset.east,
            self.velocity.north,
            self.velocity.east,
        ];
        let sound = numbers.iter().all(|x| x.is_finite() && x.abs() < 1e7);
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let range_m = self.offset.length();
        let (sight_north, sight_east) = if range_m > 0.0 {
            (self.offset.north / range_m, self.offset.east / range_m)
        } else {
            (0.0, 0.0)
        };
        let contact_m_s = self.velocity.length();
        let towards_m_s = -(sight_north * self.velocity.north + sight_east * self.velocity.east);
        // Scale by own ship's top speed plus the contact's speed, so that the utility uses its full
        // range for any contact.
        let slope = 50.0 / (speed_max_m_s + contact_m_s);
        Some(Ready {
            north: sight_north as f32,
            east: sight_east as f32,
            slope: slope as f32,
            rest: (50.0 + slope * towards_m_s) as f32,
        })
    }
}

/// The function in single precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    /// The line of sight, a unit vector.
    north: f32,
    east: f32,
    /// Utility per m/s along the line of sight.
    slope: f32,
    /// Utility at zero speed.
    rest: f32,
}

/// Maximum rounding error of a bound, in points of utility, with a margin.
const ROUNDING: f32 = 1e-3;

impl Ready {
    /// Utility of a course (a unit vector) at a speed (m/s).
    #[inline(always)]
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        let along = (self.north * north + self.east * east) * self.slope;
        smaller(larger(self.rest + along * speed, 0.0), 100.0)
    }

    /// Upper bound over a cell: utility is linear in velocity, so it is largest at a corner.
    #[inline(always)]
    pub(super) fn bound(&self, cell: &Cell) -> f32 {
        let along =
            |(north, east): (f32, f32)| (self.north * north + self.east * east) * self.slope;
        let [a, b, c, d] = cell.corners().map(along);
        let most = larger(larger(a, b), larger(c, d));
        smaller(larger(self.rest + most + ROUNDING, 0.0), 100.0)
    }
}
