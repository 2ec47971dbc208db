//! How near a contact would come: the closest point of approach of every course and speed.
//!
//! With the contact at `p` from the own ship, moving with `c`, and the own ship on course `d` (a unit vector) at speed
//! `s`, the contact moves past with `w = c - s d`. Its distance `|p + w t|` is least at
//!
//! ```text
//! t* = - p.w / w.w      held within 0 and the horizon,
//! ```
//!
//! since the square of the distance is a parabola in `t`.
//!
//! For a bound over a span of speeds: at any fixed time `t` the distance is convex in `s`, so its largest value is at an
//! end of the span; and since the closest approach is no farther than the distance at `t`, that is a bound for all of
//! the span. The other way round, a change of speed by `ds` moves the own ship by no more than `ds` times the horizon.

use wide::f32x8;

/// What one number in single precision may be wrong by, with room to spare, in parts of the lengths that went into it.
const ROUNDING: f64 = 1e-5;

/// A slope that stands for a step.
const STEP: f64 = 1e12;

/// Whether to keep away or to come close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// Farther is better: nothing at or below the least distance, `floor` just above it, from there linearly to 100 at
    /// the largest. MOOS-IvP avoids collisions with a floor of 25.
    Avoid {
        /// Utility just above the least distance, 0 to 100.
        floor: f64,
    },
    /// Closer is better: 100 at or below the least distance, linearly to nothing at the largest.
    Seek,
}

/// Utility of the distance at the closest point of approach to a contact that keeps its course and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The contact from the own ship, to the north, m.
    pub north_m: f64,
    /// The contact from the own ship, to the east, m.
    pub east_m: f64,
    /// Velocity of the contact to the north, m/s.
    pub velocity_north_m_s: f64,
    /// Velocity of the contact to the east, m/s.
    pub velocity_east_m_s: f64,
    /// How long the course and speed are kept, s.
    pub horizon_s: f64,
    /// The least distance that makes a difference, m.
    pub min_m: f64,
    /// The largest distance that makes a difference, m.
    pub max_m: f64,
    /// Keep away or come close.
    pub approach: Approach,
}

impl Closest {
    /// The function in single precision; none if a number is none or the horizon is negative.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let floor = match self.approach {
            Approach::Avoid { floor } => floor,
            Approach::Seek => 0.0,
        };
        let numbers = [self.north_m, self.east_m, self.velocity_north_m_s, self.velocity_east_m_s];
        let limits = [self.horizon_s, self.min_m, self.max_m, floor];
        let sound = numbers.iter().chain(&limits).all(|x| x.is_finite() && x.abs() < 1e7) && self.horizon_s >= 0.0;
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let floor = floor.clamp(0.0, 100.0);
        let width_m = self.max_m - self.min_m;
        let slope = if width_m > 0.0 { ((100.0 - floor) / width_m).min(STEP) } else { STEP };
        let reach_m = game::math::length(self.velocity_north_m_s, self.velocity_east_m_s) + speed_max_m_s;
        let scale_m = game::math::length(self.north_m, self.east_m) + reach_m * self.horizon_s;
        let splat = |x: f64| f32x8::splat(x as f32);
        Some(Ready {
            north: splat(self.north_m),
            east: splat(self.east_m),
            velocity_north: splat(self.velocity_north_m_s),
            velocity_east: splat(self.velocity_east_m_s),
            horizon: splat(self.horizon_s),
            min: splat(self.min_m),
            slope: splat(slope),
            floor: splat(floor),
            seek: self.approach == Approach::Seek,
            margin: splat(ROUNDING * scale_m),
        })
    }
}

/// The function in single precision, m and s throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    north: f32x8,
    east: f32x8,
    velocity_north: f32x8,
    velocity_east: f32x8,
    horizon: f32x8,
    min: f32x8,
    slope: f32x8,
    floor: f32x8,
    seek: bool,
    margin: f32x8,
}

impl Ready {
    /// Utilities of eight candidates.
    #[inline(always)]
    pub(super) fn utility(&self, north: f32x8, east: f32x8, speed: f32x8) -> f32x8 {
        let (w_north, w_east) = self.passing(north, east, speed);
        let t = self.time(w_north, w_east);
        self.worth(self.distance(w_north, w_east, t))
    }

    /// What no speed from `slow` to `fast` exceeds, on each of eight courses.
    #[inline]
    pub(super) fn bound(&self, north: f32x8, east: f32x8, slow: f32x8, fast: f32x8) -> f32x8 {
        let half = f32x8::splat(0.5);
        let (w_north, w_east) = self.passing(north, east, (slow + fast) * half);
        let t = self.time(w_north, w_east);
        if self.seek {
            return self.worth(self.distance(w_north, w_east, t) - (fast - slow) * half * self.horizon - self.margin);
        }
        // The ends of the span at the same time.
        let (slow, fast) = (self.passing(north, east, slow), self.passing(north, east, fast));
        let square = self.square(slow.0, slow.1, t).fast_max(self.square(fast.0, fast.1, t));
        self.worth(square.sqrt() + self.margin)
    }

    /// How the contact moves past, m/s.
    #[inline(always)]
    fn passing(&self, north: f32x8, east: f32x8, speed: f32x8) -> (f32x8, f32x8) {
        (self.velocity_north - speed * north, self.velocity_east - speed * east)
    }

    /// The time of the closest point of approach within the horizon, s.
    #[inline(always)]
    fn time(&self, w_north: f32x8, w_east: f32x8) -> f32x8 {
        let dot = self.north * w_north + self.east * w_east;
        // With hardly any motion past each other any time will do.
        let square = (w_north * w_north + w_east * w_east).fast_max(f32x8::splat(1e-20));
        (-dot / square).fast_max(f32x8::ZERO).fast_min(self.horizon)
    }

    /// The distance at a time, m.
    #[inline(always)]
    fn distance(&self, w_north: f32x8, w_east: f32x8, t: f32x8) -> f32x8 {
        self.square(w_north, w_east, t).sqrt()
    }

    /// The square of the distance at a time, m2.
    #[inline(always)]
    fn square(&self, w_north: f32x8, w_east: f32x8, t: f32x8) -> f32x8 {
        let (north, east) = (self.north + w_north * t, self.east + w_east * t);
        north * north + east * east
    }

    /// Utility of a distance.
    #[inline(always)]
    fn worth(&self, distance: f32x8) -> f32x8 {
        let full = f32x8::splat(100.0);
        let rise = (distance - self.min) * self.slope;
        if self.seek {
            (full - rise).fast_max(f32x8::ZERO).fast_min(full)
        } else {
            (self.floor + rise).fast_min(full) & distance.simd_gt(self.min)
        }
    }
}
