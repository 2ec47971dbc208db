//! Own ship's response to a decision: it keeps its motion for its reaction time, turns the shorter
//! way along an arc at its current speed, then moves straight, with limited acceleration.
//!
//! From the heading `h` to the course `d`, unit vectors with the angle `a` between them, a turn at
//! the yaw rate `r` lasts `a / r`. At speed `u` it is an arc of radius `u / r`, whose chord ends at
//!
//! ```text
//! (u / r) |d - h| (h + d) / |h + d|           a = 2 asin(x) = 2 x (1 + x^2 / 6 + 0.36 x^8), within 6 %, x = |d - h| / 2
//! ```
//!
//! For a course straight back, both directions are equally short, and the arc may end on either
//! side.

use super::cell::Cell;
use super::lanes::{larger, smaller};
use primitives::Ned;

/// A vector: north, east.
pub(super) type Vector = (f32, f32);

/// Own ship's delay in following a decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Own ship's current velocity, m/s.
    pub velocity: Ned,
    /// Current heading, as a unit vector.
    pub heading: Ned,
    /// Time until a decision takes effect, s.
    pub reaction_s: f64,
    /// Turn rate, rad/s.
    pub turn_rad_s: f64,
    /// Acceleration, m/s².
    pub acceleration_m_s2: f64,
    /// Deceleration, m/s².
    pub deceleration_m_s2: f64,
}

/// Approximate ratio of a turn's angle to its chord on a unit circle: between 1 for small turns and
/// half of pi for half a turn.
const ANGLE_OF_CHORD: f64 = 1.15;

impl Lag {
    /// How long own ship effectively keeps its motion before it is on a course (a unit vector): its
    /// reaction time plus half of its turn, s.
    #[inline(always)]
    pub fn duration_s(&self, course: Ned) -> f64 {
        let chord = (course - self.heading).length();
        self.reaction_s + 0.5 * ANGLE_OF_CHORD / self.turn_rad_s * chord
    }

    fn ahead_m_s(&self) -> f64 {
        self.velocity.dot(self.heading).max(0.0)
    }

    /// Whether all numbers are valid for the computation.
    pub(super) fn is_sound(&self) -> bool {
        let rates = [
            self.turn_rad_s,
            self.acceleration_m_s2,
            self.deceleration_m_s2,
        ];
        let numbers = [
            self.velocity.north,
            self.velocity.east,
            self.heading.north,
            self.heading.east,
            self.reaction_s,
        ];
        let sound = |x: &f64| x.is_finite() && x.abs() < 1e7;
        numbers.iter().all(sound)
            && self.reaction_s >= 0.0
            && rates.iter().all(|rate| sound(rate) && *rate > 1e-4)
    }

    /// Maximum time until own ship is on its course, s.
    pub(super) fn most_s(&self) -> f64 {
        self.reaction_s + std::f64::consts::PI / self.turn_rad_s
    }
}

/// Maximum single-precision error of an angle whose cosine is near 1, rad.
const ROUNDING_RAD: f32 = 1e-3;

/// Own ship's turn in single precision, the same for all contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turning {
    heading: Vector,
    s_per_rad: f32,
    radius: f32,
}

/// A turn onto a course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    /// Duration, s.
    pub(super) duration: f32,
    /// End point, through the water, m.
    pub(super) by: Vector,
}

/// Turns onto the courses of a cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan {
    pub(super) first: Turn,
    pub(super) last: Turn,
    /// Maximum distance of any of the end points from the straight line between those of `first`
    /// and `last`, m.
    pub(super) off: f32,
    /// Maximum deviation of a duration from the linear interpolation between those of `first` and
    /// `last`, s.
    pub(super) off_s: f32,
}

impl Turning {
    /// A ship that follows decisions at once.
    const NONE: Turning = Turning {
        heading: (1.0, 0.0),
        s_per_rad: 0.0,
        radius: 0.0,
    };

