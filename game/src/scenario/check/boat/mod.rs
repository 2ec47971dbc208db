//! A boat file, checked, with what it leaves out estimated.

mod kinematic;
mod sensor;
mod thruster;

pub(super) use kinematic::thrust_map;

use crate::boat::{Boat, Drive, Hull, Sensors, ThrustCurve, Windage};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;

/// The physics takes explicit steps of the game's tick: motions that die out faster than this many times
/// a tick would grow instead. (Runge-Kutta of order four bears 2.78; the rest is margin.)
pub(super) const FASTEST_PER_TICK: f64 = 2.0;
/// The tick a boat file alone is checked against, s.
const USUAL_TICK_S: f64 = 0.05;
/// Water for the estimates, kg/m³.
const RHO_KG_M3: f64 = 1000.0;

/// Checks a boat.
pub(in crate::scenario) fn boat(diagnostics: &mut Diagnostics, document: &Document<raw::Boat>) -> Option<Boat> {
    let raw = &document.raw;
    let hull = &raw.hull;
    if hull.crossflow_coefficient > 0.0 && !document.has("hull.crossflow_draught_m") {
        let message = "hull.crossflow_draught_m is missing, expected 0 to 20 with a crossflow_coefficient";
        diagnostics.note_if_intact(document.at("hull"), message);
    }
    let sensors = Sensors {
        gps: raw.gps.as_ref().map(|gps| sensor::gps(diagnostics, document, gps)),
        compass: raw.compass.as_ref().map(sensor::compass),
        imu: raw.imu.as_ref().map(sensor::imu),
    };
    let drive = drive(diagnostics, document);
    if !document.is_faultless(diagnostics) {
        return None;
    }
    let drive = drive?;
    let boat = Boat {
        name: document.name.clone(),
        length_m: raw.length_m,
        beam_m: raw.beam_m,
        draught_m: raw.draught_m.unwrap_or_else(|| match hull.crossflow_draught_m {
            Some(draught_m) if draught_m > 0.0 => draught_m,
            _ => raw.length_m / 12.0,
        }),
        hull: estimated(raw, &drive),
        windage: Windage {
            frontal_area_m2: raw.windage.frontal_area_m2.unwrap_or(0.36 * raw.beam_m * raw.beam_m),
            lateral_area_m2: raw.windage.lateral_area_m2.unwrap_or(0.16 * raw.length_m * raw.length_m),
            height_m: raw.windage.height_m.unwrap_or(0.25 * raw.length_m),
            surge_coefficient: raw.windage.surge_coefficient,
            sway_coefficient: raw.windage.sway_coefficient,
            yaw_coefficient: raw.windage.yaw_coefficient,
        },
        drive,
        sensors,
    };
    check_inertia(diagnostics, document, &boat);
    check_decay(diagnostics, document, &boat);
    document.is_faultless(diagnostics).then_some(boat)
}

fn drive(diagnostics: &mut Diagnostics, document: &Document<raw::Boat>) -> Option<Drive> {
    let raw = &document.raw;
    if let Some(kinematic) = &raw.kinematic {
        if document.has("thruster") || document.has("autopilot") {
            let message = "kinematic beside thruster or autopilot, expected the one or the other";
            diagnostics.note(document.at("kinematic"), message);
        }
        return Some(Drive::Kinematic(kinematic::kinematic(diagnostics, document, kinematic)));
    }
    for key in ["thruster", "autopilot"] {
        if !document.has(key) && !document.has("kinematic") {
            let message = format!("{key} is missing, expected it, or kinematic in place of thruster and autopilot");
            diagnostics.note_if_intact(document.at(""), message);
        }
    }
    let thruster = thruster::thruster(diagnostics, document, raw.thruster.as_ref()?)?;
    Some(Drive::Thrusters { thruster, autopilot: raw.autopilot.clone()? })
}

