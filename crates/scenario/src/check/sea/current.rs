//! Checks the current.

use crate::raw;
use crate::read::Document;
use crate::sea::{Current, Shear, Tide, Wander};
use primitives::frame::Ned;

pub(super) fn current(document: &Document<raw::Sea>, raw: &raw::Current) -> Current {
    let toward = Ned::toward_deg(raw.toward_deg);
    let rising = |key: &str, (from, to): (f64, f64)| {
        if from > to {
            let name = key.rsplit('.').next().unwrap_or(key);
            let message = format!("{name} is [{from}, {to}], expected the smaller value first");
            document.note(key, message);
        }
    };
    if let Some(wander) = &raw.wander {
        rising("current.wander.speed_m_s", wander.speed_m_s);
    }
    if let Some(eddies) = &raw.eddies {
        rising("current.eddies.radius_m", eddies.radius_m);
        rising("current.eddies.peak_m_s", eddies.peak_m_s);
    }
    Current {
        mean_m_s: toward.scaled(raw.speed_m_s),
        wander: raw.wander.map(|wander| Wander { toward, ..wander }),
        tide: raw.tide.as_ref().map(|raw| Tide {
            flood_m_s: Ned::toward_deg(raw.toward_deg).scaled(raw.speed_m_s),
            period_s: 3600.0 * raw.period_h,
            phase: raw.phase,
        }),
        shear: raw.shear.as_ref().map(|raw| Shear {
            toward: Ned::toward_deg(raw.toward_deg),
            across: Ned::toward_deg(raw.toward_deg + 90.0),
            per_s: raw.per_s,
            origin: Ned::from_xy(raw.origin[0], raw.origin[1]),
        }),
        eddies: raw.eddy.clone(),
        random_eddies: raw.eddies,
    }
}
