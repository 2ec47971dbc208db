//! Predicts how a boat coasts to rest with zero thrust, from its boat file or measured distances.

use primitives::frame::{Ned, Rotation};
use primitives::{SimTime, math};
use scenario::boat::{Boat, Drive};
use serde::{Deserialize, Serialize};

/// Speed through the water (m/s) below which a boat counts as at rest and only drifts.
const REST_M_S: f64 = 0.1;
/// Time step of the prediction, s.
const STEP_S: f64 = 0.25;
/// Steps per straight leg.
const STEPS_PER_LEG: u32 = 4;
/// Minimum time for which drift is predicted, s: a boat must stay inside for this long after a
/// stop.
const DRIFT_S: f64 = 20.0;
/// Fractions of drift and turn by which the boat may deviate from the prediction: with these, no
/// approach in `tests/geofence` crosses the fence.
const DRIFT_SLACK: f64 = 0.8;
const TURN_SLACK: f64 = 0.7;
/// Maximum veer of an unsteered hull, rad.
const VEER_RAD: f64 = 0.1;
/// Drift that cannot be observed under way, m/s.
const LEEWAY_M_S: f64 = 0.2;
/// The speed falls more slowly than the thruster setting, but at no less than this fraction of its
/// rate.
const SLEW_SHARE: f64 = 0.75;
/// Maximum duration of the prediction, s.
const LONGEST_S: f64 = 60.0;
/// Averaging time of the recent drift, s.
const RECENT_S: f64 = 5.0;
/// Averaging time of the lasting drift, s.
const LASTING_S: f64 = 20.0;
/// Decay time of transient drift, s: side slip ends with a turn.
const DECAY_S: f64 = 4.0;
/// Gap between orders (s) after which the estimate restarts.
const GAP_MAX_S: f64 = 1.5;
/// Maximum turn of a boat while it coasts, rad.
const TURN_MAX_RAD: f64 = std::f64::consts::FRAC_PI_2;

/// The parameters of coasting: forward resistance, thrusters, and resistance to turning.
// M du/dt = F - l u - q |u| u (Fossen 2021, ch. 6), where F maintains the steady speed of the
// present thrust.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coasting {
    /// Mass and added mass in surge M, kg.
    pub mass_kg: f64,
    /// Linear resistance l, kg/s.
    pub linear_kg_s: f64,
    /// Quadratic resistance q, kg/m.
    pub quadratic_kg_m: f64,
    /// Deceleration of a boat without these resistances, m/s².
    pub deceleration_m_s2: f64,
    /// The steady speed at full thrust, m/s.
    pub speed_max_m_s: f64,
    /// Rate at which thrust falls, as a fraction of full thrust per second.
    pub slew_per_s: f64,
    /// Delay before thrust starts to fall, s.
    pub lag_s: f64,
    /// Time constant of turning, s.
    pub yaw_s: f64,
}

impl Coasting {
    /// The model from the boat file.
    pub fn of(boat: &Boat) -> Coasting {
        let hull = &boat.hull;
        match &boat.drive {
            Drive::Thrusters { thruster, .. } => Coasting {
                mass_kg: hull.mass_kg + hull.added_surge_kg,
                linear_kg_s: hull.surge_linear_kg_s,
                quadratic_kg_m: hull.surge_quadratic_kg_m,
                deceleration_m_s2: 0.0,
                speed_max_m_s: boat.speed_max_m_s(),
                slew_per_s: SLEW_SHARE * thruster.slew_per_s,
                lag_s: thruster.lag_s + thruster.flaws.latency_s,
                yaw_s: (hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2)
                    / hull.yaw_linear_kg_m2_s.max(1e-6),
            },
            // A kinematic boat decelerates at half its limit (see `sim::kinematic`); 0 means no
            // limit.
            Drive::Kinematic(kinematic) => Coasting {
                mass_kg: 1.0,
                linear_kg_s: 0.0,
                quadratic_kg_m: 0.0,
                deceleration_m_s2: match 0.5 * kinematic.deceleration_max_m_s2 {
                    limit if limit > 0.0 => limit,
                    _ => 100.0,
                },
                speed_max_m_s: kinematic.speed_max_m_s,
                slew_per_s: 100.0,
                lag_s: 0.0,
                yaw_s: 0.0,
            },
        }
    }

