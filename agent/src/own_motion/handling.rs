//! Handling: how soon, how fast and how hard a boat turns and brakes, initially from its file and
//! later from observation.

use scenario::boat::{Autopilot, Boat, Drive, Hull, Kinematic, ThrustCurve, Thruster};

/// Mean yaw rate of a turn as a fraction of the steady yaw rate at full rudder.
const MEAN_OF_STEADY: f64 = 0.7;
/// Delay until a decision takes effect, in addition to lag and latency of the thrusters, s.
const DECISION_S: f64 = 0.45;
/// Mean yaw rate of a turn as a fraction of its initial rate; below 1 because the error decreases.
const MEAN_OF_FIRST: f64 = 0.6;
/// Minimum turn rate of a boat with thrusters as a fraction of the maximum: the helm keeps ordering
/// more during a turn.
const LEAST_OF_MOST: f64 = 0.3;
/// Minimum turn rate of a point boat as a fraction of the maximum: such a boat takes half a minute
/// for the last degrees of a turn.
const LEAST_OF_POINT_BOAT: f64 = 0.1;
/// Time constant of the observed turn rate, in seconds of turning.
const MEMORY_S: f64 = 8.0;
/// Turning time after which observation counts as much as the file, s.
const TRUST_S: f64 = 3.0;
/// Heading error below which turning is not observed, rad.
const ERROR_MIN_RAD: f64 = 0.35;
/// Accepted range of the observed turn rate, relative to that in the file.
const SHARE: (f64, f64) = (0.25, 1.5);

/// Acceleration assumed for a boat without an acceleration limit, m/s².
const AT_ONCE_M_S2: f64 = 1e3;

/// How a boat handles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Handling {
    /// Delay until a decision takes effect, s.
    pub(crate) reaction_s: f64,
    /// The largest mean yaw rate of a turn, rad/s.
    pub(crate) turn_rad_s: f64,
    /// The least mean yaw rate of a turn, rad/s.
    turn_least_rad_s: f64,
    /// Yaw rate per radian of heading error, 1/s.
    turn_per_rad_s: f64,
    /// Acceleration and deceleration, m/s².
    pub(crate) acceleration_m_s2: f64,
    pub(crate) deceleration_m_s2: f64,
    /// Outward slide velocity in a turn per product of speed and yaw rate (s), and its decay time
    /// (s).
    pub(crate) slide_s: f64,
    pub(crate) slide_decay_s: f64,
}

impl Handling {
    /// The handling that a boat file defines.
    pub(crate) fn of(boat: &Boat) -> Handling {
        match &boat.drive {
            Drive::Thrusters {
                thruster,
                autopilot,
            } => of_thrusters(&boat.hull, thruster, autopilot),
            Drive::Kinematic(kinematic) => of_kinematic(kinematic),
        }
    }

    /// The handling of a boat that makes every turn at the same yaw rate.
    #[cfg(test)]
    pub(crate) const fn evenly(turn_rad_s: f64) -> Handling {
        Handling {
            reaction_s: 0.7,
            turn_rad_s,
            turn_least_rad_s: turn_rad_s,
            turn_per_rad_s: 1e9,
            acceleration_m_s2: AT_ONCE_M_S2,
            deceleration_m_s2: AT_ONCE_M_S2,
            slide_s: 0.0,
            slide_decay_s: 0.0,
        }
    }

    /// The same handling with this fraction of the yaw rates.
    pub(crate) fn turning(self, share: f64) -> Handling {
        Handling {
            turn_rad_s: share * self.turn_rad_s,
            turn_least_rad_s: share * self.turn_least_rad_s,
            turn_per_rad_s: share * self.turn_per_rad_s,
            ..self
        }
    }

    /// The initial yaw rate at a heading error, rad/s.
    pub(crate) fn yaw_rate_rad_s(&self, error_rad: f64) -> f64 {
        (self.turn_per_rad_s * error_rad).clamp(-self.turn_rad_s, self.turn_rad_s)
    }

    /// The mean yaw rate of a turn by an angle, never negative, rad/s.
    #[inline(always)]
    pub(crate) fn mean_turn_rad_s(&self, by_rad: f64) -> f64 {
        let first_rad_s = MEAN_OF_FIRST * self.turn_per_rad_s * by_rad.abs();
        let rad_s = if first_rad_s > self.turn_least_rad_s {
            first_rad_s
        } else {
            self.turn_least_rad_s
        };
        if rad_s < self.turn_rad_s {
            rad_s
        } else {
            self.turn_rad_s
        }
    }
}

