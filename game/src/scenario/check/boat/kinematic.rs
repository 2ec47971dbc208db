//! The kinematic boat.

use crate::boat::{Kinematic, Pid};
use crate::scenario::check::same_place;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, Pair, RawKinematic, RawPid};

/// Checks a kinematic boat.
pub(super) fn kinematic(diagnostics: &mut Diagnostics, given: &At<RawKinematic>) -> Kinematic {
    let (raw, at) = (&given.value, given.at);
    let rotate_deg_s = diagnostics.number("rotate_deg_s", raw.rotate_deg_s.as_ref(), -90.0..=90.0).unwrap_or(0.0);
    let speed_factor = diagnostics.number("speed_factor", raw.speed_factor.as_ref(), 0.0..=1000.0).unwrap_or(0.0);
    if raw.speed_pid.is_none() && speed_factor == 0.0 {
        diagnostics.note_missing(at, "kinematic.speed_pid", "it or speed_factor");
    }
    if raw.heading_pid.is_none() {
        diagnostics.note_missing(at, "kinematic.heading_pid", "a table of gains");
    }
    Kinematic {
        speed_max_m_s: diagnostics.required(at, "kinematic.speed_max_m_s", raw.speed_max_m_s.as_ref(), 0.1..=60.0),
        thrust_map: required_map(diagnostics, at, raw.thrust_map.as_ref()),
        thrust_max: diagnostics.number("thrust_max", raw.thrust_max.as_ref(), 1.0..=100.0).unwrap_or(100.0),
        rudder_max: diagnostics.number("rudder_max", raw.rudder_max.as_ref(), 1.0..=100.0).unwrap_or(100.0),
        turn_rate: diagnostics.required(at, "kinematic.turn_rate", raw.turn_rate.as_ref(), 0.0..=1000.0),
        turn_loss: diagnostics.number("turn_loss", raw.turn_loss.as_ref(), 0.0..=1.0).unwrap_or(0.85),
        rotate_rad_s: rotate_deg_s.to_radians(),
        acceleration_max_m_s2: limit(diagnostics, "acceleration_max_m_s2", raw.acceleration_max_m_s2.as_ref(), 0.0),
        deceleration_max_m_s2: limit(diagnostics, "deceleration_max_m_s2", raw.deceleration_max_m_s2.as_ref(), 0.5),
        speed_factor,
        speed_pid: pid(diagnostics, raw.speed_pid.as_ref()),
        heading_pid: pid(diagnostics, raw.heading_pid.as_ref()),
    }
}

fn limit(diagnostics: &mut Diagnostics, key: &str, given: Option<&At<f64>>, default: f64) -> f64 {
    diagnostics.number(key, given, 0.0..=100.0).unwrap_or(default)
}

fn required_map(diagnostics: &mut Diagnostics, owner: usize, given: Option<&At<Vec<At<Pair>>>>) -> Vec<(f64, f64)> {
    let Some(given) = given else {
        diagnostics.note_missing(owner, "kinematic.thrust_map", "pairs of per cent and m/s");
        return vec![];
    };
    thrust_map(diagnostics, given)
}

/// Checks a map of thrust in per cent and speed in m/s.
pub(in crate::scenario::check) fn thrust_map(
    diagnostics: &mut Diagnostics,
    given: &At<Vec<At<Pair>>>,
) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = vec![];
    for row in &given.value {
        let [thrust_pct, speed_m_s] = row.value.0;
        diagnostics.number("thrust_map", Some(&same_place(row, thrust_pct)), -100.0..=100.0);
        diagnostics.number("thrust_map", Some(&same_place(row, speed_m_s)), -60.0..=60.0);
        if points.last().is_some_and(|last| thrust_pct <= last.0 || speed_m_s < last.1) {
            diagnostics.note(row.at, format!("thrust_map has [{thrust_pct}, {speed_m_s}] here, expected both to rise"));
        }
        points.push((thrust_pct, speed_m_s));
    }
    if points.len() < 2 || !points.contains(&(0.0, 0.0)) {
        diagnostics.note(given.at, "thrust_map has no [0, 0] or nothing beside it, expected it: no thrust, no speed");
    }
    points
}

fn pid(diagnostics: &mut Diagnostics, given: Option<&RawPid>) -> Pid {
    let raw = given.cloned().unwrap_or_default();
    let mut gain = |key: &str, given: &Option<At<f64>>, low: f64| {
        diagnostics.number(key, given.as_ref(), low..=1000.0).unwrap_or(0.0)
    };
    Pid {
        p: gain("p", &raw.p, -1000.0),
        i: gain("i", &raw.i, -1000.0),
        d: gain("d", &raw.d, -1000.0),
        i_limit: gain("i_limit", &raw.i_limit, 0.0),
    }
}