    /// The same boat, but coasting at least the measured distance (m) from each of these speeds
    /// (m/s).
    pub(super) fn as_measured(self, measured: &[(f64, f64)]) -> Coasting {
        let longer = |(speed_m_s, distance_m): &(f64, f64)| {
            distance_m / self.distance_m(*speed_m_s).max(1e-3)
        };
        // Coasting time and distance are proportional to mass.
        let factor = measured.iter().map(longer).fold(0.0, f64::max);
        match factor {
            0.0 => self,
            _ => Coasting {
                mass_kg: self.mass_kg * factor,
                deceleration_m_s2: self.deceleration_m_s2 / factor,
                ..self
            },
        }
    }

    /// Coasting distance from this speed after an immediate thrust cut, m.
    pub(super) fn distance_m(&self, speed_m_s: f64) -> f64 {
        let at_once = Coasting {
            lag_s: 0.0,
            slew_per_s: f64::INFINITY,
            ..*self
        };
        let toward = Ned {
            north: 1.0,
            east: 0.0,
        };
        at_once
            .path(&Glide {
                water_m_s: toward.scaled(speed_m_s),
                ..Glide::default()
            })
            .last()
            .map_or(0.0, |leg| leg.end.north)
    }

    /// The remaining distance from a low speed, where the resistance is linear, m.
    fn tail_m(&self, speed_m_s: f64) -> f64 {
        if self.linear_kg_s > 0.0 {
            speed_m_s * self.mass_kg / self.linear_kg_s
        } else {
            0.0
        }
    }

    /// Deceleration by resistance alone, m/s², signed.
    fn resistance_m_s2(&self, speed_m_s: f64) -> f64 {
        (self.linear_kg_s + self.quadratic_kg_m * speed_m_s.abs()) * speed_m_s / self.mass_kg
    }

    fn fallen_thrust(&self, thrust_m_s: f64, toward_m_s: f64, step_s: f64) -> f64 {
        let change = self.speed_max_m_s * self.slew_per_s * step_s;
        thrust_m_s + (toward_m_s - thrust_m_s).clamp(-change, change)
    }

    /// The path from the boat to rest, in straight legs.
    pub(super) fn path(&self, glide: &Glide) -> Vec<Leg> {
        let Glide {
            water_m_s,
            drift_m_s,
            transient_m_s,
            yaw_rate_rad_s,
            reaction_s,
            ..
        } = *glide;
        let drifts = [drift_m_s, transient_m_s] != [Ned::default(); 2];
        let mut speed_m_s = water_m_s.length();
        let mut thrust_m_s = glide.thrust_m_s.min(self.speed_max_m_s);
        let course_rad = water_m_s.direction_rad();
        let until_fall_s = reaction_s + self.lag_s;
        let mut at = Ned::default();
        let mut t_s = 0.0_f64;
        let [mut sailed_m, mut drifted_m] = [0.0; 2];
        let mut legs = vec![];
        for step in 1.. {
            let turned_s = t_s.min(reaction_s)
                + self.yaw_s
                    * (1.0 - math::exp((reaction_s - t_s).min(0.0) / self.yaw_s.max(1e-6)));
            let turned_rad = (yaw_rate_rad_s * turned_s).clamp(-TURN_MAX_RAD, TURN_MAX_RAD);
            let ahead = Rotation::from_heading(course_rad + turned_rad).ahead();
            let drift_m_s = drift_m_s + transient_m_s.scaled(math::exp(-t_s / DECAY_S));
            at = at + (ahead.scaled(speed_m_s) + drift_m_s).scaled(STEP_S);
            t_s += STEP_S;
            sailed_m += speed_m_s * STEP_S;
            drifted_m += drift_m_s.length() * STEP_S;
            if t_s > until_fall_s {
                thrust_m_s = self.fallen_thrust(thrust_m_s, 0.0, STEP_S);
                let change = self.resistance_m_s2(thrust_m_s) - self.resistance_m_s2(speed_m_s);
                // A boat slower than the steady speed of its thrust first gains speed.
                let decelerated = if thrust_m_s > 0.0 {
                    0.0
                } else {
                    self.deceleration_m_s2
                };
                speed_m_s = (speed_m_s + (change - decelerated) * STEP_S).max(0.0);
            }
            let is_at_rest = speed_m_s < REST_M_S && t_s > until_fall_s;
            let is_over = is_at_rest && (t_s >= DRIFT_S || !drifts) || t_s >= LONGEST_S;
            if is_over {
                at = at + ahead.scaled(self.tail_m(speed_m_s));
                sailed_m += self.tail_m(speed_m_s);
            }
            if is_over || step % STEPS_PER_LEG == 0 {
                let slack_m = if drifts {
                    LEEWAY_M_S * t_s
                        + DRIFT_SLACK * drifted_m
                        + (VEER_RAD + TURN_SLACK * turned_rad.abs()) * at.length()
                } else {
                    0.0
                };
                legs.push(Leg {
                    end: at,
                    slack_m,
                    reach_m: sailed_m + (1.0 + DRIFT_SLACK) * drifted_m + LEEWAY_M_S * t_s,
                });
            }
            if is_over {
                break;
            }
        }
        legs
    }
}

