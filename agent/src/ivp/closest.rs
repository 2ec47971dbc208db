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
//! A boat does not turn at once: with a [`Lag`] it goes on as it goes for a while, the longer the more it must turn, and only
//! then as the candidate says. The least distance of both legs counts.
//!
//! For a bound over a span of speeds: at any fixed time `t` the distance is convex in `s`, so its largest value is at an
//! end of the span; and since the closest approach is no farther than the distance at `t`, that is a bound for all of
//! the span. The other way round, a change of speed by `ds` moves the own ship by no more than `ds` times the horizon.

use game::Ned;
use wide::f32x8;

/// What one number in single precision may be wrong by, with room to spare, in parts of the lengths that went into it.
const ROUNDING: f64 = 1e-5;

/// A slope that stands for a step.
const STEP: f64 = 1e12;

/// Whether to keep away or to come close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// Farther is better: linearly from nothing where they touch to `at_min` at the least, and from there to 100 at the
    /// largest. MOOS-IvP makes a step of 25 at the least distance and calls all below it worth nothing, so that a boat
    /// that is too near already does not care how much nearer it comes.
    Avoid {
        /// Utility at the least distance, 0 to 100.
        at_min: f64,
    },
    /// Closer is better: 100 at or below the least distance, linearly to nothing at the largest.
    Seek,
}

/// Utility of the distance at the closest point of approach to a contact that keeps its course and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The contact from the own ship, m.
    pub offset: Ned,
    /// Velocity of the contact, m/s.
    pub velocity: Ned,
    /// How long the course and speed are kept, s.
    pub horizon_s: f64,
    /// The least distance to keep, m.
    pub min_m: f64,
    /// The largest distance that makes a difference, m.
    pub max_m: f64,
    /// The distance at which they touch, m: nothing is worth less.
    pub touch_m: f64,
    /// Keep away or come close.
    pub approach: Approach,
    /// How long the own ship goes on as it goes; none if it does as decided at once.
    pub lag: Option<Lag>,
}

/// How slow the own ship is to follow: it goes on with its present velocity for the reaction time, and for as long again as
/// half of its turn takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Present velocity of the own ship, m/s.
    pub velocity: Ned,
    /// Present heading, as a unit vector.
    pub heading: Ned,
    /// Until a decision shows at all, s.
    pub reaction_s: f64,
    /// How fast it turns, rad/s.
    pub turn_rad_s: f64,
}

/// The angle of a turn is close to this many times the chord that it spans on a circle of radius 1: between 1 for small turns
/// and half of pi for half a turn.
const ANGLE_OF_CHORD: f64 = 1.15;

impl Lag {
    /// Of a boat that does as decided at once.
    const NONE: Lag = Lag {
        velocity: Ned { north: 0.0, east: 0.0 },
        heading: Ned { north: 1.0, east: 0.0 },
        reaction_s: 0.0,
        turn_rad_s: f64::INFINITY,
    };

    /// How long it goes on before it is on a course, a unit vector, s.
    #[must_use]
    pub fn duration_s(&self, course: Ned) -> f64 {
        let chord = (course - self.heading).length();
        self.reaction_s + self.chord_s() * chord
    }

    /// How much longer it goes on for each unit of chord of its turn, s.
    fn chord_s(&self) -> f64 {
        0.5 * ANGLE_OF_CHORD / self.turn_rad_s
    }
}

impl Closest {
    /// The function in single precision; none if a number is not finite or the horizon is negative.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let at_min = match self.approach {
            Approach::Avoid { at_min } => at_min,
            Approach::Seek => 0.0,
        };
        let lag = self.lag.unwrap_or(Lag::NONE);
        let vectors = [self.offset, self.velocity, lag.velocity, lag.heading].map(|v| [v.north, v.east]);
        let limits = [self.horizon_s, self.min_m, self.max_m, self.touch_m, at_min, lag.reaction_s, lag.chord_s()];
        let sound = vectors.as_flattened().iter().chain(&limits).all(|x| x.is_finite() && x.abs() < 1e7)
            && self.horizon_s >= 0.0
            && lag.reaction_s >= 0.0
            && lag.chord_s() >= 0.0;
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let at_min = at_min.clamp(0.0, 100.0);
        let width_m = self.max_m - self.min_m;
        let slope = |rise: f64, width_m: f64| if width_m > 0.0 { (rise / width_m).min(STEP) } else { STEP };
        let reach_m = self.velocity.length() + speed_max_m_s;
        let own_m_s = lag.velocity.length();
        let lag_m = (reach_m + own_m_s) * (lag.reaction_s + 2.0 * lag.chord_s());
        let scale_m = self.offset.length() + reach_m * self.horizon_s + lag_m;
        let splat = |x: f64| f32x8::splat(x as f32);
        let splat_both = |v: Ned| (splat(v.north), splat(v.east));
        Some(Ready {
            offset: splat_both(self.offset),
            velocity: splat_both(self.velocity),
            horizon: splat(self.horizon_s),
            min: splat(self.min_m),
            slope: splat(slope(100.0 - at_min, width_m)),
            touch: splat(self.touch_m),
            inner_slope: splat(slope(at_min, self.min_m - self.touch_m)),
            at_min: splat(at_min),
            seek: self.approach == Approach::Seek,
            heading: splat_both(lag.heading),
            reaction: splat(lag.reaction_s),
            chord: splat(lag.chord_s()),
            present: splat_both(self.velocity - lag.velocity),
            margin: splat(ROUNDING * scale_m),
        })
    }
}