/// The steady yaw rate at half speed solves N = (N_r + N_ur u) r + N_rr r² for the largest moment N
/// of both thrusters. A loop with natural frequency w and damping ratio z starts to turn like a
/// first-order loop with w / (2 z).
fn of_thrusters(hull: &Hull, thruster: &Thruster, autopilot: &Autopilot) -> Handling {
    let (ahead_newton, astern_newton) = match &thruster.curve {
        ThrustCurve::Propeller(p) => (
            p.k_ahead * p.n_max_rad_s * p.n_max_rad_s,
            p.k_astern * p.n_min_rad_s * p.n_min_rad_s,
        ),
        ThrustCurve::Table { points } => {
            let newton = |of: Option<&(f64, f64)>| of.map_or(0.0, |(_, newton)| newton.abs());
            (newton(points.last()), newton(points.first()))
        }
    };
    // Full ahead on one side and full astern on the other: a front seat with two thrusters and no
    // rudder steers like this.
    let moment_newton_m = thruster.arm_m * (ahead_newton + astern_newton);
    // Evaluate at half of the top speed: a moving hull resists turning more, and boats turn while
    // moving.
    let linear = hull.yaw_linear_kg_m2_s + 0.5 * hull.yaw_lift_kg_m * autopilot.speed_max_m_s;
    let quadratic = hull.yaw_quadratic_kg_m2;
    let steady_rad_s = if quadratic > 0.0 {
        ((linear * linear + 4.0 * quadratic * moment_newton_m).sqrt() - linear) / (2.0 * quadratic)
    } else {
        moment_newton_m / linear.max(1e-6)
    };
    let sway_kg_s =
        (hull.sway_linear_kg_s + 0.5 * hull.sway_lift_kg_m * autopilot.speed_max_m_s).max(1e-6);
    let mass_kg = hull.mass_kg + hull.added_surge_kg;
    let turn_rad_s = MEAN_OF_STEADY * steady_rad_s;
    Handling {
        reaction_s: DECISION_S + thruster.lag_s + thruster.flaws.latency_s,
        turn_rad_s,
        turn_least_rad_s: LEAST_OF_MOST * turn_rad_s,
        turn_per_rad_s: 0.5 * autopilot.heading_bandwidth_rad_s / autopilot.heading_damping,
        // Assume half of the thrusters' capability, because changing thrust takes time.
        acceleration_m_s2: ahead_newton / mass_kg,
        deceleration_m_s2: astern_newton / mass_kg,
        slide_s: mass_kg / sway_kg_s,
        slide_decay_s: (hull.mass_kg + hull.added_sway_kg) / sway_kg_s,
    }
}

/// The point boat's law (see `sim::kinematic`): the heading loop sets the rudder, in per cent per
/// degree and per cent per (degree/s), and the yaw rate is proportional to rudder and thrust. With
/// k for the yaw rate per rudder at full thrust, r = k (p e - d r) gives k p / (1 + k d) per unit
/// of heading error. The boat reaches half of the acceleration limits.
fn of_kinematic(kinematic: &Kinematic) -> Handling {
    let per_rudder_rad_s = kinematic.turn_rate.to_radians() / 100.0 * (kinematic.thrust_max / 50.0);
    let [rudder_per_rad, rudder_per_rad_s] =
        [kinematic.heading_pid.p, kinematic.heading_pid.d].map(|gain| gain.abs().to_degrees());
    let limit = |configured_m_s2: f64| {
        if configured_m_s2 > 0.0 {
            0.5 * configured_m_s2
        } else {
            AT_ONCE_M_S2
        }
    };
    let turn_rad_s = MEAN_OF_STEADY * per_rudder_rad_s * kinematic.rudder_max;
    Handling {
        reaction_s: DECISION_S,
        turn_rad_s,
        turn_least_rad_s: LEAST_OF_POINT_BOAT * turn_rad_s,
        turn_per_rad_s: per_rudder_rad_s * rudder_per_rad
            / (1.0 + per_rudder_rad_s * rudder_per_rad_s),
        acceleration_m_s2: limit(kinematic.acceleration_max_m_s2),
        deceleration_m_s2: limit(kinematic.deceleration_max_m_s2),
        slide_s: 0.0,
        slide_decay_s: 0.0,
    }
}

/// The boat's observed turn rate relative to that in its file: the least-squares ratio of observed
/// to expected yaw rates, with a prior of 1 weighted like [`TRUST_S`] seconds of turning, and
/// exponential forgetting.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SeenTurn {
    /// Sums of expected × observed and of expected², rad²/s.
    seen: f64,
    expected: f64,
    /// The expected current yaw rate, which builds up over the reaction time, rad/s.
    rate_rad_s: f64,
}

impl SeenTurn {
    /// Updates the estimate with the yaw rate measured after `step_s` at this heading error.
    pub(crate) fn observe(
        &mut self,
        error_rad: f64,
        yaw_rate_rad_s: f64,
        handling: &Handling,
        step_s: f64,
    ) {
        let wanted_rad_s = handling.yaw_rate_rad_s(error_rad);
        self.rate_rad_s +=
            (step_s / (handling.reaction_s + step_s)) * (wanted_rad_s - self.rate_rad_s);
        if error_rad.abs() < ERROR_MIN_RAD || self.rate_rad_s * error_rad <= 0.0 {
            return;
        }
        let kept = 1.0 - (step_s / MEMORY_S).min(1.0);
        self.seen = kept * self.seen + yaw_rate_rad_s * self.rate_rad_s * step_s;
        self.expected = kept * self.expected + self.rate_rad_s * self.rate_rad_s * step_s;
    }

    /// The turn rate as a fraction of that in the file.
    pub(crate) fn share(&self, handling: &Handling) -> f64 {
        let file = TRUST_S * handling.turn_rad_s * handling.turn_rad_s;
        ((file + self.seen) / (file + self.expected)).clamp(SHARE.0, SHARE.1)
    }
}
