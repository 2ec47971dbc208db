//! A boat file, checked, with what it leaves out estimated.

mod kinematic;
mod sensor;
mod thruster;

pub(super) use kinematic::thrust_map;

use crate::boat::{Boat, Drive, Hull, Sensors, ThrustCurve, Windage};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawBoat, RawHull};
use crate::scenario::read::Document;

/// The physics takes explicit steps of the game's tick: motions that die out faster than this many times
/// a tick would grow instead. (Runge-Kutta of order four bears 2.78; the rest is margin.)
pub(super) const FASTEST_PER_TICK: f64 = 2.0;
/// The tick a boat file alone is checked against, s.
const USUAL_TICK_S: f64 = 0.05;
/// Water for the estimates, kg/m³.
const RHO_KG_M3: f64 = 1000.0;

/// Checks a boat.
pub(in crate::scenario) fn boat(diagnostics: &mut Diagnostics, document: &Document<RawBoat>) -> Option<Boat> {
    let faults = diagnostics.faults();
    let (raw, start) = (&document.raw, document.start);
    let hull = raw.hull.clone().unwrap_or_default();
    let mut boat = Boat {
        name: document.name.clone(),
        length_m: diagnostics.required(start, "length_m", raw.length_m.as_ref(), 0.1..=100.0),
        beam_m: diagnostics.required(start, "beam_m", raw.beam_m.as_ref(), 0.05..=50.0),
        draught_m: diagnostics.number("draught_m", raw.draught_m.as_ref(), 0.01..=20.0).unwrap_or(0.0),
        hull: given_hull(diagnostics, start, &hull),
        windage: windage(diagnostics, raw),
        drive: drive(diagnostics, document),
        sensors: Sensors {
            gps: raw.gps.as_ref().map(|given| sensor::gps(diagnostics, given)),
            compass: raw.compass.as_ref().map(|given| sensor::compass(diagnostics, &given.value)),
            imu: raw.imu.as_ref().map(|given| sensor::imu(diagnostics, &given.value)),
        },
    };
    if diagnostics.faults() != faults {
        return None;
    }
    estimate(&mut boat, &hull);
    check_inertia(diagnostics, start, &boat, &hull);
    let (motion, rate_per_s) = fastest_decay(&boat);
    let allowed_per_s = FASTEST_PER_TICK / USUAL_TICK_S;
    if rate_per_s > allowed_per_s {
        let message = format!(
            "hull: {motion} dies out at {rate_per_s:.1} 1/s, expected at most {allowed_per_s} 1/s \
             ({FASTEST_PER_TICK} a tick of {USUAL_TICK_S} s); its resistance is too large for its inertia"
        );
        let culprit = match motion {
            "surge" => &hull.surge_linear_kg_s,
            "sway" => &hull.sway_linear_kg_s,
            _ => &hull.yaw_linear_kg_m2_s,
        };
        diagnostics.note(culprit.or(hull.mass_kg).map_or(start, |given| given.at), message);
    }
    (diagnostics.faults() == faults).then_some(boat)
}

fn drive(diagnostics: &mut Diagnostics, document: &Document<RawBoat>) -> Drive {
    let (raw, start) = (&document.raw, document.start);
    let Some(given) = &raw.kinematic else {
        return Drive::Thrusters {
            thruster: thruster::thruster(diagnostics, start, &raw.thruster.clone().unwrap_or_default()),
            autopilot: thruster::autopilot(diagnostics, start, &raw.autopilot.clone().unwrap_or_default()),
        };
    };
    if raw.thruster.is_some() || raw.autopilot.is_some() {
        diagnostics.note(given.at, "kinematic beside thruster or autopilot, expected the one or the other");
    }
    Drive::Kinematic(kinematic::kinematic(diagnostics, given))
}

/// The windage as given, with 0 for areas and heights that are not.
fn windage(diagnostics: &mut Diagnostics, boat: &RawBoat) -> Windage {
    let raw = boat.windage.clone().unwrap_or_default();
    let mut number = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
    };
    let size = |given: &Option<At<f64>>| given.as_ref().map_or(0.0, |given| given.value);
    let (length_m, beam_m) = (size(&boat.length_m), size(&boat.beam_m));
    Windage {
        frontal_area_m2: number("frontal_area_m2", &raw.frontal_area_m2, 0.0, 1000.0, 0.36 * beam_m * beam_m),
        lateral_area_m2: number("lateral_area_m2", &raw.lateral_area_m2, 0.0, 5000.0, 0.16 * length_m * length_m),
        height_m: number("height_m", &raw.height_m, 0.05, 100.0, 0.25 * length_m),
        surge_coefficient: number("surge_coefficient", &raw.surge_coefficient, 0.0, 2.0, 0.6),
        sway_coefficient: number("sway_coefficient", &raw.sway_coefficient, 0.0, 2.0, 0.85),
        yaw_coefficient: number("yaw_coefficient", &raw.yaw_coefficient, -0.5, 0.5, 0.1),
    }
}

