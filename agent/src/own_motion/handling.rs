//! Handling: how soon, how fast and how hard a boat turns and brakes, by its file and then as it is seen to do.

use scenario::boat::{Autopilot, Boat, Drive, Hull, Kinematic, ThrustCurve, Thruster};

/// Share of the steady yaw rate at full rudder that a turn has in the mean.
const MEAN_OF_STEADY: f64 = 0.7;
/// Until a decision shows at all, beside lag and latency of the thrusters, s.
const DECISION_S: f64 = 0.45;
/// A turn has in the mean this share of the yaw rate that it begins with, as the error becomes less.
const MEAN_OF_FIRST: f64 = 0.6;
/// No turn is slower than this share of the fastest: the helm asks for more as it goes on.
const LEAST_OF_MOST: f64 = 0.3;
/// Memory of how the boat turns, s of turning.
const MEMORY_S: f64 = 8.0;
/// How long a turn must go against the file until it counts as much as that, s.
const TRUST_S: f64 = 3.0;
/// A smaller heading error tells nothing of how the boat turns, rad.
const ERROR_MIN_RAD: f64 = 0.35;
/// The least and the most of what the file says that is believed.
const SHARE: (f64, f64) = (0.25, 1.5);

/// The acceleration of a boat without a limit, m/s².
const AT_ONCE_M_S2: f64 = 1e3;

/// How a boat handles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Handling {
    /// Until a decision shows, s.
    pub(crate) reaction_s: f64,
    /// The largest mean yaw rate of a turn, rad/s.
    pub(crate) turn_rad_s: f64,
    /// Yaw rate for each radian of heading error, 1/s.
    turn_per_rad_s: f64,
    /// How fast it gains speed and loses it, m/s².
    pub(crate) acceleration_m_s2: f64,
    pub(crate) deceleration_m_s2: f64,
    /// Velocity outwards for each m/s and rad/s of a turn, s, and how soon it dies out, s.
    pub(crate) slide_s: f64,
    pub(crate) slide_decay_s: f64,
}

impl Handling {
    /// What a boat file says.
    pub(crate) fn of(boat: &Boat) -> Handling {
        match &boat.drive {
            Drive::Thrusters { thruster, autopilot } => of_thrusters(&boat.hull, thruster, autopilot),
            Drive::Kinematic(kinematic) => of_kinematic(kinematic),
        }
    }

    /// A boat that makes every turn at the same yaw rate.
    #[cfg(test)]
    pub(crate) const fn evenly(turn_rad_s: f64) -> Handling {
        Handling {
            reaction_s: 0.7,
            turn_rad_s,
            turn_per_rad_s: 1e9,
            acceleration_m_s2: AT_ONCE_M_S2,
            deceleration_m_s2: AT_ONCE_M_S2,
            slide_s: 0.0,
            slide_decay_s: 0.0,
        }
    }

    /// The same, turning at this share of its yaw rates.
    pub(crate) fn turning(self, share: f64) -> Handling {
        Handling { turn_rad_s: share * self.turn_rad_s, turn_per_rad_s: share * self.turn_per_rad_s, ..self }
    }

    /// The yaw rate that a heading error begins with, rad/s.
    pub(crate) fn yaw_rate_rad_s(&self, error_rad: f64) -> f64 {
        (self.turn_per_rad_s * error_rad).clamp(-self.turn_rad_s, self.turn_rad_s)
    }

    /// The mean yaw rate of a turn by an angle, rad/s, never negative.
    #[inline(always)]
    pub(crate) fn mean_turn_rad_s(&self, by_rad: f64) -> f64 {
        let first_rad_s = MEAN_OF_FIRST * self.turn_per_rad_s * by_rad.abs();
        let least_rad_s = LEAST_OF_MOST * self.turn_rad_s;
        let rad_s = if first_rad_s > least_rad_s { first_rad_s } else { least_rad_s };
        if rad_s < self.turn_rad_s { rad_s } else { self.turn_rad_s }
    }
}

