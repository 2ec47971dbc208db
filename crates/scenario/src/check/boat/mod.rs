//! Checks a boat file and estimates missing values.

mod kinematic;
mod thruster;

pub use kinematic::check_thrust_map;

use crate::boat::{Boat, Drive, Hull, Propeller, ThrustCurve, Windage};
use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::Document;
use crate::sensor::{Gps, MOST_PERIODS_LATE};
use kinematic::check_kinematic;

/// Maximum decay rate per tick: the integration is explicit, so a faster decay would grow instead.
/// (The stability limit of fourth-order Runge-Kutta is 2.78; the rest is margin.)
pub(super) const FASTEST_PER_TICK: f64 = 2.0;
/// The tick for checking a boat file without a game, s.
const USUAL_TICK_S: f64 = 0.05;
/// Water density for the estimates, kg/m³.
const RHO_KG_M3: f64 = 1000.0;

impl ScenarioFile for Boat {
    type Keys = raw::Boat;
    const NAME: &'static str = "boat";
    const FOLDER: &'static str = "boats";

    fn check(document: &Document<raw::Boat>) -> Option<Boat> {
        let raw = &document.raw;
        let hull = &raw.hull;
        if hull.crossflow_coefficient > 0.0 && !document.has("hull.crossflow_draught_m") {
            let expected = "0 to 20 with a crossflow_coefficient";
            document.note_missing("hull.crossflow_draught_m", expected);
        }
        if let Some(gps) = &raw.sensors.gps {
            check_gps(document, gps);
        }
        let drive = drive(document);
        if !document.is_faultless() {
            return None;
        }
        let drive = drive?;
        let draught_m = hull
            .crossflow_draught_m
            .filter(|draught_m| *draught_m > 0.0);
        let boat = Boat {
            name: document.name.clone(),
            length_m: raw.length_m,
            beam_m: raw.beam_m,
            draught_m: raw.draught_m.or(draught_m).unwrap_or(raw.length_m / 12.0),
            hull: self::hull(raw, &drive),
            windage: windage(raw),
            drive,
            hold: raw.hold,
            sensors: raw.sensors.clone(),
        };
        check_inertia(document, &boat);
        check_decay(document, &boat);
        document.is_faultless().then_some(boat)
    }
}

fn drive(document: &Document<raw::Boat>) -> Option<Drive> {
    let raw = &document.raw;
    if let Some(kinematic) = &raw.kinematic {
        if document.has("thruster") || document.has("autopilot") {
            let message = "kinematic is given with thruster or autopilot, expected kinematic alone";
            document.note("kinematic", message);
        }
        check_kinematic(document, kinematic);
        return Some(Drive::Kinematic(kinematic.clone()));
    }
    for key in ["thruster", "autopilot"] {
        if !document.has(key) && !document.has("kinematic") {
            document.note_missing(key, "thruster and autopilot, or kinematic");
        }
    }
    let thruster = thruster::thruster(document, raw.thruster.as_ref()?)?;
    Some(Drive::Thrusters {
        thruster,
        autopilot: raw.autopilot.clone()?,
    })
}

fn check_gps(document: &Document<raw::Boat>, gps: &Gps) {
    let latency_s = gps.latency_s;
    let most_s = MOST_PERIODS_LATE * gps.period_s;
    if latency_s > most_s {
        let path = if document.has("gps.latency_s") {
            "gps.latency_s"
        } else {
            "gps.period_s"
        };
        let message = format!(
            "latency_s is {latency_s}, expected at most {most_s}: {MOST_PERIODS_LATE} periods"
        );
        document.note(path, message);
    }
}

/// The hull, with omitted values estimated by the formulas in the descriptions of the keys.
fn hull(raw: &raw::Boat, drive: &Drive) -> Hull {
    let (thrust_max_newton, speed_max_m_s) = match drive {
        Drive::Thrusters {
            thruster,
            autopilot,
        } => (
            2.0 * full_ahead_newton(&thruster.curve),
            autopilot.speed_max_m_s,
        ),
        Drive::Kinematic(kinematic) => (0.0, kinematic.speed_max_m_s),
    };
    let hull = &raw.hull;
    let length_m = raw.length_m;
    let (mass_kg, x_g_m) = (hull.mass_kg, hull.x_g_m);
    let surge_quadratic_kg_m = hull.surge_quadratic_kg_m;
    // A radius of gyration of a quarter of the length, shifted from the centre of gravity to
    // amidships.
    let estimate_kg_m2 = || mass_kg * (length_m * length_m / 16.0 + x_g_m * x_g_m);
    let yaw_inertia_kg_m2 = hull.yaw_inertia_kg_m2.unwrap_or_else(estimate_kg_m2);
    let added_sway_kg = hull.added_sway_kg.unwrap_or(mass_kg);
    let added_yaw_kg_m2 = hull.added_yaw_kg_m2.unwrap_or(yaw_inertia_kg_m2);
    Hull {
        mass_kg,
        yaw_inertia_kg_m2,
        x_g_m,
        // Söding (1982), as in MSS addedMassSurge.m: 2.7 ρ ∇^(5/3) / L².
        added_surge_kg: hull.added_surge_kg.unwrap_or_else(|| {
            let displaced_m3 = mass_kg / RHO_KG_M3;
            let cube_root = libm::cbrt(displaced_m3);
            2.7 * RHO_KG_M3 * displaced_m3 * cube_root * cube_root / (length_m * length_m)
        }),
        added_sway_kg,
        added_yaw_kg_m2,
        added_sway_yaw_kg_m: hull.added_sway_yaw_kg_m,
        surge_linear_kg_s: hull.surge_linear_kg_s.unwrap_or_else(|| {
            let quadratic_kg_s = surge_quadratic_kg_m * speed_max_m_s;
            (thrust_max_newton / speed_max_m_s - quadratic_kg_s).max(0.0)
        }),
        surge_quadratic_kg_m,
        sway_linear_kg_s: hull.sway_linear_kg_s.unwrap_or(mass_kg + added_sway_kg),
        sway_lift_kg_m: hull.sway_lift_kg_m,
        yaw_linear_kg_m2_s: hull
            .yaw_linear_kg_m2_s
            .unwrap_or(yaw_inertia_kg_m2 + added_yaw_kg_m2),
        yaw_quadratic_kg_m2: hull.yaw_quadratic_kg_m2,
        yaw_lift_kg_m: hull.yaw_lift_kg_m,
        crossflow_coefficient: hull.crossflow_coefficient,
        crossflow_draught_m: hull.crossflow_draught_m.unwrap_or(0.0),
        crossflow_length_m: hull.crossflow_length_m.unwrap_or(length_m),
        munk_factor: hull.munk_factor,
    }
}

