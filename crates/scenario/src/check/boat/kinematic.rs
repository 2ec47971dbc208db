//! Checks kinematic boats and thrust maps.

use crate::boat::Kinematic;
use crate::raw;
use crate::read::Document;

pub(super) fn check_kinematic(document: &Document<raw::Boat>, kinematic: &Kinematic) {
    if kinematic.speed_factor == 0.0 && !document.has("kinematic.speed_pid") {
        document.note_missing("kinematic.speed_pid", "speed_pid or speed_factor");
    }
    check_thrust_map(document, "kinematic.thrust_map", &kinematic.thrust_map);
}

/// Checks the map of thrust (per cent) to speed (m/s) at `path`.
pub fn check_thrust_map<T>(document: &Document<T>, path: &str, points: &[(f64, f64)]) {
    if !document.is_sound(path) {
        return;
    }
    for (i, [last, (thrust_pct, speed_m_s)]) in points.array_windows().enumerate() {
        if *thrust_pct <= last.0 || *speed_m_s < last.1 {
            let message = format!(
                "thrust_map has [{thrust_pct}, {speed_m_s}] here, expected thrust above and speed not below the previous row"
            );
            document.note(&format!("{path}.{}", i + 1), message);
        }
    }
    if points.len() < 2 || !points.contains(&(0.0, 0.0)) {
        let message = "thrust_map lacks [0, 0] or a second row, expected both";
        document.note(path, message);
    }
}
