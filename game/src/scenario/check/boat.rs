//! A boat file, checked, with what it leaves out estimated.

use super::same_place;
use crate::boat::{Autopilot, Boat, Drive, Flaws, Hull, Sensors, ThrustCurve, Thruster, Windage};
use crate::scenario::ledger::Ledger;
use crate::scenario::raw::{At, Pair, RawAutopilot, RawBoat, RawHull, RawPropeller, RawThruster};
use crate::scenario::read::Document;

/// The physics takes explicit steps of the game's tick: motions that die out faster than this many times
/// a tick would grow instead. (Runge-Kutta of order four bears 2.78; the rest is margin.)
pub(super) const FASTEST_PER_TICK: f64 = 2.0;
/// The tick a boat file alone is checked against, s.
const USUAL_TICK_S: f64 = 0.05;
/// Water for the estimates, kg/m³.
const RHO_KG_M3: f64 = 1000.0;

/// Checks a boat.
pub(in crate::scenario) fn boat(ledger: &mut Ledger, document: &Document<RawBoat>) -> Option<Boat> {
    let faults = ledger.faults();
    let (raw, start) = (&document.raw, document.start);
    let hull = raw.hull.clone().unwrap_or_default();
    let mut boat = Boat {
        name: document.name.clone(),
        length_m: ledger.required(start, "length_m", raw.length_m.as_ref(), 0.1..=100.0),
        beam_m: ledger.required(start, "beam_m", raw.beam_m.as_ref(), 0.05..=50.0),
        draught_m: 0.15,
        hull: given_hull(ledger, start, &hull),
        windage: Windage {
            frontal_area_m2: 0.3,
            lateral_area_m2: 0.55,
            height_m: 0.5,
            surge_coefficient: 0.6,
            sway_coefficient: 0.85,
            yaw_coefficient: 0.1,
        },
        drive: Drive::Thrusters {
            thruster: thruster(ledger, start, &raw.thruster.clone().unwrap_or_default()),
            autopilot: autopilot(ledger, start, &raw.autopilot.clone().unwrap_or_default()),
        },
        sensors: Sensors::default(),
    };
    if ledger.faults() != faults {
        return None;
    }
    estimate(&mut boat, &hull);
    check_inertia(ledger, start, &boat, &hull);
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
        ledger.note(culprit.or(hull.mass_kg).map_or(start, |given| given.at), message);
    }
    (ledger.faults() == faults).then_some(boat)
}