/// The function in single precision, m and s throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    offset: (f32x8, f32x8),
    velocity: (f32x8, f32x8),
    horizon: f32x8,
    min: f32x8,
    /// Beyond the least distance, for each m.
    slope: f32x8,
    touch: f32x8,
    /// Between there and the least distance.
    inner_slope: f32x8,
    at_min: f32x8,
    seek: bool,
    /// The own ship's, a unit vector.
    heading: (f32x8, f32x8),
    reaction: f32x8,
    /// For each unit of chord of a turn.
    chord: f32x8,
    /// How the contact moves past at present.
    present: (f32x8, f32x8),
    margin: f32x8,
}

/// Where the contact is when the own ship does as decided, and how near it came until then.
#[derive(Clone, Copy)]
struct Leg {
    north: f32x8,
    east: f32x8,
    /// The square of the least distance, m2.
    least: f32x8,
}

impl Ready {
    /// Utilities of eight candidates.
    #[inline(always)]
    pub(super) fn utility(&self, north: f32x8, east: f32x8, speed: f32x8) -> f32x8 {
        let leg = self.going_on(north, east);
        let w = self.passing(north, east, speed);
        let square = square((leg.north, leg.east), w, Ready::time((leg.north, leg.east), w, self.horizon));
        self.worth(square.fast_min(leg.least).sqrt())
    }

    /// What no speed from `slow` to `fast` exceeds, on each of eight courses.
    #[inline]
    pub(super) fn bound(&self, north: f32x8, east: f32x8, slow: f32x8, fast: f32x8) -> f32x8 {
        let half = f32x8::splat(0.5);
        let leg = self.going_on(north, east);
        let p = (leg.north, leg.east);
        let w = self.passing(north, east, (slow + fast) * half);
        let t = Ready::time(p, w, self.horizon);
        if self.seek {
            let least = square(p, w, t).sqrt() - (fast - slow) * half * self.horizon;
            return self.worth(least.fast_min(leg.least.sqrt()) - self.margin);
        }
        // The ends of the span at the same time.
        let (slow, fast) = (self.passing(north, east, slow), self.passing(north, east, fast));
        let most = square(p, slow, t).fast_max(square(p, fast, t)).fast_min(leg.least);
        self.worth(most.sqrt() + self.margin)
    }

    /// The way until the own ship does as decided.
    #[inline(always)]
    fn going_on(&self, north: f32x8, east: f32x8) -> Leg {
        let cosine = self.heading.0 * north + self.heading.1 * east;
        let chord = (f32x8::splat(2.0) - f32x8::splat(2.0) * cosine).fast_max(f32x8::ZERO).sqrt();
        let lag = self.reaction + self.chord * chord;
        let p = self.offset;
        let least = square(p, self.present, Ready::time(p, self.present, lag));
        Leg { north: p.0 + self.present.0 * lag, east: p.1 + self.present.1 * lag, least }
    }

    /// How the contact moves past, m/s.
    #[inline(always)]
    fn passing(&self, north: f32x8, east: f32x8, speed: f32x8) -> (f32x8, f32x8) {
        (self.velocity.0 - speed * north, self.velocity.1 - speed * east)
    }

    /// The time of the closest point of approach, up to a longest one, s.
    #[inline(always)]
    fn time(p: (f32x8, f32x8), w: (f32x8, f32x8), longest: f32x8) -> f32x8 {
        let dot = p.0 * w.0 + p.1 * w.1;
        // With hardly any motion past each other any time will do.
        let square = (w.0 * w.0 + w.1 * w.1).fast_max(f32x8::splat(1e-20));
        (-dot / square).fast_max(f32x8::ZERO).fast_min(longest)
    }

    /// Utility of a distance.
    #[inline(always)]
    fn worth(&self, distance: f32x8) -> f32x8 {
        let full = f32x8::splat(100.0);
        let rise = (distance - self.min) * self.slope;
        if self.seek {
            (full - rise).fast_max(f32x8::ZERO).fast_min(full)
        } else {
            let inside = ((distance - self.touch) * self.inner_slope).fast_max(f32x8::ZERO).fast_min(self.at_min);
            distance.simd_gt(self.min).select((self.at_min + rise).fast_min(full), inside)
        }
    }
}

/// The square of the distance at a time, m2, from a place with a velocity.
#[inline(always)]
fn square(p: (f32x8, f32x8), w: (f32x8, f32x8), t: f32x8) -> f32x8 {
    let (north, east) = (p.0 + w.0 * t, p.1 + w.1 * t);
    north * north + east * east
}
