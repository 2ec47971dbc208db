//! The closest point of approach to a contact for every course and speed.
//!
//! The contact is at `p` relative to own ship and has velocity `c`; own ship is on course `d` (a
//! unit vector) at speed `s`. The contact's relative velocity is `w = c - s d`, and its distance
//! `|p + w t|` is smallest at
//!
//! ```text
//! t* = - p.w / w.w      clamped to 0 and the horizon,
//! ```
//!
//! since the square of the distance is a parabola in `t`.
//!
//! A boat does not turn or brake at once. With a [`Lag`], it keeps its motion for its reaction
//! time, moves straight to the end of its [turn](Turning), and then follows the candidate at the
//! mean [speed](MeanSpeed) until it meets the contact. The closest distance on any of these three
//! legs counts.
//!
//! Two boats that avoid each other may choose the same side and collide. If a [`Side`] is given on
//! which to leave each other, distances count less where the line of sight turns to the other side.
//!
//! Bounds over a cell: its first and last courses at its slowest and fastest speeds give four
//! paths. At any time every other path of the cell lies between them, except for the bend of the
//! arcs between these courses. The distance is a convex function of the position, so at that time
//! it is largest on one of the four. No closest point of approach is farther than that, which gives
//! an upper bound for the cell. Conversely, along any direction, no point of a leg is nearer than
//! the nearest point of the four.

use super::cell::Cell;
use super::lanes::{larger, smaller};
use super::turn::{Fan, Lag, MeanSpeed, Turn, Turning, Vector};
use primitives::Ned;

/// Maximum rounding error in single precision relative to the lengths involved, with a margin.
const ROUNDING: f64 = 1e-5;

/// The slope of a step.
const STEP: f64 = 1e12;

/// Minimum assumed time to meet a contact, even one that is never met, s.
const MEETING_MIN_S: f64 = 1.0;

/// A side of a boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Left: the line of sight to a contact left on this side rotates anticlockwise.
    Port,
    /// Right.
    Starboard,
}

/// Weight of a distance kept on the wrong side: so small that a boat does not turn there to avoid a
/// third boat.
const OTHER_SIDE: f32 = 0.2;

/// Whether to avoid or to approach the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// Farther is better: linear from 0 where the hulls touch to `at_min` at `min_m`, and from
    /// there to 100 at `max_m`. MOOS-IvP has a step of 25 at the minimum distance and zero below
    /// it, so a boat that is too close is indifferent to coming closer.
    Avoid {
        /// Utility at `min_m`, 0 to 100.
        at_min: f64,
        /// The side on which to leave the contact; `None` if it does not matter.
        leave_to: Option<Side>,
    },
    /// Closer is better: 100 at or below `min_m`, falling linearly to 0 at `max_m`.
    Seek,
}

/// Utility of the distance at the closest point of approach to a contact of constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The contact's position relative to own ship, m.
    pub offset: Ned,
    /// Velocity of the contact, m/s.
    pub velocity: Ned,
    /// How long course and speed are held after the turn, s.
    pub horizon_s: f64,
    /// The minimum distance to keep, m.
    pub min_m: f64,
    /// The distance beyond which utility no longer changes, m.
    pub max_m: f64,
    /// The distance at which hulls touch, m; the utility is 0 at and below it.
    pub touch_m: f64,
    /// Whether to avoid or approach the contact.
    pub approach: Approach,
    /// Own ship's delay; `None` if it follows decisions at once.
    pub lag: Option<Lag>,
}