/// The hull as given, with 0 for what is not.
fn given_hull(diagnostics: &mut Diagnostics, start: usize, raw: &RawHull) -> Hull {
    let crossflow = diagnostics.number("crossflow_coefficient", raw.crossflow_coefficient.as_ref(), 0.0..=3.0);
    if crossflow.is_some_and(|coefficient| coefficient > 0.0) && raw.crossflow_draught_m.is_none() {
        diagnostics.note_missing(start, "hull.crossflow_draught_m", "0 to 20 with a crossflow_coefficient");
    }
    let mass_kg = diagnostics.required(start, "hull.mass_kg", raw.mass_kg.as_ref(), 0.1..=1e6);
    let mut or_zero = |key: &str, given: &Option<At<f64>>, low: f64, high: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(0.0)
    };
    Hull {
        mass_kg,
        yaw_inertia_kg_m2: or_zero("yaw_inertia_kg_m2", &raw.yaw_inertia_kg_m2, 1e-4, 1e9),
        x_g_m: or_zero("x_g_m", &raw.x_g_m, -50.0, 50.0),
        added_surge_kg: or_zero("added_surge_kg", &raw.added_surge_kg, 0.0, 1e6),
        added_sway_kg: or_zero("added_sway_kg", &raw.added_sway_kg, 0.0, 1e7),
        added_yaw_kg_m2: or_zero("added_yaw_kg_m2", &raw.added_yaw_kg_m2, 0.0, 1e9),
        added_sway_yaw_kg_m: or_zero("added_sway_yaw_kg_m", &raw.added_sway_yaw_kg_m, -1e6, 1e6),
        surge_linear_kg_s: or_zero("surge_linear_kg_s", &raw.surge_linear_kg_s, 0.0, 1e6),
        surge_quadratic_kg_m: or_zero("surge_quadratic_kg_m", &raw.surge_quadratic_kg_m, 0.0, 1e6),
        sway_linear_kg_s: or_zero("sway_linear_kg_s", &raw.sway_linear_kg_s, 0.0, 1e7),
        sway_lift_kg_m: or_zero("sway_lift_kg_m", &raw.sway_lift_kg_m, 0.0, 1e6),
        yaw_linear_kg_m2_s: or_zero("yaw_linear_kg_m2_s", &raw.yaw_linear_kg_m2_s, 0.0, 1e9),
        yaw_quadratic_kg_m2: or_zero("yaw_quadratic_kg_m2", &raw.yaw_quadratic_kg_m2, 0.0, 1e9),
        yaw_lift_kg_m: or_zero("yaw_lift_kg_m", &raw.yaw_lift_kg_m, 0.0, 1e7),
        crossflow_coefficient: crossflow.unwrap_or(0.0),
        crossflow_draught_m: or_zero("crossflow_draught_m", &raw.crossflow_draught_m, 0.0, 20.0),
        crossflow_length_m: or_zero("crossflow_length_m", &raw.crossflow_length_m, 0.0, 200.0),
        munk_factor: diagnostics.number("munk_factor", raw.munk_factor.as_ref(), 0.0..=1.0).unwrap_or(0.5),
    }
}

