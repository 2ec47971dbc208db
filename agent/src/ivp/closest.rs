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
//! For a bound over a cell of velocities, whose corners are known: at any fixed time `t` the distance is convex in the own
//! velocity, so its largest value is at a corner; and since the closest approach is no farther than the distance at `t`, that
//! is a bound for all of the cell. The other way round, all places that the contact comes to lie within the polygon of where it
//! is and where each corner takes it until the horizon, and none of that is nearer than its least extent along any direction.
//! Where courses of a cell differ in how long the boat goes on, that moves the contact by no more than it goes in that time.

use super::cell::Cell;
use super::lanes::{larger, smaller};
use game::Ned;

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
    #[inline(always)]
    #[must_use]
    pub fn duration_s(&self, course: Ned) -> f64 {
        let chord = (course - self.heading).length();
        self.reaction_s + self.chord_s() * chord
    }

    /// How much longer it goes on for each unit of chord of its turn, s.
    #[inline(always)]
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
        let single = |v: Ned| (v.north as f32, v.east as f32);
        let present = self.velocity - lag.velocity;
        Some(Ready {
            offset: single(self.offset),
            velocity: single(self.velocity),
            horizon: self.horizon_s as f32,
            min: self.min_m as f32,
            slope: slope(100.0 - at_min, width_m) as f32,
            touch: self.touch_m as f32,
            inner_slope: slope(at_min, self.min_m - self.touch_m) as f32,
            at_min: at_min as f32,
            seek: self.approach == Approach::Seek,
            heading: single(lag.heading),
            reaction: lag.reaction_s as f32,
            chord: lag.chord_s() as f32,
            present: single(present),
            present_time: time_of_closest(single(self.offset), single(present)),
            present_chord: (present.length() * lag.chord_s() * (1.0 + ROUNDING)) as f32,
            margin: (ROUNDING * scale_m) as f32,
        })
    }
}

/// A vector: north, east.
type Vector = (f32, f32);

/// The function in single precision, m and s throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    offset: Vector,
    velocity: Vector,
    horizon: f32,
    min: f32,
    /// Beyond the least distance, for each m.
    slope: f32,
    touch: f32,
    /// Between there and the least distance.
    inner_slope: f32,
    at_min: f32,
    seek: bool,
    /// The own ship's, a unit vector.
    heading: Vector,
    reaction: f32,
    /// For each unit of chord of a turn.
    chord: f32,
    /// How the contact moves past at present.
    present: Vector,
    /// When it is nearest if that goes on, s from now.
    present_time: f32,
    /// How far it moves past at present for each unit of chord of a turn.
    present_chord: f32,
    margin: f32,
}

/// Where the contact is when the own ship does as decided, and how near it came until then.
#[derive(Clone, Copy)]
struct Leg {
    at: Vector,
    /// The square of the least distance, m2.
    least: f32,
}

impl Ready {
    /// Whether it is to come close.
    pub(super) fn seeks(&self) -> bool {
        self.seek
    }