impl Closest {
    /// The function in single precision; `None` if a number is non-finite or the horizon negative.
    pub(super) fn ready(&self, speed_max_m_s: f64) -> Option<Ready> {
        let (at_min, leave_to) = match self.approach {
            Approach::Avoid { at_min, leave_to } => (at_min, leave_to),
            Approach::Seek => (0.0, None),
        };
        let seek = self.approach == Approach::Seek;
        let lag = self.lag.as_ref();
        let vectors = [self.offset, self.velocity].map(|v| [v.north, v.east]);
        let limits = [self.horizon_s, self.min_m, self.max_m, self.touch_m, at_min];
        let sound = vectors
            .as_flattened()
            .iter()
            .chain(&limits)
            .all(|x| x.is_finite() && x.abs() < 1e7)
            && self.horizon_s >= 0.0
            && lag.is_none_or(Lag::is_sound);
        // Incoming pictures are validated, so an invalid number is a bug: tests stop, and a boat on
        // the water continues without this function.
        debug_assert!(sound, "{self:?}");
        if !sound {
            return None;
        }
        let at_min = at_min.clamp(0.0, 100.0);
        let width_m = self.max_m - self.min_m;
        // The minimum and maximum distances may be equal, so avoid division by zero.
        let slope = |rise: f64, width_m: f64| {
            if width_m > 0.0 {
                (rise / width_m).min(STEP)
            } else {
                STEP
            }
        };
        let contact_m_s = self.velocity.length();
        let own_m_s = lag
            .map_or(0.0, |lag| lag.velocity.length())
            .max(speed_max_m_s);
        let most_s = self.horizon_s + lag.map_or(0.0, Lag::most_s);
        let scale_m = self.offset.length() + (contact_m_s + own_m_s) * most_s;
        let single = |v: Ned| (v.north as f32, v.east as f32);
        let (reaction_s, own) =
            lag.map_or((0.0, Ned::default()), |lag| (lag.reaction_s, lag.velocity));
        let offset = single(self.offset);
        let present = single(self.velocity - own);
        let reaction = reaction_s as f32;
        let (beside, other_side) = match leave_to {
            Some(Side::Port) => ((offset.1, -offset.0), OTHER_SIDE),
            Some(Side::Starboard) => ((-offset.1, offset.0), OTHER_SIDE),
            None => ((0.0, 0.0), 1.0),
        };
        // The mean speed depends on the meeting time, which depends on the speed. All candidates
        // use the meeting time at current velocities; with a separate time for each, the squared
        // distance would no longer be a parabola.
        let meeting_s = f64::from(time(offset, present, self.horizon_s as f32)).max(MEETING_MIN_S);
        Some(Ready {
            start: (
                offset.0 + present.0 * reaction,
                offset.1 + present.1 * reaction,
            ),
            // Motion within the reaction time is the same for all candidates, so compute it only
            // once.
            least_before: square(offset, present, time(offset, present, reaction)),
            velocity: single(self.velocity),
            speed: contact_m_s as f32 * (1.0 + ROUNDING as f32),
            horizon: self.horizon_s as f32,
            min: self.min_m as f32,
            worth: if seek {
                // Full utility up to the minimum distance.
                [100.0, -slope(100.0, width_m), f64::MIN, 1.0]
            } else {
                let inner = slope(at_min, self.min_m - self.touch_m);
                [at_min, slope(100.0 - at_min, width_m), self.touch_m, inner]
            }
            .map(|part| part as f32),
            seek,
            turning: Turning::new(lag),
            mean_speed: MeanSpeed::new(lag, meeting_s),
            beside,
            other_side,
            // Bounds and points use different formulas in single precision. A bound too tight by a
            // rounding error would miss the best point, so widen all bounds by the largest error.
            margin: (ROUNDING * scale_m) as f32,
            group: 0,
        })
    }
}

/// The function in single precision, m and s throughout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    /// The contact's position when a decision takes effect, and the square of its smallest distance
    /// until then.
    start: Vector,
    least_before: f32,
    velocity: Vector,
    /// The contact's speed, m/s.
    speed: f32,
    horizon: f32,
    min: f32,
    /// The utility at the minimum distance; the utility per metre beyond it; the distance at which
    /// the hulls touch (m); and the utility per metre between these two distances.
    worth: [f32; 4],
    /// Whether to approach.
    pub(super) seek: bool,
    /// Own ship's turn.
    pub(super) turning: Turning,
    mean_speed: MeanSpeed,
    /// Perpendicular to the current line of sight, towards the side on which to leave the contact;
    /// and the weight of distances on the other side.
    beside: Vector,
    other_side: f32,
    /// Maximum rounding error of a bound on a distance, m.
    margin: f32,
    /// Functions of a search with the same group number have the same distances.
    pub(super) group: usize,
}