/// Fills in what the file leaves out, by the recipes that the file's own documentation states.
fn estimate(boat: &mut Boat, raw: &RawHull) {
    let thrust_max_newton = match &boat.drive {
        Drive::Thrusters { thruster, .. } => 2.0 * full_ahead_newton(&thruster.curve),
        Drive::Kinematic(_) => 0.0,
    };
    let speed_max_m_s = boat.speed_max_m_s();
    let length_m = boat.length_m;
    let hull = &mut boat.hull;
    let mass_kg = hull.mass_kg;
    if raw.yaw_inertia_kg_m2.is_none() {
        // A radius of gyration of a quarter of the length, moved from the centre of gravity to midships.
        hull.yaw_inertia_kg_m2 = mass_kg * (length_m * length_m / 16.0 + hull.x_g_m * hull.x_g_m);
    }
    if raw.added_surge_kg.is_none() {
        // Söding (1982), as in MSS addedMassSurge.m: 2.7 ρ ∇^(5/3) / L².
        let displaced_m3 = mass_kg / RHO_KG_M3;
        let cube_root = libm::cbrt(displaced_m3);
        hull.added_surge_kg = 2.7 * RHO_KG_M3 * displaced_m3 * cube_root * cube_root / (length_m * length_m);
    }
    if raw.added_sway_kg.is_none() {
        hull.added_sway_kg = mass_kg;
    }
    if raw.added_yaw_kg_m2.is_none() {
        hull.added_yaw_kg_m2 = hull.yaw_inertia_kg_m2;
    }
    if raw.surge_linear_kg_s.is_none() {
        let quadratic_kg_s = hull.surge_quadratic_kg_m * speed_max_m_s;
        hull.surge_linear_kg_s = (thrust_max_newton / speed_max_m_s - quadratic_kg_s).max(0.0);
    }
    if raw.sway_linear_kg_s.is_none() {
        hull.sway_linear_kg_s = mass_kg + hull.added_sway_kg;
    }
    if raw.yaw_linear_kg_m2_s.is_none() {
        hull.yaw_linear_kg_m2_s = hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2;
    }
    if raw.crossflow_length_m.is_none() {
        hull.crossflow_length_m = length_m;
    }
    if boat.draught_m == 0.0 {
        boat.draught_m = if hull.crossflow_draught_m > 0.0 { hull.crossflow_draught_m } else { length_m / 12.0 };
    }
}

/// A mass matrix with a direction that has no inertia would accelerate without bound.
fn check_inertia(diagnostics: &mut Diagnostics, start: usize, boat: &Boat, raw: &RawHull) {
    let hull = &boat.hull;
    let place = |given: &Option<At<f64>>| given.as_ref().map_or(start, |given| given.at);
    let (m, x_g, i_z) = (hull.mass_kg, hull.x_g_m, hull.yaw_inertia_kg_m2);
    if x_g.abs() > boat.length_m / 2.0 {
        let half_m = boat.length_m / 2.0;
        diagnostics.note(place(&raw.x_g_m), format!("x_g_m is {x_g}, expected -{half_m} to {half_m}, within the hull"));
    } else if i_z <= m * x_g * x_g {
        let message = format!("yaw_inertia_kg_m2 is {i_z}, expected more than m x_g² = {}", m * x_g * x_g);
        diagnostics.note(place(&raw.yaw_inertia_kg_m2), message);
    }
    let coupling = m * x_g + hull.added_sway_yaw_kg_m;
    if (m + hull.added_sway_kg) * (i_z + hull.added_yaw_kg_m2) <= coupling * coupling {
        let message = format!(
            "added_sway_yaw_kg_m is {}, expected a mass matrix that is positive definite: \
             (m + A22)(I + A66) more than (m x_g + A26)²",
            hull.added_sway_yaw_kg_m
        );
        diagnostics.note(place(&raw.added_sway_yaw_kg_m), message);
    }
}

/// The motion that dies out fastest and its rate, 1/s, at top speed, 1 m/s of drift and 1 rad/s of turn.
pub(super) fn fastest_decay(boat: &Boat) -> (&'static str, f64) {
    let hull = &boat.hull;
    let u_m_s = boat.speed_max_m_s();
    let crossflow_kg_s = 1025.0 * hull.crossflow_coefficient * hull.crossflow_draught_m * hull.crossflow_length_m;
    let surge_kg_s = hull.surge_linear_kg_s + 2.0 * hull.surge_quadratic_kg_m * u_m_s;
    let sway_kg_s = hull.sway_linear_kg_s + hull.sway_lift_kg_m * u_m_s + crossflow_kg_s;
    let yaw_kg_m2_s = hull.yaw_linear_kg_m2_s + hull.yaw_lift_kg_m * u_m_s + 2.0 * hull.yaw_quadratic_kg_m2;
    let rates = [
        ("surge", surge_kg_s / (hull.mass_kg + hull.added_surge_kg)),
        ("sway", sway_kg_s / (hull.mass_kg + hull.added_sway_kg)),
        ("yaw", yaw_kg_m2_s / (hull.yaw_inertia_kg_m2 + hull.added_yaw_kg_m2)),
    ];
    rates.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(("surge", 0.0))
}

fn full_ahead_newton(curve: &ThrustCurve) -> f64 {
    match curve {
        ThrustCurve::Propeller { k_ahead, n_max_rad_s, .. } => k_ahead * n_max_rad_s * n_max_rad_s,
        ThrustCurve::Table { points } => points.last().map_or(0.0, |(_, thrust_newton)| *thrust_newton),
    }
}