    /// Utility of a course, a unit vector, at a speed.
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        let velocity = (speed * north, speed * east);
        let chord = self.turn().chord(north, east);
        if self.seek { self.utility_seek(chord, velocity) } else { self.utility_avoid(chord, velocity) }
    }

    /// The turn to a course.
    pub(super) fn turn(&self) -> Turn {
        Turn { heading: self.heading }
    }

    /// Utility of a velocity after a turn with this chord, of a function that keeps away.
    #[inline(always)]
    pub(super) fn utility_avoid(&self, chord: f32, velocity: Vector) -> f32 {
        self.worth_far(self.distance(chord, velocity))
    }

    /// Utility of a velocity after a turn with this chord, of a function that comes close.
    #[inline(always)]
    pub(super) fn utility_seek(&self, chord: f32, velocity: Vector) -> f32 {
        self.worth_near(self.distance(chord, velocity))
    }

    /// The least distance, m.
    #[inline(always)]
    fn distance(&self, chord: f32, velocity: Vector) -> f32 {
        let (leg, w) = (self.going_on(chord), self.passing(velocity));
        let square = square(leg.at, w, time(leg.at, w, self.horizon));
        smaller(square, leg.least).sqrt()
    }

    /// What nothing within a cell exceeds, of a function that keeps away. The chord is that of the turn to its middle course.
    #[inline(always)]
    pub(super) fn bound_avoid(&self, chord: f32, cell: &Cell) -> f32 {
        let leg = self.going_on(chord);
        let t = time(leg.at, self.passing(cell.middle()), self.horizon);
        let [a, b, c, d] = cell.corners();
        let (a, b) = (square(leg.at, self.passing(a), t), square(leg.at, self.passing(b), t));
        let (c, d) = (square(leg.at, self.passing(c), t), square(leg.at, self.passing(d), t));
        let most = smaller(larger(larger(a, b), larger(c, d)), leg.least);
        self.worth_far(most.sqrt() + cell.chord * self.present_chord + self.margin)
    }

    /// Whether all within a cell is worth everything, of a function that keeps away.
    #[inline(always)]
    pub(super) fn is_clear(&self, chord: f32, cell: &Cell) -> bool {
        self.worth_far(self.least_distance(chord, cell)) >= 100.0
    }

    /// What nothing within a cell exceeds, of a function that comes close.
    #[inline(always)]
    pub(super) fn bound_seek(&self, chord: f32, cell: &Cell) -> f32 {
        self.worth_near(self.least_distance(chord, cell))
    }

    /// Nothing within a cell comes nearer, m.
    #[inline(always)]
    fn least_distance(&self, chord: f32, cell: &Cell) -> f32 {
        let leg = self.going_on(chord);
        let w = self.passing(cell.middle());
        let t = time(leg.at, w, self.horizon);
        let nearest = (leg.at.0 + w.0 * t, leg.at.1 + w.1 * t);
        let scale = 1.0 / larger((nearest.0 * nearest.0 + nearest.1 * nearest.1).sqrt(), 1e-6);
        let [a, b, c, d] = cell.corners();
        let (a, b) = (dot(self.passing(a), nearest), dot(self.passing(b), nearest));
        let (c, d) = (dot(self.passing(c), nearest), dot(self.passing(d), nearest));
        let slowest = smaller(smaller(smaller(a, b), smaller(c, d)), 0.0);
        let least = smaller((dot(leg.at, nearest) + slowest * self.horizon) * scale, leg.least.sqrt());
        least - cell.chord * self.present_chord - self.margin
    }

    /// The way until the own ship does as decided.
    #[inline(always)]
    fn going_on(&self, chord: f32) -> Leg {
        let lag = self.reaction + self.chord * chord;
        let p = self.offset;
        let least = square(p, self.present, within(self.present_time, lag));
        Leg { at: (p.0 + self.present.0 * lag, p.1 + self.present.1 * lag), least }
    }

    /// How the contact moves past at an own velocity, m/s.
    #[inline(always)]
    fn passing(&self, own: Vector) -> Vector {
        (self.velocity.0 - own.0, self.velocity.1 - own.1)
    }

    /// Utility of a distance to a contact that is to be near.
    #[inline(always)]
    fn worth_near(&self, distance: f32) -> f32 {
        let rise = (distance - self.min) * self.slope;
        smaller(larger(100.0 - rise, 0.0), 100.0)
    }

    /// Utility of a distance to a contact that is to be far.
    #[inline(always)]
    fn worth_far(&self, distance: f32) -> f32 {
        let rise = (distance - self.min) * self.slope;
        let inside = smaller(larger((distance - self.touch) * self.inner_slope, 0.0), self.at_min);
        let outside = smaller(self.at_min + rise, 100.0);
        if distance > self.min { outside } else { inside }
    }
}

/// A turn of the own ship, which is the same for all contacts.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Turn {
    heading: Vector,
}

impl Turn {
    /// How far it is to a course, a unit vector, as a chord of the unit circle.
    #[inline(always)]
    pub(super) fn chord(self, north: f32, east: f32) -> f32 {
        let cosine = self.heading.0 * north + self.heading.1 * east;
        larger(2.0 - 2.0 * cosine, 0.0).sqrt()
    }
}

/// The time of the closest point of approach, up to a longest one, s.
#[inline(always)]
fn time(p: Vector, w: Vector, longest: f32) -> f32 {
    within(time_of_closest(p, w), longest)
}

/// The time of the closest point of approach, s, also if that was before.
#[inline(always)]
fn time_of_closest(p: Vector, w: Vector) -> f32 {
    // With hardly any motion past each other any time will do.
    -dot(p, w) / larger(dot(w, w), 1e-20)
}

/// A time held within 0 and a longest one, s.
#[inline(always)]
fn within(time: f32, longest: f32) -> f32 {
    smaller(larger(time, 0.0), longest)
}

#[inline(always)]
fn dot(a: Vector, b: Vector) -> f32 {
    a.0 * b.0 + a.1 * b.1
}

/// The square of the distance at a time, m2, from a place with a velocity.
#[inline(always)]
fn square(p: Vector, w: Vector, t: f32) -> f32 {
    let (north, east) = (p.0 + w.0 * t, p.1 + w.1 * t);
    north * north + east * east
}