/// The steady yaw rate at half speed solves N = (N_r + N_ur u) r + N_rr r² for the largest moment N of both thrusters; the
/// loop of natural frequency w and damping ratio z begins to turn as one of first order with w / (2 z).
fn of_thrusters(hull: &Hull, thruster: &Thruster, autopilot: &Autopilot) -> Handling {
    let (ahead_newton, astern_newton) = match &thruster.curve {
        ThrustCurve::Propeller(p) => {
            (p.k_ahead * p.n_max_rad_s * p.n_max_rad_s, p.k_astern * p.n_min_rad_s * p.n_min_rad_s)
        }
        ThrustCurve::Table { points } => {
            let newton = |of: Option<&(f64, f64)>| of.map_or(0.0, |(_, newton)| newton.abs());
            (newton(points.last()), newton(points.first()))
        }
    };
    // Full ahead on one side and full astern on the other, as a front seat steers that has two
    // thrusters and no rudder.
    let moment_newton_m = thruster.arm_m * (ahead_newton + astern_newton);
    // At half of the top speed: a hull under way resists turning more, and boats turn on the
    // way, not at rest.
    let linear = hull.yaw_linear_kg_m2_s + 0.5 * hull.yaw_lift_kg_m * autopilot.speed_max_m_s;
    let quadratic = hull.yaw_quadratic_kg_m2;
    let steady_rad_s = if quadratic > 0.0 {
        ((linear * linear + 4.0 * quadratic * moment_newton_m).sqrt() - linear) / (2.0 * quadratic)
    } else {
        moment_newton_m / linear.max(1e-6)
    };
    let sway_kg_s = (hull.sway_linear_kg_s + 0.5 * hull.sway_lift_kg_m * autopilot.speed_max_m_s).max(1e-6);
    let mass_kg = hull.mass_kg + hull.added_surge_kg;
    Handling {
        reaction_s: DECISION_S + thruster.lag_s + thruster.flaws.latency_s,
        turn_rad_s: MEAN_OF_STEADY * steady_rad_s,
        turn_per_rad_s: 0.5 * autopilot.heading_bandwidth_rad_s / autopilot.heading_damping,
        // Half of what the thrusters can: setting them takes time.
        acceleration_m_s2: ahead_newton / mass_kg,
        deceleration_m_s2: astern_newton / mass_kg,
        slide_s: mass_kg / sway_kg_s,
        slide_decay_s: (hull.mass_kg + hull.added_sway_kg) / sway_kg_s,
    }
}

/// The point boat's law (see `sim::kinematic`): the heading loop sets the rudder, per cent for each degree, and the yaw rate
/// is in proportion to rudder and thrust. It does half of the limits of acceleration.
fn of_kinematic(kinematic: &Kinematic) -> Handling {
    let per_rudder_rad_s = kinematic.turn_rate.to_radians() / 100.0 * (kinematic.thrust_max / 50.0);
    let rudder_per_rad = kinematic.heading_pid.p.abs().to_degrees();
    let limit = |configured_m_s2: f64| if configured_m_s2 > 0.0 { 0.5 * configured_m_s2 } else { AT_ONCE_M_S2 };
    Handling {
        reaction_s: DECISION_S,
        turn_rad_s: MEAN_OF_STEADY * per_rudder_rad_s * kinematic.rudder_max,
        turn_per_rad_s: per_rudder_rad_s * rudder_per_rad,
        acceleration_m_s2: limit(kinematic.acceleration_max_m_s2),
        deceleration_m_s2: limit(kinematic.deceleration_max_m_s2),
        slide_s: 0.0,
        slide_decay_s: 0.0,
    }
}

/// How much of what its file says a boat is seen to turn: the least-squares ratio of the yaw rates seen to those expected, with
/// the file's own 1 as so many seconds of turning, and old turns forgotten.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SeenTurn {
    /// Sums over what was expected, rad²/s: times what was seen, and times itself.
    seen: f64,
    expected: f64,
    /// The yaw rate that is expected now, rad/s: it builds up in the reaction time.
    rate_rad_s: f64,
}

impl SeenTurn {
    /// Takes in the yaw rate after `step_s` with this heading error.
    pub(crate) fn observe(&mut self, error_rad: f64, yaw_rate_rad_s: f64, handling: &Handling, step_s: f64) {
        let wanted_rad_s = handling.yaw_rate_rad_s(error_rad);
        self.rate_rad_s += (step_s / (handling.reaction_s + step_s)) * (wanted_rad_s - self.rate_rad_s);
        if error_rad.abs() < ERROR_MIN_RAD || self.rate_rad_s * error_rad <= 0.0 {
            return;
        }
        let kept = 1.0 - (step_s / MEMORY_S).min(1.0);
        self.seen = kept * self.seen + yaw_rate_rad_s * self.rate_rad_s * step_s;
        self.expected = kept * self.expected + self.rate_rad_s * self.rate_rad_s * step_s;
    }

    /// How much of what the file says the boat turns.
    pub(crate) fn share(&self, handling: &Handling) -> f64 {
        let file = TRUST_S * handling.turn_rad_s * handling.turn_rad_s;
        ((file + self.seen) / (file + self.expected)).clamp(SHARE.0, SHARE.1)
    }
}