/// A leg of the path to rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// End of the leg, m from the boat.
    pub(super) end: Ned,
    /// Maximum lateral deviation from the end, m: leeway grows as the boat slows down, and a turn
    /// may continue.
    pub(super) slack_m: f64,
    /// Maximum distance of the boat from its start on any course, m.
    pub(super) reach_m: f64,
}

/// A boat's motion when it starts to coast.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Glide {
    /// Velocity through the water, m/s.
    pub(super) water_m_s: Ned,
    /// Velocity of the water plus the drift caused by the wind, m/s.
    pub(super) drift_m_s: Ned,
    /// Additional drift that decays, m/s: a boat slips sideways in a turn.
    pub(super) transient_m_s: Ned,
    /// The steady speed of the current thrust, m/s.
    pub(super) thrust_m_s: f64,
    /// Rate of turn, rad/s.
    pub(super) yaw_rate_rad_s: f64,
    /// How long the boat continues as before, s.
    pub(super) reaction_s: f64,
}

/// The drift of a boat under orders: its velocity over the ground minus the velocity that its
/// thrust explains.
// A boat that coasts farther than its file states appears to drift, which lengthens the predicted
// path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DriftEstimate {
    at: Option<SimTime>,
    /// Duration of the observation, s.
    lasted_s: f64,
    /// Surge speed through the water according to the boat file, m/s.
    surge_m_s: f64,
    /// The steady speed of the current thrust, m/s.
    pub(super) thrust_m_s: f64,
    /// Mean drift over a short time and a long time, m/s.
    pub(super) recent_m_s: Ned,
    pub(super) drift_m_s: Ned,
}

impl DriftEstimate {
    /// Updates the estimate with the steady forward speed of the current set-point (m/s), and the
    /// boat's heading and velocity over the ground.
    pub(super) fn observe(
        &mut self,
        coasting: &Coasting,
        now: SimTime,
        ordered_m_s: f64,
        (psi_rad, velocity_m_s): (f64, Ned),
    ) {
        let ahead = Rotation::from_heading(psi_rad).ahead();
        let Some(at) = self
            .at
            .replace(now)
            .filter(|at| (now - *at).as_s() <= GAP_MAX_S)
        else {
            *self = DriftEstimate {
                at: Some(now),
                lasted_s: 0.0,
                surge_m_s: velocity_m_s.dot(ahead),
                thrust_m_s: ordered_m_s,
                recent_m_s: Ned::default(),
                drift_m_s: Ned::default(),
            };
            return;
        };
        let step_s = (now - at).as_s();
        // Small steps keep the equation stable.
        for _ in 0..6 {
            let step_s = step_s / 6.0;
            self.thrust_m_s = coasting.fallen_thrust(self.thrust_m_s, ordered_m_s, step_s);
            let change = coasting.resistance_m_s2(self.thrust_m_s)
                - coasting.resistance_m_s2(self.surge_m_s);
            self.surge_m_s += change * step_s;
        }
        let rest = velocity_m_s - ahead.scaled(self.surge_m_s);
        // Use plain means at first.
        self.lasted_s += step_s;
        let towards = |mean: Ned, memory_s: f64| {
            let fraction = step_s / self.lasted_s.clamp(1e-3, memory_s);
            mean + (rest - mean).scaled(fraction.min(1.0))
        };
        self.recent_m_s = towards(self.recent_m_s, RECENT_S);
        self.drift_m_s = towards(self.drift_m_s, LASTING_S);
    }

    /// Whether the estimate includes recent orders.
    pub(super) fn is_fresh(&self, now: SimTime) -> bool {
        self.at.is_some_and(|at| (now - at).as_s() <= GAP_MAX_S)
    }
}