/// The hull as given, with 0 for what is not.
fn given_hull(ledger: &mut Ledger, start: usize, raw: &RawHull) -> Hull {
    let crossflow = ledger.number("crossflow_coefficient", raw.crossflow_coefficient.as_ref(), 0.0..=3.0);
    if crossflow.is_some_and(|coefficient| coefficient > 0.0) && raw.crossflow_draught_m.is_none() {
        ledger.note_missing(start, "hull.crossflow_draught_m", "0 to 20 with a crossflow_coefficient");
    }
    let mass_kg = ledger.required(start, "hull.mass_kg", raw.mass_kg.as_ref(), 0.1..=1e6);
    let mut or_zero = |key: &str, given: &Option<At<f64>>, low: f64, high: f64| {
        ledger.number(key, given.as_ref(), low..=high).unwrap_or(0.0)
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
        munk_factor: ledger.number("munk_factor", raw.munk_factor.as_ref(), 0.0..=1.0).unwrap_or(0.5),
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
}

/// A mass matrix with a direction that has no inertia would accelerate without bound.
fn check_inertia(ledger: &mut Ledger, start: usize, boat: &Boat, raw: &RawHull) {
    let hull = &boat.hull;
    let place = |given: &Option<At<f64>>| given.as_ref().map_or(start, |given| given.at);
    let (m, x_g, i_z) = (hull.mass_kg, hull.x_g_m, hull.yaw_inertia_kg_m2);
    if x_g.abs() > boat.length_m / 2.0 {
        let half_m = boat.length_m / 2.0;
        ledger.note(place(&raw.x_g_m), format!("x_g_m is {x_g}, expected -{half_m} to {half_m}, within the hull"));
    } else if i_z <= m * x_g * x_g {
        let message = format!("yaw_inertia_kg_m2 is {i_z}, expected more than m x_g² = {}", m * x_g * x_g);
        ledger.note(place(&raw.yaw_inertia_kg_m2), message);
    }
    let coupling = m * x_g + hull.added_sway_yaw_kg_m;
    if (m + hull.added_sway_kg) * (i_z + hull.added_yaw_kg_m2) <= coupling * coupling {
        let message = format!(
            "added_sway_yaw_kg_m is {}, expected a mass matrix that is positive definite: \
             (m + A22)(I + A66) more than (m x_g + A26)²",
            hull.added_sway_yaw_kg_m
        );
        ledger.note(place(&raw.added_sway_yaw_kg_m), message);
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

fn thruster(ledger: &mut Ledger, start: usize, raw: &RawThruster) -> Thruster {
    let curve = match (&raw.propeller, &raw.table_pct_newton) {
        (Some(given), None) => propeller(ledger, given),
        (None, Some(given)) => table(ledger, given),
        (Some(given), Some(_)) => {
            ledger.note(given.at, "thruster has both, expected either propeller or table_pct_newton");
            ThrustCurve::Table { points: vec![] }
        }
        (None, None) => {
            ledger.note_missing(start, "thruster.propeller", "it or table_pct_newton");
            ThrustCurve::Table { points: vec![] }
        }
    };
    Thruster {
        arm_m: ledger.required(start, "thruster.arm_m", raw.arm_m.as_ref(), 0.01..=25.0),
        curve,
        lag_s: ledger.number("lag_s", raw.lag_s.as_ref(), 0.0..=60.0).unwrap_or(0.2),
        slew_per_s: ledger.number("slew_per_s", raw.slew_per_s.as_ref(), 0.001..=1000.0).unwrap_or(10.0),
        deadband: ledger.number("deadband", raw.deadband.as_ref(), 0.0..=0.9).unwrap_or(0.0),
        flaws: Flaws::default(),
    }
}

fn propeller(ledger: &mut Ledger, given: &At<RawPropeller>) -> ThrustCurve {
    let raw = &given.value;
    let k_ahead = ledger.required(given.at, "propeller.k_ahead", raw.k_ahead.as_ref(), 1e-8..=1000.0);
    let n_max_rad_s = ledger.required(given.at, "propeller.n_max_rad_s", raw.n_max_rad_s.as_ref(), 0.1..=1e4);
    ThrustCurve::Propeller {
        k_ahead,
        k_astern: ledger.number("k_astern", raw.k_astern.as_ref(), 1e-8..=1000.0).unwrap_or(k_ahead),
        n_max_rad_s,
        n_min_rad_s: ledger.number("n_min_rad_s", raw.n_min_rad_s.as_ref(), 0.1..=1e4).unwrap_or(n_max_rad_s),
    }
}

fn table(ledger: &mut Ledger, given: &At<Vec<At<Pair>>>) -> ThrustCurve {
    let mut points: Vec<(f64, f64)> = vec![];
    for row in &given.value {
        let [setting_pct, thrust_newton] = row.value.0;
        let setting = ledger.number("table_pct_newton", Some(&same_place(row, setting_pct)), -100.0..=100.0);
        let thrust = ledger.number("table_pct_newton", Some(&same_place(row, thrust_newton)), -1e6..=1e6);
        let (Some(setting_pct), Some(thrust)) = (setting, thrust) else { continue };
        let point = (setting_pct / 100.0, thrust);
        if points.last().is_some_and(|last| point.0 <= last.0 || point.1 <= last.1) {
            let message = format!("table_pct_newton has [{setting_pct}, {thrust}] here, expected both to rise");
            ledger.note(row.at, message);
        }
        points.push(point);
    }
    let ends = (points.first().map(|first| first.0), points.last().map(|last| last.0));
    if ends != (Some(-1.0), Some(1.0)) {
        ledger.note(given.at, "table_pct_newton does not span the settings, expected -100 first and 100 last");
    }
    if !points.contains(&(0.0, 0.0)) {
        ledger.note(given.at, "table_pct_newton has no [0, 0], expected it: no setting, no thrust");
    }
    ThrustCurve::Table { points }
}

fn autopilot(ledger: &mut Ledger, start: usize, raw: &RawAutopilot) -> Autopilot {
    let speed_max = raw.speed_max_m_s.as_ref();
    let bandwidth = raw.heading_bandwidth_rad_s.as_ref();
    Autopilot {
        speed_max_m_s: ledger.required(start, "autopilot.speed_max_m_s", speed_max, 0.1..=60.0),
        heading_bandwidth_rad_s: ledger.number("heading_bandwidth_rad_s", bandwidth, 0.01..=10.0).unwrap_or(1.0),
        heading_damping: ledger.number("heading_damping", raw.heading_damping.as_ref(), 0.1..=5.0).unwrap_or(1.0),
        speed_time_s: ledger.number("speed_time_s", raw.speed_time_s.as_ref(), 0.1..=60.0).unwrap_or(2.0),
    }
}

fn full_ahead_newton(curve: &ThrustCurve) -> f64 {
    match curve {
        ThrustCurve::Propeller { k_ahead, n_max_rad_s, .. } => k_ahead * n_max_rad_s * n_max_rad_s,
        ThrustCurve::Table { points } => points.last().map_or(0.0, |(_, thrust_newton)| *thrust_newton),
    }
}