/// The windage, with estimates as for the hull.
fn windage(raw: &raw::Boat) -> Windage {
    let windage = &raw.windage;
    let length_m = raw.length_m;
    let beam_m = raw.beam_m;
    Windage {
        frontal_area_m2: windage.frontal_area_m2.unwrap_or(0.36 * beam_m * beam_m),
        lateral_area_m2: windage
            .lateral_area_m2
            .unwrap_or(0.16 * length_m * length_m),
        height_m: windage.height_m.unwrap_or(0.25 * length_m),
        surge_coefficient: windage.surge_coefficient,
        sway_coefficient: windage.sway_coefficient,
        yaw_coefficient: windage.yaw_coefficient,
    }
}

/// Checks the mass matrix. If it were singular, accelerations would be unbounded.
fn check_inertia(document: &Document<raw::Boat>, boat: &Boat) {
    let hull = &boat.hull;
    let m = hull.mass_kg;
    let x_g = hull.x_g_m;
    let i_z = hull.yaw_inertia_kg_m2;
    if x_g.abs() > boat.length_m / 2.0 {
        let half_m = boat.length_m / 2.0;
        let message = format!("x_g_m is {x_g}, expected -{half_m} to {half_m}, within the hull");
        document.note("hull.x_g_m", message);
    } else if i_z <= m * x_g * x_g {
        let message = format!(
            "yaw_inertia_kg_m2 is {i_z}, expected more than m x_g² = {}",
            m * x_g * x_g
        );
        document.note("hull.yaw_inertia_kg_m2", message);
    }
    let coupling = m * x_g + hull.added_sway_yaw_kg_m;
    if (m + hull.added_sway_kg) * (i_z + hull.added_yaw_kg_m2) <= coupling * coupling {
        let message = format!(
            "added_sway_yaw_kg_m is {}, expected a positive definite mass matrix: \
             (m + A22)(I + A66) more than (m x_g + A26)²",
            hull.added_sway_yaw_kg_m
        );
        document.note("hull.added_sway_yaw_kg_m", message);
    }
}

/// Checks that the default tick is short enough for the boat.
fn check_decay(document: &Document<raw::Boat>, boat: &Boat) {
    let (motion, rate_per_s) = fastest_decay(boat);
    let allowed_per_s = FASTEST_PER_TICK / USUAL_TICK_S;
    if rate_per_s > allowed_per_s {
        let message = format!(
            "hull: {motion} decays at {rate_per_s:.1} 1/s, expected at most {allowed_per_s} 1/s \
             ({FASTEST_PER_TICK} per tick of {USUAL_TICK_S} s); its resistance is too large for its inertia"
        );
        let culprit = match motion {
            "surge" => "hull.surge_linear_kg_s",
            "sway" => "hull.sway_linear_kg_s",
            _ => "hull.yaw_linear_kg_m2_s",
        };
        let is_given = document.has(culprit);
        document.note(if is_given { culprit } else { "hull.mass_kg" }, message);
    }
}

/// The motion with the fastest decay, and its rate (1/s) at top speed, 1 m/s of drift and 1 rad/s
/// of turn.
pub(super) fn fastest_decay(boat: &Boat) -> (&'static str, f64) {
    let hull = &boat.hull;
    let u_m_s = boat.speed_max_m_s();
    let crossflow_kg_s =
        1025.0 * hull.crossflow_coefficient * hull.crossflow_draught_m * hull.crossflow_length_m;
    let surge_kg_s = hull.surge_linear_kg_s + 2.0 * hull.surge_quadratic_kg_m * u_m_s;
    let sway_kg_s = hull.sway_linear_kg_s + hull.sway_lift_kg_m * u_m_s + crossflow_kg_s;
    let yaw_kg_m2_s =
        hull.yaw_linear_kg_m2_s + hull.yaw_lift_kg_m * u_m_s + 2.0 * hull.yaw_quadratic_kg_m2;
    let rates = [
        ("surge", surge_kg_s / (hull.mass_kg + hull.added_surge_kg)),
        ("sway", sway_kg_s / (hull.mass_kg + hull.added_sway_kg)),
        (
            "yaw",
            yaw_kg_m2_s / (hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2),
        ),
    ];
    let fastest = rates.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    fastest.unwrap_or(("surge", 0.0))
}

fn full_ahead_newton(curve: &ThrustCurve) -> f64 {
    match curve {
        ThrustCurve::Propeller(Propeller {
            k_ahead,
            n_max_rad_s,
            ..
        }) => k_ahead * n_max_rad_s * n_max_rad_s,
        ThrustCurve::Table { points } => points
            .last()
            .map_or(0.0, |(_, thrust_newton)| *thrust_newton),
    }
}
