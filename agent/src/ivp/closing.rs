//! How fast the own ship comes nearer to a point or a contact, or draws away from it.

use game::Ned;
use wide::f32x8;

/// Utility of the rate of closure: linear from 0, opening as fast as own ship and contact could, to 100, closing as fast
/// as they could.
///
/// The rate of closure is the sum of both velocities along the line of sight, at this moment. With no distance there is no
/// line of sight, and all candidates are worth 50.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// The contact from the own ship, m.
    pub offset: Ned,
    /// Velocity of the contact, m/s; 0 for a point.
    pub velocity: Ned,
}

impl Closing {
    /// The function in single precision; none if a number is not finite.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let numbers = [self.offset.north, self.offset.east, self.velocity.north, self.velocity.east];
        let sound = numbers.iter().all(|x| x.is_finite() && x.abs() < 1e7);
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let range_m = self.offset.length();
        let (sight_north, sight_east) =
            if range_m > 0.0 { (self.offset.north / range_m, self.offset.east / range_m) } else { (0.0, 0.0) };
        let contact_m_s = self.velocity.length();
        let towards_m_s = -(sight_north * self.velocity.north + sight_east * self.velocity.east);
        let slope = 50.0 / (speed_max_m_s + contact_m_s);
        let splat = |x: f64| f32x8::splat(x as f32);
        Some(Ready {
            north: splat(sight_north),
            east: splat(sight_east),
            slope: splat(slope),
            rest: splat(50.0 + slope * towards_m_s),
        })
    }
}

/// The function in single precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    /// The line of sight, a unit vector.
    north: f32x8,
    east: f32x8,
    /// Utility for each m/s along it.
    slope: f32x8,
    /// Utility at rest.
    rest: f32x8,
}

impl Ready {
    /// Utilities of eight candidates.
    #[inline(always)]
    pub(super) fn utility(&self, north: f32x8, east: f32x8, speed: f32x8) -> f32x8 {
        let along = (self.north * north + self.east * east) * self.slope;
        (self.rest + along * speed).fast_max(f32x8::ZERO).fast_min(f32x8::splat(100.0))
    }

    /// What no speed from `slow` to `fast` exceeds, on each of eight courses: on one course utility only rises or only
    /// falls with speed, and rounding keeps that order.
    #[inline]
    pub(super) fn bound(&self, north: f32x8, east: f32x8, slow: f32x8, fast: f32x8) -> f32x8 {
        self.utility(north, east, slow).fast_max(self.utility(north, east, fast))
    }
}
