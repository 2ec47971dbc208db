//! The kinematic boat.

use crate::boat::Kinematic;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;

/// Checks a kinematic boat.
pub(super) fn kinematic(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Boat>,
    raw: &raw::Kinematic,
) -> Kinematic {
    if raw.speed_pid.is_none() && raw.speed_factor == 0.0 && document.is_sound("kinematic.speed_pid") {
        let message = "kinematic.speed_pid is missing, expected it or speed_factor";
        diagnostics.note_if_intact(document.at("kinematic"), message);
    }
    Kinematic {
        speed_max_m_s: raw.speed_max_m_s,
        thrust_map: thrust_map(diagnostics, document, "kinematic.thrust_map", &raw.thrust_map),
        thrust_max: raw.thrust_max,
        rudder_max: raw.rudder_max,
        turn_rate: raw.turn_rate,
        turn_loss: raw.turn_loss,
        rotate_rad_s: raw.rotate_deg_s.to_radians(),
        acceleration_max_m_s2: raw.acceleration_max_m_s2,
        deceleration_max_m_s2: raw.deceleration_max_m_s2,
        speed_factor: raw.speed_factor,
        speed_pid: raw.speed_pid.unwrap_or_default(),
        heading_pid: raw.heading_pid,
    }
}

/// Checks a map of thrust in per cent and speed in m/s, given at `path`.
pub(in crate::scenario::check) fn thrust_map<T>(
    diagnostics: &mut Diagnostics,
    document: &Document<T>,
    path: &str,
    raw: &[raw::ThrustAndSpeed],
) -> Vec<(f64, f64)> {
    let points: Vec<(f64, f64)> = raw.iter().map(|point| (point.0, point.1)).collect();
    if !document.is_sound(path) {
        return points;
    }
    for (i, [last, (thrust_pct, speed_m_s)]) in points.array_windows().enumerate() {
        if *thrust_pct <= last.0 || *speed_m_s < last.1 {
            let message = format!("thrust_map has [{thrust_pct}, {speed_m_s}] here, expected both to rise");
            diagnostics.note(document.at(&format!("{path}.{}", i + 1)), message);
        }
    }
    if points.len() < 2 || !points.contains(&(0.0, 0.0)) {
        let message = "thrust_map has no [0, 0] or nothing beside it, expected it: no thrust, no speed";
        diagnostics.note(document.at(path), message);
    }
    points
}
