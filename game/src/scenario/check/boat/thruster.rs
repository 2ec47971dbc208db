//! Thrusters, what they fall short of, and the front seat.

use crate::boat::{Autopilot, Battery, Flaws, ThrustCurve, Thruster, Ventilation};
use crate::scenario::check::same_place;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, Pair, RawAutopilot, RawBattery, RawPropeller, RawThruster, RawVentilation};

/// Checks thrusters.
pub(super) fn thruster(diagnostics: &mut Diagnostics, start: usize, raw: &RawThruster) -> Thruster {
    let curve = match (&raw.propeller, &raw.table_pct_newton) {
        (Some(given), None) => propeller(diagnostics, given),
        (None, Some(given)) => table(diagnostics, given),
        (Some(given), Some(_)) => {
            diagnostics.note(given.at, "thruster has both, expected either propeller or table_pct_newton");
            ThrustCurve::Table { points: vec![] }
        }
        (None, None) => {
            diagnostics.note_missing(start, "thruster.propeller", "it or table_pct_newton");
            ThrustCurve::Table { points: vec![] }
        }
    };
    Thruster {
        arm_m: diagnostics.required(start, "thruster.arm_m", raw.arm_m.as_ref(), 0.01..=25.0),
        curve,
        lag_s: diagnostics.number("lag_s", raw.lag_s.as_ref(), 0.0..=60.0).unwrap_or(0.2),
        slew_per_s: diagnostics.number("slew_per_s", raw.slew_per_s.as_ref(), 0.001..=1000.0).unwrap_or(10.0),
        deadband: diagnostics.number("deadband", raw.deadband.as_ref(), 0.0..=0.9).unwrap_or(0.0),
        flaws: flaws(diagnostics, raw),
    }
}

fn propeller(diagnostics: &mut Diagnostics, given: &At<RawPropeller>) -> ThrustCurve {
    let raw = &given.value;
    let k_ahead = diagnostics.required(given.at, "propeller.k_ahead", raw.k_ahead.as_ref(), 1e-8..=1000.0);
    let n_max_rad_s = diagnostics.required(given.at, "propeller.n_max_rad_s", raw.n_max_rad_s.as_ref(), 0.1..=1e4);
    ThrustCurve::Propeller {
        k_ahead,
        k_astern: diagnostics.number("k_astern", raw.k_astern.as_ref(), 1e-8..=1000.0).unwrap_or(k_ahead),
        n_max_rad_s,
        n_min_rad_s: diagnostics.number("n_min_rad_s", raw.n_min_rad_s.as_ref(), 0.1..=1e4).unwrap_or(n_max_rad_s),
    }
}

fn table(diagnostics: &mut Diagnostics, given: &At<Vec<At<Pair>>>) -> ThrustCurve {
    let mut points: Vec<(f64, f64)> = vec![];
    for row in &given.value {
        let [setting_pct, thrust_newton] = row.value.0;
        let setting = diagnostics.number("table_pct_newton", Some(&same_place(row, setting_pct)), -100.0..=100.0);
        let thrust = diagnostics.number("table_pct_newton", Some(&same_place(row, thrust_newton)), -1e6..=1e6);
        let (Some(setting_pct), Some(thrust)) = (setting, thrust) else { continue };
        let point = (setting_pct / 100.0, thrust);
        if points.last().is_some_and(|last| point.0 <= last.0 || point.1 <= last.1) {
            let message = format!("table_pct_newton has [{setting_pct}, {thrust}] here, expected both to rise");
            diagnostics.note(row.at, message);
        }
        points.push(point);
    }
    let ends = (points.first().map(|first| first.0), points.last().map(|last| last.0));
    if ends != (Some(-1.0), Some(1.0)) {
        diagnostics.note(given.at, "table_pct_newton does not span the settings, expected -100 first and 100 last");
    }
    if !points.contains(&(0.0, 0.0)) {
        diagnostics.note(given.at, "table_pct_newton has no [0, 0], expected it: no setting, no thrust");
    }
    ThrustCurve::Table { points }
}

/// Checks a front seat.
pub(super) fn autopilot(diagnostics: &mut Diagnostics, start: usize, raw: &RawAutopilot) -> Autopilot {
    let speed_max = raw.speed_max_m_s.as_ref();
    let bandwidth = raw.heading_bandwidth_rad_s.as_ref();
    Autopilot {
        speed_max_m_s: diagnostics.required(start, "autopilot.speed_max_m_s", speed_max, 0.1..=60.0),
        heading_bandwidth_rad_s: diagnostics.number("heading_bandwidth_rad_s", bandwidth, 0.01..=10.0).unwrap_or(1.0),
        heading_damping: diagnostics.number("heading_damping", raw.heading_damping.as_ref(), 0.1..=5.0).unwrap_or(1.0),
        speed_time_s: diagnostics.number("speed_time_s", raw.speed_time_s.as_ref(), 0.1..=60.0).unwrap_or(2.0),
    }
}

fn flaws(diagnostics: &mut Diagnostics, raw: &RawThruster) -> Flaws {
    let mut number = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
    };
    Flaws {
        saturation: number("saturation", &raw.saturation, 0.05, 1.0, 1.0),
        gain: (
            number("port_gain", &raw.port_gain, 0.0, 2.0, 1.0),
            number("starboard_gain", &raw.starboard_gain, 0.0, 2.0, 1.0),
        ),
        reverse_efficiency: number("reverse_efficiency", &raw.reverse_efficiency, 0.0, 1.0, 1.0),
        bias_newton_m: number("bias_newton_m", &raw.bias_newton_m, -1e6, 1e6, 0.0),
        latency_s: number("latency_s", &raw.latency_s, 0.0, 5.0, 0.0),
        watchdog_s: diagnostics.number("watchdog_s", raw.watchdog_s.as_ref(), 0.1..=3600.0),
        battery: raw.battery.as_ref().map(|given| battery(diagnostics, given)),
        ventilation: raw.ventilation.as_ref().map(|given| ventilation(diagnostics, given)),
    }
}

fn battery(diagnostics: &mut Diagnostics, given: &At<RawBattery>) -> Battery {
    let raw = &given.value;
    Battery {
        capacity_joule: 3600.0
            * diagnostics.required(given.at, "battery.capacity_wh", raw.capacity_wh.as_ref(), 1.0..=1e6),
        charge: diagnostics.number("charge", raw.charge.as_ref(), 0.0..=1.0).unwrap_or(1.0),
        full_power_watt: diagnostics.required(given.at, "battery.full_power_w", raw.full_power_w.as_ref(), 0.0..=1e6),
        hotel_power_watt: diagnostics.number("hotel_power_w", raw.hotel_power_w.as_ref(), 0.0..=1e5).unwrap_or(0.0),
        sag: diagnostics.number("sag", raw.sag.as_ref(), 0.0..=0.9).unwrap_or(0.15),
    }
}

fn ventilation(diagnostics: &mut Diagnostics, given: &At<RawVentilation>) -> Ventilation {
    Ventilation {
        depth_m: diagnostics.required(given.at, "ventilation.depth_m", given.value.depth_m.as_ref(), 0.01..=10.0),
    }
}
