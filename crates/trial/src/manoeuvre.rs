//! The standard manoeuvres: their commands, and when they end.
//!
//! Definitions follow IMO resolution MSC.137(76) and its explanatory notes MSC/Circ.1053, applied
//! to boats that steer with two thrusters instead of a rudder: see [`Manoeuvre`].

use super::command::{Command, Engine};
use super::replay::{ROW, Unsound, ticks_per_row};
use super::sample::Sample;
use super::trial_boat::TrialBoat;
use primitives::SimTime;
use primitives::angle::wrap_pi;
use scenario::boat::{Boat, Drive};
use strum::{EnumString, IntoStaticStr, VariantNames};

/// A standard manoeuvre. *Port* and *starboard* are thrusters; a kinematic boat has thrust and
/// rudder instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, EnumString, IntoStaticStr, VariantNames)]
#[strum(serialize_all = "snake_case")]
pub enum Manoeuvre {
    /// From a straight approach, the inner thruster stops and the outer one is unchanged
    /// (kinematic: full rudder, thrust unchanged), for two turns.
    TurningCircle,
    /// From a straight approach, differential thrust (kinematic: rudder) is applied to starboard,
    /// then reversed each time the heading passes the angle on that side.
    Zigzag,
    /// From a straight approach, full astern until the boat is dead in the water (which may itself
    /// be moving).
    CrashStop,
    /// Full ahead from rest, until the speed is steady.
    Acceleration,
    /// No thrust, in the given sea.
    Drift,
    /// From rest, port full ahead and starboard full astern (kinematic: thrust 50 and full rudder).
    Spin,
}

impl Manoeuvre {
    /// The names of all manoeuvres.
    pub const NAMES: &[&str] = Manoeuvre::VARIANTS;

    /// Its name on the command line and in file names.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

/// The settings of a manoeuvre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// The manoeuvre.
    pub manoeuvre: Manoeuvre,
    /// The heading of the approach, rad.
    pub course_rad: f64,
    /// The speed of the approach, m/s; `None` is the highest that the front seat accepts.
    pub approach_m_s: Option<f64>,
    /// The duration of the approach, s.
    pub approach_s: f64,
    /// Initial turn: 1 to starboard, −1 to port.
    pub side: f64,
    /// The deviation from the course at which a zigzag switches, rad.
    pub switch_rad: f64,
    /// The difference between the thrusters in a zigzag, or its rudder angle, as a fraction of
    /// full.
    pub differential: f64,
    /// The duration, s; `None`: until the manoeuvre is over.
    pub duration_s: Option<f64>,
}

/// A performed manoeuvre, from its beginning.
#[derive(Clone, Debug)]
pub struct Sailed {
    /// The track; the first sample is at the end of the approach.
    pub samples: Vec<Sample>,
    /// Speed over the ground at the end of the approach, m/s, averaged over its last 5 s.
    pub approach_m_s: f64,
    /// The times of a zigzag's switches, s.
    pub switches: Vec<f64>,
}

/// Averaging time at the end of the approach, s.
const MEAN_S: f64 = 5.0;
/// Default maximum duration of a manoeuvre, s.
const LONGEST_S: f64 = 600.0;
/// Default duration of drift and spin, s.
const DRIFT_S: f64 = 300.0;
const SPIN_S: f64 = 60.0;
/// Number of switches after which a zigzag is over.
const SWITCHES: usize = 7;
/// Fraction of the approach speed below which a boat counts as dead in the water.
pub(super) const DEAD: f64 = 0.01;
/// The speed is steady when it changes by less than this fraction in [`STEADY_S`].
const STEADY: f64 = 0.001;
const STEADY_S: f64 = 10.0;

/// Commands for turning and propulsion with any type of engine.
#[derive(Clone, Copy, Debug)]
struct Helm {
    is_kinematic: bool,
    /// Mean throttle at the end of the approach, as a fraction of full.
    throttle: f64,
}

impl Helm {
    /// Thrusters at these fractions; for a rudder boat, half their sum as thrust and half their
    /// difference as rudder.
    fn apart(self, port: f64, starboard: f64) -> Command {
        if self.is_kinematic {
            return Command::Impose {
                thrust: 50.0 * (port + starboard),
                rudder: 50.0 * (port - starboard),
            };
        }
        Command::Thrust {
            port: port.clamp(-1.0, 1.0),
            starboard: starboard.clamp(-1.0, 1.0),
        }
    }

    /// Approach thrust with this much differential thrust or rudder to starboard.
    fn turning(self, differential: f64) -> Command {
        if self.is_kinematic {
            return Command::Impose {
                thrust: 100.0 * self.throttle,
                rudder: 100.0 * differential,
            };
        }
        self.apart(self.throttle + differential, self.throttle - differential)
    }
}