    pub(super) fn new(lag: Option<&Lag>) -> Turning {
        lag.map_or(Turning::NONE, |lag| Turning {
            // The arc is computed from the chord and the middle of two unit vectors, without an
            // angle: inverse functions vectorise poorly and differ between machines.
            heading: (lag.heading.north as f32, lag.heading.east as f32),
            s_per_rad: (1.0 / lag.turn_rad_s) as f32,
            radius: (lag.ahead_m_s() / lag.turn_rad_s) as f32,
        })
    }

    /// The turn to a course (a unit vector).
    #[inline(always)]
    pub(super) fn to(&self, (north, east): Vector) -> Turn {
        let cosine = self.heading.0 * north + self.heading.1 * east;
        let x2 = larger(0.5 - 0.5 * cosine, 0.0);
        let chord = 2.0 * x2.sqrt();
        let x4 = x2 * x2;
        let arc_of_chord = 1.0 + x2 * (1.0 / 6.0) + 0.36 * x4 * x4;
        let middle_north = self.heading.0 + north;
        let middle_east = self.heading.1 + east;
        let middle = (middle_north * middle_north + middle_east * middle_east).sqrt();
        // For the course straight back, the sum of both headings is zero and has no direction.
        let scale = self.radius * chord / larger(middle, 1e-3);
        Turn {
            duration: chord * arc_of_chord * self.s_per_rad,
            by: (scale * middle_north, scale * middle_east),
        }
    }

    /// Turns onto the courses of a cell.
    ///
    /// Per radian of course, their end points move by one radius, in a direction that rotates with
    /// the course. Their durations change at a rate that itself changes by less than 2.4 per
    /// radian. So an intermediate value deviates from the straight line between two of them by at
    /// most half of that rate of change times the square of half the cell's angle. At the bow both
    /// rates change sign, and opposite to it the end points jump.
    #[inline(always)]
    pub(super) fn fan(&self, cell: &Cell) -> Fan {
        let first = self.to(cell.first);
        let last = self.to(cell.last);
        let bend = 0.5 * cell.half * cell.half;
        let mut off = bend + ROUNDING_RAD;
        let mut off_s = 2.4 * bend + ROUNDING_RAD;
        let cosine = self.heading.0 * cell.north + self.heading.1 * cell.east;
        let within = 1.0 - larger(cosine, -cosine)
            < 0.55 * (cell.half + ROUNDING_RAD) * (cell.half + ROUNDING_RAD);
        // For courses on either side of the bow the arcs bend to both sides, and near the course
        // straight back they end far apart. The four corners do not enclose them there, so the
        // bound is widened by the largest deviation.
        let at_bow = within & (cosine > 0.0);
        let at_back = within & (cosine <= 0.0);
        off += if at_bow { 1.1 * cell.half } else { 0.0 } + if at_back { 4.0 } else { 0.0 };
        off_s += if at_bow { 1.3 * cell.half } else { 0.0 } + if at_back { 3.2 } else { 0.0 };
        let whole = if cell.is_disc { 1e6 } else { 0.0 };
        Fan {
            first,
            last,
            off: off * self.radius + whole,
            off_s: off_s * self.s_per_rad,
        }
    }
}

/// Own ship's mean speed on its straight run until it meets a contact, with limited acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanSpeed {
    ahead: f32,
    /// The maximum gain until then (m/s), and its reciprocal.
    gain: (f32, f32),
    /// The maximum loss until then (m/s), and its reciprocal.
    loss: (f32, f32),
}

impl MeanSpeed {
    /// Any speed is reached at once. A power of two, so that nothing is rounded.
    const NONE: MeanSpeed = {
        let much = (1_u64 << 60) as f32;
        MeanSpeed {
            ahead: 0.0,
            gain: (much, 1.0 / much),
            loss: (much, 1.0 / much),
        }
    };