/// The contact's relative motion on the paths of a cell: those to its first and last courses, each
/// at its slowest and fastest speeds, and one in the middle.
#[derive(Clone, Copy)]
pub(super) struct Ways {
    /// The contact's position after the turns.
    first: Vector,
    last: Vector,
    from_first: [Vector; 2],
    from_last: [Vector; 2],
    /// For the middle path: the contact's position after the turn; its motion during the turn; the
    /// fraction of that motion after which it is nearest; its velocity after the turn; and the time
    /// after the turn at which it is nearest.
    middle: Vector,
    past: Vector,
    share: f32,
    w: Vector,
    t: f32,
    /// Maximum distance by which other paths leave the polygon of the outer four (m), and its
    /// growth rate (m/s).
    off: f32,
    bend: f32,
}

impl Ready {
    /// Utility of a course (a unit vector) at a speed (m/s).
    pub(super) fn utility(&self, north: f32, east: f32, speed: f32) -> f32 {
        let course = (north, east);
        // Reports and tests use the same arithmetic as the search, lane by lane, so the displayed
        // value is the one that decided.
        self.worth(self.distance(&self.turning.to(course), course, speed))
    }

    /// Whether the given function has the same distances.
    pub(super) fn has_distances_of(&self, other: &Ready) -> bool {
        let ways = |ready: &Ready| {
            (
                ready.start,
                ready.least_before,
                ready.velocity,
                ready.horizon,
                ready.seek,
            )
        };
        let sides = |ready: &Ready| (ready.beside, ready.other_side);
        // Two behaviours may avoid the same boats at different distances. Computing distances is
        // expensive; computing their utilities is not.
        ways(self) == ways(other)
            && sides(self) == sides(other)
            && self.turning == other.turning
            && self.mean_speed == other.mean_speed
    }

    /// The effective smallest distance (m) on a course (a unit vector) at a speed after the turn to
    /// that course: smaller on the wrong side.
    #[inline(always)]
    pub(super) fn distance(&self, turn: &Turn, course: Vector, speed: f32) -> f32 {
        let at = self.after(turn);
        let speed = self.mean_speed.of(speed);
        let past = minus(at, self.start);
        let w = self.passing(course, speed);
        let turning = square(self.start, past, time(self.start, past, 1.0));
        let t = time(at, w, self.horizon);
        let straight = square(at, w, t);
        // The contact's position when it is nearest, which shows whether the line of sight has
        // turned to the wrong side by then.
        let share = if dot(self.beside, (at.0 + w.0 * t, at.1 + w.1 * t)) < 0.0 {
            self.other_side
        } else {
            1.0
        };
        // One square root serves all three legs: the smallest square belongs to the smallest
        // distance.
        smaller(smaller(straight, turning), self.least_before).sqrt() * share
    }

    #[inline(always)]
    pub(super) fn ways(&self, fan: &Fan, cell: &Cell) -> Ways {
        let first = self.after(&fan.first);
        let last = self.after(&fan.last);
        let middle = (0.5 * (first.0 + last.0), 0.5 * (first.1 + last.1));
        let past = minus(middle, self.start);
        let slow = self.mean_speed.of(cell.slow);
        let fast = self.mean_speed.of(cell.fast);
        let w = self.passing((cell.north, cell.east), self.mean_speed.of(cell.mean));
        Ways {
            first,
            last,
            from_first: [
                self.passing(cell.first, slow),
                self.passing(cell.first, fast),
            ],
            from_last: [self.passing(cell.last, slow), self.passing(cell.last, fast)],
            middle,
            past,
            share: time(self.start, past, 1.0),
            w,
            t: time(middle, w, self.horizon),
            off: fan.off + fan.off_s * self.speed + self.margin,
            bend: 0.5 * cell.half * cell.half * fast,
        }
    }

