//! Checks thrusters and their flaws.

use crate::boat::{Propeller, ThrustCurve, Thruster};
use crate::raw;
use crate::read::Document;

pub(super) fn thruster(document: &Document<raw::Boat>, raw: &raw::Thruster) -> Option<Thruster> {
    let curve = match (&raw.propeller, &raw.table_pct_newton) {
        (Some(propeller), None) => {
            let (k_ahead, n_max_rad_s) = (propeller.k_ahead, propeller.n_max_rad_s);
            ThrustCurve::Propeller(Propeller {
                k_ahead,
                k_astern: propeller.k_astern.unwrap_or(k_ahead),
                n_max_rad_s,
                n_min_rad_s: propeller.n_min_rad_s.unwrap_or(n_max_rad_s),
            })
        }
        (None, Some(rows)) => table(document, rows),
        (Some(_), Some(_)) => {
            let message = "thruster has both propeller and table_pct_newton, expected only one";
            document.note("thruster.propeller", message);
            return None;
        }
        (None, None) => {
            if document.is_sound("thruster.table_pct_newton") {
                document.note_missing("thruster.propeller", "propeller or table_pct_newton");
            }
            return None;
        }
    };
    Some(Thruster {
        arm_m: raw.arm_m,
        curve,
        lag_s: raw.lag_s,
        slew_per_s: raw.slew_per_s,
        deadband: raw.deadband,
        flaws: raw.flaws.clone(),
    })
}

fn table(document: &Document<raw::Boat>, rows: &[raw::SettingAndThrust]) -> ThrustCurve {
    let path = "thruster.table_pct_newton";
    let points: Vec<(f64, f64)> = rows.iter().map(|row| (row.0 / 100.0, row.1)).collect();
    if document.is_sound(path) {
        for (i, row) in rows.iter().enumerate().skip(1) {
            if points[i].0 <= points[i - 1].0 || points[i].1 <= points[i - 1].1 {
                let message = format!(
                    "table_pct_newton has [{}, {}] here; both numbers must exceed those of the previous row",
                    row.0, row.1
                );
                document.note(&format!("{path}.{i}"), message);
            }
        }
        let ends = [points.first(), points.last()].map(|end| end.map(|end| end.0));
        if ends != [Some(-1.0), Some(1.0)] {
            let message = "table_pct_newton does not cover the full range of settings, expected -100 first and 100 last";
            document.note(path, message);
        }
        if !points.contains(&(0.0, 0.0)) {
            let message = "table_pct_newton has no [0, 0], expected no thrust at setting 0";
            document.note(path, message);
        }
    }
    ThrustCurve::Table { points }
}