    /// The mean speed until `until_s` from now.
    pub(super) fn new(lag: Option<&Lag>, until_s: f64) -> MeanSpeed {
        let change = |m_s2: f64| ((m_s2 * until_s) as f32, (1.0 / (m_s2 * until_s)) as f32);
        lag.map_or(MeanSpeed::NONE, |lag| MeanSpeed {
            ahead: lag.ahead_m_s() as f32,
            gain: change(lag.acceleration_m_s2),
            loss: change(lag.deceleration_m_s2),
        })
    }

    /// The mean speed for an ordered speed. If the change takes the fraction `y` of the time, the
    /// mean change is `y - y^2 / 2` times the largest possible change.
    #[inline(always)]
    pub(super) fn of(&self, speed: f32) -> f32 {
        // Compute both before choosing: a choice between numbers in memory becomes a gather, which
        // took a third of the search time.
        let (gain, per_gain) = self.gain;
        let (loss, per_loss) = self.loss;
        let off = speed - self.ahead;
        let up = smaller(off * per_gain, 1.0);
        let down = larger(off * per_loss, -1.0);
        let up = gain * (up * (1.0 - 0.5 * up));
        let down = loss * (down * (1.0 + 0.5 * down));
        self.ahead + if speed > self.ahead { up } else { down }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAG: Lag = Lag {
        velocity: Ned {
            north: 0.0,
            east: 2.0,
        },
        heading: Ned {
            north: 0.0,
            east: 1.0,
        },
        reaction_s: 0.7,
        turn_rad_s: 0.35,
        acceleration_m_s2: 1.2,
        deceleration_m_s2: 0.6,
    };

    #[test]
    fn a_turn_ends_where_small_steps_end() {
        let turning = Turning::new(Some(&LAG));
        for by_deg in (-175..=175).step_by(5) {
            let by_rad = f64::from(by_deg).to_radians();
            let steps = 10_000;
            let duration_s = by_rad.abs() / LAG.turn_rad_s;
            let way_m = LAG.velocity.east * duration_s / f64::from(steps);
            let course = |share: f64| {
                let (sin, cos) =
                    primitives::math::sin_cos(std::f64::consts::FRAC_PI_2 + share * by_rad);
                Ned {
                    north: cos,
                    east: sin,
                }
            };
            let way = |step: i32| course((f64::from(step) + 0.5) / f64::from(steps)).scaled(way_m);
            let at = (0..steps).map(way).fold(Ned::default(), |at, way| at + way);
            let to = course(1.0);
            let turn = turning.to((to.north as f32, to.east as f32));
            let end = Ned {
                north: f64::from(turn.by.0),
                east: f64::from(turn.by.1),
            };
            let what = format!("by {by_deg} degrees: {turn:?}, {at:?} after {duration_s} s");
            assert!(
                (f64::from(turn.duration) - duration_s).abs() <= 0.06 * duration_s + 1e-3,
                "{what}"
            );
            assert!(end.distance(at) <= 2e-3, "{what}");
        }
    }

    #[test]
    fn a_mean_speed_is_what_small_steps_say() {
        for until_s in [1.0, 3.0, 8.0] {
            let mean = MeanSpeed::new(Some(&LAG), until_s);
            for wanted in [0.0_f64, 0.7, 1.9, 2.0, 2.4, 3.0, 9.0] {
                let steps = 100_000;
                let mut speed_m_s = 2.0_f64;
                let mut way_m = 0.0;
                let dt_s = until_s / f64::from(steps);
                for _ in 0..steps {
                    let slower = LAG.deceleration_m_s2 * dt_s;
                    let faster = LAG.acceleration_m_s2 * dt_s;
                    speed_m_s = wanted.clamp(speed_m_s - slower, speed_m_s + faster);
                    way_m += dt_s * speed_m_s;
                }
                let got = f64::from(mean.of(wanted as f32));
                assert!(
                    (got - way_m / until_s).abs() < 1e-3,
                    "{wanted} m/s within {until_s} s: {got}"
                );
            }
        }
        for wanted in [0.0_f32, 0.3, 1.0 / 3.0, 7.77] {
            assert_eq!(MeanSpeed::NONE.of(wanted), wanted);
        }
    }
}