    /// Upper bound of the smallest distances on the paths of a cell, m.
    #[inline(always)]
    pub(super) fn most(&self, ways: &Ways) -> f32 {
        let Ways { first, last, t, .. } = *ways;
        let part = |at| square(self.start, minus(at, self.start), ways.share);
        let turning = larger(part(first), part(last));
        let [a, b] = ways.from_first.map(|w| square(first, w, t));
        let [c, d] = ways.from_last.map(|w| square(last, w, t));
        let straight = larger(larger(a, b), larger(c, d));
        smaller(smaller(straight, turning), self.least_before).sqrt() + ways.off + ways.bend * t
    }

    /// Lower bound of the smallest distances on the paths of a cell, m.
    #[inline(always)]
    pub(super) fn least(&self, ways: &Ways) -> f32 {
        let nearest = (
            self.start.0 + ways.share * ways.past.0,
            self.start.1 + ways.share * ways.past.1,
        );
        let extent = smaller(dot(ways.first, nearest), dot(ways.last, nearest));
        let turning = smaller(dot(self.start, nearest), extent) * per_length(nearest);
        let nearest = (
            ways.middle.0 + ways.t * ways.w.0,
            ways.middle.1 + ways.t * ways.w.1,
        );
        let [a, b] = ways.from_first.map(|w| dot(w, nearest));
        let [c, d] = ways.from_last.map(|w| dot(w, nearest));
        let slowest = smaller(smaller(smaller(a, b), smaller(c, d)), 0.0);
        let extent =
            smaller(dot(ways.first, nearest), dot(ways.last, nearest)) + slowest * self.horizon;
        let straight = extent * per_length(nearest);
        let least = smaller(smaller(straight, turning), self.least_before.sqrt())
            - ways.off
            - ways.bend * self.horizon;
        // Assume that all paths pass on the wrong side.
        smaller(least * self.other_side, least)
    }

    /// The contact's position when own ship has reached its course.
    #[inline(always)]
    fn after(&self, turn: &Turn) -> Vector {
        let past = (
            self.velocity.0 * turn.duration - turn.by.0,
            self.velocity.1 * turn.duration - turn.by.1,
        );
        (self.start.0 + past.0, self.start.1 + past.1)
    }

    /// The contact's velocity relative to own ship on a course (a unit vector) at a speed, m/s.
    #[inline(always)]
    fn passing(&self, course: Vector, speed: f32) -> Vector {
        (
            self.velocity.0 - speed * course.0,
            self.velocity.1 - speed * course.1,
        )
    }

    /// Utility of a distance; approaching and avoiding share one formula, without a branch.
    #[inline(always)]
    pub(super) fn worth(&self, distance: f32) -> f32 {
        let [at_min, slope, touch, inner_slope] = self.worth;
        let rise = (distance - self.min) * slope;
        let inside = smaller(larger((distance - touch) * inner_slope, 0.0), at_min);
        let outside = smaller(larger(at_min + rise, 0.0), 100.0);
        if distance > self.min { outside } else { inside }
    }
}

/// The time of the closest point of approach, clamped to 0 and `longest`, s.
#[inline(always)]
fn time(p: Vector, w: Vector, longest: f32) -> f32 {
    // At almost zero relative speed, any time will do. A maximum vectorises, unlike a branch on
    // zero.
    let time = -dot(p, w) / larger(dot(w, w), 1e-20);
    smaller(larger(time, 0.0), longest)
}

#[inline(always)]
fn minus(a: Vector, b: Vector) -> Vector {
    (a.0 - b.0, a.1 - b.1)
}

/// The reciprocal length of a vector, unless it is very short.
#[inline(always)]
fn per_length(v: Vector) -> f32 {
    1.0 / larger(dot(v, v).sqrt(), 1e-6)
}

#[inline(always)]
fn dot(a: Vector, b: Vector) -> f32 {
    a.0 * b.0 + a.1 * b.1
}

/// The squared distance after a time, m², given a position and a velocity.
#[inline(always)]
fn square(p: Vector, w: Vector, t: f32) -> f32 {
    let north = p.0 + w.0 * t;
    let east = p.1 + w.1 * t;
    north * north + east * east
}