/// Performs `plan` with a boat at the start, pointing along the course.
///
/// # Errors
/// [`Unsound`] if the boat's state becomes non-finite.
///
/// # Panics
/// If the tick does not divide [`ROW`].
pub fn sail(boat: &Boat, trial_boat: &mut TrialBoat, plan: &Plan) -> Result<Sailed, Unsound> {
    let per_row = ticks_per_row(trial_boat.tick()).expect("the tick was checked");
    let is_kinematic = matches!(boat.drive, Drive::Kinematic(_));
    let mut helm = Helm {
        is_kinematic,
        throttle: 1.0,
    };
    let mut approach_m_s = 0.0;
    if matches!(
        plan.manoeuvre,
        Manoeuvre::TurningCircle | Manoeuvre::Zigzag | Manoeuvre::CrashStop
    ) {
        (approach_m_s, helm.throttle) = approach(boat, trial_boat, plan, per_row)?;
    }
    trial_boat.set_origin();
    let start = trial_boat.now();
    let mut sailed = Sailed {
        samples: vec![],
        approach_m_s,
        switches: vec![],
    };
    let mut side = plan.side;
    let mut off_course_rad = 0.0;
    let mut turned_rad = 0.0;
    let mut psi_rad = trial_boat.pose().psi_rad;
    loop {
        let t_s = (ROW * sailed.samples.len() as i64).as_s();
        let mut told = command(plan, helm, side);
        let sample = trial_boat.sample(t_s, told);
        turned_rad += wrap_pi(sample.psi_rad - psi_rad);
        psi_rad = sample.psi_rad;
        sailed.samples.push(sample);
        if is_over(plan, &sailed, turned_rad, t_s) {
            return Ok(sailed);
        }
        for _ in 0..per_row {
            if plan.manoeuvre == Manoeuvre::Zigzag {
                // Unwrapped, because a spinning boat has not returned to its course.
                off_course_rad +=
                    wrap_pi(trial_boat.pose().psi_rad - plan.course_rad - off_course_rad);
                if side * off_course_rad > plan.switch_rad {
                    side = -side;
                    told = command(plan, helm, side);
                    sailed.switches.push((trial_boat.now() - start).as_s());
                }
            }
            trial_boat.step(told);
        }
        if !trial_boat.is_sound() {
            return Err(Unsound { t_s });
        }
    }
}

/// The straight approach. Returns the speed at its end, m/s, and the throttle as a fraction of
/// full.
fn approach(
    boat: &Boat,
    trial_boat: &mut TrialBoat,
    plan: &Plan,
    per_row: u32,
) -> Result<(f64, f64), Unsound> {
    let speed_m_s = plan.approach_m_s.unwrap_or_else(|| boat.speed_max_m_s());
    let course = Command::Steer {
        heading_rad: plan.course_rad,
        speed_m_s,
    };
    let engine = Engine::new(boat);
    let rows = SimTime::from_s(plan.approach_s).0 / ROW.0;
    let last_rows = (MEAN_S / ROW.as_s()).round() as i64;
    let mut speed_sum = 0.0;
    let mut throttle_sum = 0.0;
    let mut count = 0.0_f64;
    for row in 1..=rows {
        (0..per_row).for_each(|_| trial_boat.step(course));
        if !trial_boat.is_sound() {
            return Err(Unsound {
                t_s: (ROW * row).as_s() - plan.approach_s,
            });
        }
        if row > rows - last_rows {
            speed_sum += trial_boat.sample(0.0, course).speed_m_s();
            throttle_sum += engine.throttle(trial_boat.settings());
            count += 1.0;
        }
    }
    Ok((speed_sum / count.max(1.0), throttle_sum / count.max(1.0)))
}

fn command(plan: &Plan, helm: Helm, side: f64) -> Command {
    let throttle = helm.throttle;
    let full = side > 0.0;
    match plan.manoeuvre {
        Manoeuvre::TurningCircle if helm.is_kinematic => helm.turning(side),
        Manoeuvre::TurningCircle => helm.apart(
            if full { throttle } else { 0.0 },
            if full { 0.0 } else { throttle },
        ),
        Manoeuvre::Zigzag => helm.turning(side * plan.differential),
        Manoeuvre::CrashStop => helm.apart(-1.0, -1.0),
        Manoeuvre::Acceleration => helm.apart(1.0, 1.0),
        Manoeuvre::Drift => helm.apart(0.0, 0.0),
        Manoeuvre::Spin if helm.is_kinematic => Command::Impose {
            thrust: 50.0,
            rudder: 100.0 * side,
        },
        Manoeuvre::Spin => helm.apart(side, -side),
    }
}

/// Whether a manoeuvre is complete. `turned_rad` is the boat's turn since its beginning, including
/// whole turns.
fn is_over(plan: &Plan, sailed: &Sailed, turned_rad: f64, t_s: f64) -> bool {
    if let Some(duration_s) = plan.duration_s {
        return t_s >= duration_s - 1e-6;
    }
    let done = match plan.manoeuvre {
        Manoeuvre::TurningCircle => turned_rad.abs() >= 2.0 * std::f64::consts::TAU,
        Manoeuvre::Zigzag => sailed.switches.len() >= SWITCHES,
        Manoeuvre::CrashStop => sailed
            .samples
            .last()
            .is_some_and(|sample| sample.surge_through_water_m_s <= DEAD * sailed.approach_m_s),
        Manoeuvre::Acceleration => is_steady(&sailed.samples),
        Manoeuvre::Drift => t_s >= DRIFT_S - 1e-6,
        Manoeuvre::Spin => t_s >= SPIN_S - 1e-6,
    };
    done || t_s >= LONGEST_S
}

fn is_steady(samples: &[Sample]) -> bool {
    let rows = (STEADY_S / ROW.as_s()).round() as usize;
    let mean = |samples: &[Sample]| {
        samples.iter().map(|sample| sample.nu.surge).sum::<f64>() / rows as f64
    };
    let Some(first) = samples.len().checked_sub(2 * rows) else {
        return false;
    };
    let before = mean(&samples[first..first + rows]);
    let after = mean(&samples[first + rows..]);
    after > 0.0 && (after - before).abs() < STEADY * after
}

/// The boat's turn (rad clockwise) since the first sample, including whole turns, at each sample.
pub fn turned_rad(samples: &[Sample]) -> Vec<f64> {
    let mut turned = 0.0;
    let mut before = samples.first().map_or(0.0, |sample| sample.psi_rad);
    samples
        .iter()
        .map(|sample| {
            turned += wrap_pi(sample.psi_rad - before);
            before = sample.psi_rad;
            turned
        })
        .collect()
}