/// The hull, with what the file leaves out estimated by the recipes that the keys' descriptions state.
fn estimated(boat: &raw::Boat, drive: &Drive) -> Hull {
    let (thrust_max_newton, speed_max_m_s) = match drive {
        Drive::Thrusters { thruster, autopilot } => (2.0 * full_ahead_newton(&thruster.curve), autopilot.speed_max_m_s),
        Drive::Kinematic(kinematic) => (0.0, kinematic.speed_max_m_s),
    };
    let (raw, length_m) = (&boat.hull, boat.length_m);
    let mass_kg = raw.mass_kg;
    // A radius of gyration of a quarter of the length, moved from the centre of gravity to midships.
    let inertia_kg_m2 = || mass_kg * (length_m * length_m / 16.0 + raw.x_g_m * raw.x_g_m);
    let yaw_inertia_kg_m2 = raw.yaw_inertia_kg_m2.unwrap_or_else(inertia_kg_m2);
    // Söding (1982), as in MSS addedMassSurge.m: 2.7 ρ ∇^(5/3) / L².
    let added_surge_kg = || {
        let displaced_m3 = mass_kg / RHO_KG_M3;
        let cube_root = libm::cbrt(displaced_m3);
        2.7 * RHO_KG_M3 * displaced_m3 * cube_root * cube_root / (length_m * length_m)
    };
    let surge_linear_kg_s = || {
        let quadratic_kg_s = raw.surge_quadratic_kg_m * speed_max_m_s;
        (thrust_max_newton / speed_max_m_s - quadratic_kg_s).max(0.0)
    };
    let added_sway_kg = raw.added_sway_kg.unwrap_or(mass_kg);
    let added_yaw_kg_m2 = raw.added_yaw_kg_m2.unwrap_or(yaw_inertia_kg_m2);
    Hull {
        mass_kg,
        yaw_inertia_kg_m2,
        x_g_m: raw.x_g_m,
        added_surge_kg: raw.added_surge_kg.unwrap_or_else(added_surge_kg),
        added_sway_kg,
        added_yaw_kg_m2,
        added_sway_yaw_kg_m: raw.added_sway_yaw_kg_m,
        surge_linear_kg_s: raw.surge_linear_kg_s.unwrap_or_else(surge_linear_kg_s),
        surge_quadratic_kg_m: raw.surge_quadratic_kg_m,
        sway_linear_kg_s: raw.sway_linear_kg_s.unwrap_or(mass_kg + added_sway_kg),
        sway_lift_kg_m: raw.sway_lift_kg_m,
        yaw_linear_kg_m2_s: raw.yaw_linear_kg_m2_s.unwrap_or(yaw_inertia_kg_m2 + added_yaw_kg_m2),
        yaw_quadratic_kg_m2: raw.yaw_quadratic_kg_m2,
        yaw_lift_kg_m: raw.yaw_lift_kg_m,
        crossflow_coefficient: raw.crossflow_coefficient,
        crossflow_draught_m: raw.crossflow_draught_m.unwrap_or(0.0),
        crossflow_length_m: raw.crossflow_length_m.unwrap_or(length_m),
        munk_factor: raw.munk_factor,
    }
}

/// A mass matrix with a direction that has no inertia would accelerate without bound.
fn check_inertia(diagnostics: &mut Diagnostics, document: &Document<raw::Boat>, boat: &Boat) {
    let hull = &boat.hull;
    let (m, x_g, i_z) = (hull.mass_kg, hull.x_g_m, hull.yaw_inertia_kg_m2);
    if x_g.abs() > boat.length_m / 2.0 {
        let half_m = boat.length_m / 2.0;
        let message = format!("x_g_m is {x_g}, expected -{half_m} to {half_m}, within the hull");
        diagnostics.note(document.at("hull.x_g_m"), message);
    } else if i_z <= m * x_g * x_g {
        let message = format!("yaw_inertia_kg_m2 is {i_z}, expected more than m x_g² = {}", m * x_g * x_g);
        diagnostics.note(document.at("hull.yaw_inertia_kg_m2"), message);
    }
    let coupling = m * x_g + hull.added_sway_yaw_kg_m;
    if (m + hull.added_sway_kg) * (i_z + hull.added_yaw_kg_m2) <= coupling * coupling {
        let message = format!(
            "added_sway_yaw_kg_m is {}, expected a mass matrix that is positive definite: \
             (m + A22)(I + A66) more than (m x_g + A26)²",
            hull.added_sway_yaw_kg_m
        );
        diagnostics.note(document.at("hull.added_sway_yaw_kg_m"), message);
    }
}

/// The usual tick must be short enough for the boat.
fn check_decay(diagnostics: &mut Diagnostics, document: &Document<raw::Boat>, boat: &Boat) {
    let (motion, rate_per_s) = fastest_decay(boat);
    let allowed_per_s = FASTEST_PER_TICK / USUAL_TICK_S;
    if rate_per_s > allowed_per_s {
        let message = format!(
            "hull: {motion} dies out at {rate_per_s:.1} 1/s, expected at most {allowed_per_s} 1/s \
             ({FASTEST_PER_TICK} a tick of {USUAL_TICK_S} s); its resistance is too large for its inertia"
        );
        let culprit = match motion {
            "surge" => "hull.surge_linear_kg_s",
            "sway" => "hull.sway_linear_kg_s",
            _ => "hull.yaw_linear_kg_m2_s",
        };
        diagnostics.note(document.at(if document.has(culprit) { culprit } else { "hull.mass_kg" }), message);
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
