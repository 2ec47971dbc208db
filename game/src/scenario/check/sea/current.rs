//! The water's own motion.

use crate::frame::Ned;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, Pair, RawCurrent, RawEddies, RawEddy, RawShear, RawTide, RawWander};
use crate::sea::{Current, Eddy, RandomEddies, Shear, Tide, Wander};
use std::ops::RangeInclusive;

const SPEED_M_S: RangeInclusive<f64> = 0.0..=10.0;
const BEARING_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Where something can stand, m from the datum.
const PLACE_M: RangeInclusive<f64> = -1e6..=1e6;

/// Checks a current.
pub(super) fn current(diagnostics: &mut Diagnostics, given: &At<RawCurrent>) -> Current {
    let raw = &given.value;
    let speed_m_s = diagnostics.number("speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S).unwrap_or(0.0);
    let toward_deg = diagnostics.number("toward_deg", raw.toward_deg.as_ref(), BEARING_DEG).unwrap_or(0.0);
    let toward = Ned::toward_deg(toward_deg);
    Current {
        mean_m_s: toward.scaled(speed_m_s),
        wander: raw.wander.as_ref().map(|given| wander(diagnostics, given, toward)),
        tide: raw.tide.as_ref().map(|given| tide(diagnostics, given)),
        shear: raw.shear.as_ref().map(|given| shear(diagnostics, given)),
        eddies: raw.eddy.iter().flatten().map(|given| eddy(diagnostics, given)).collect(),
        eddies_by_lot: raw.eddies.as_ref().map(|given| eddies(diagnostics, given)),
    }
}

fn wander(diagnostics: &mut Diagnostics, given: &At<RawWander>, toward: Ned) -> Wander {
    let raw = &given.value;
    Wander {
        toward,
        sigma_m_s: diagnostics.required(given.at, "wander.sigma_m_s", raw.sigma_m_s.as_ref(), 0.0..=5.0),
        time_s: diagnostics.number("time_s", raw.time_s.as_ref(), 1.0..=86_400.0).unwrap_or(300.0),
        speed_m_s: from_to(diagnostics, "speed_m_s", raw.speed_m_s.as_ref(), -10.0..=10.0, (-10.0, 10.0)),
    }
}

fn tide(diagnostics: &mut Diagnostics, given: &At<RawTide>) -> Tide {
    let raw = &given.value;
    let speed_m_s = diagnostics.required(given.at, "tide.speed_m_s", raw.speed_m_s.as_ref(), SPEED_M_S);
    let toward_deg = diagnostics.required(given.at, "tide.toward_deg", raw.toward_deg.as_ref(), BEARING_DEG);
    let period_h = diagnostics.number("period_h", raw.period_h.as_ref(), 0.01..=1000.0).unwrap_or(12.42);
    Tide {
        flood_m_s: Ned::toward_deg(toward_deg).scaled(speed_m_s),
        period_s: 3600.0 * period_h,
        phase: diagnostics.number("phase", raw.phase.as_ref(), 0.0..=1.0).unwrap_or(0.0),
    }
}

fn shear(diagnostics: &mut Diagnostics, given: &At<RawShear>) -> Shear {
    let raw = &given.value;
    let toward_deg = diagnostics.required(given.at, "shear.toward_deg", raw.toward_deg.as_ref(), BEARING_DEG);
    let (x, y) = diagnostics.pair("origin", raw.origin.as_ref(), PLACE_M).unwrap_or((0.0, 0.0));
    Shear {
        toward: Ned::toward_deg(toward_deg),
        across: Ned::toward_deg(toward_deg + 90.0),
        per_s: diagnostics.required(given.at, "shear.per_s", raw.per_s.as_ref(), -1.0..=1.0),
        origin: Ned::from_xy(x, y),
    }
}

fn eddy(diagnostics: &mut Diagnostics, given: &At<RawEddy>) -> Eddy {
    let raw = &given.value;
    if raw.centre.is_none() {
        diagnostics.note_missing(given.at, "eddy.centre", "[x, y]");
    }
    let (x, y) = diagnostics.pair("centre", raw.centre.as_ref(), PLACE_M).unwrap_or((0.0, 0.0));
    Eddy {
        centre: Ned::from_xy(x, y),
        radius_m: diagnostics.required(given.at, "eddy.radius_m", raw.radius_m.as_ref(), 1.0..=1000.0),
        peak_m_s: diagnostics.required(given.at, "eddy.peak_m_s", raw.peak_m_s.as_ref(), -5.0..=5.0),
    }
}

fn eddies(diagnostics: &mut Diagnostics, given: &At<RawEddies>) -> RandomEddies {
    let raw = &given.value;
    if raw.count.is_none() {
        diagnostics.note_missing(given.at, "eddies.count", "0 to 100");
    }
    RandomEddies {
        count: diagnostics.whole("count", raw.count.as_ref(), 0..=100, 0) as u32,
        radius_m: from_to(diagnostics, "radius_m", raw.radius_m.as_ref(), 1.0..=1000.0, (10.0, 40.0)),
        peak_m_s: from_to(diagnostics, "peak_m_s", raw.peak_m_s.as_ref(), 0.0..=5.0, (0.1, 0.3)),
    }
}

/// Two numbers of which the second is not less.
fn from_to(
    diagnostics: &mut Diagnostics,
    key: &str,
    given: Option<&At<Pair>>,
    allowed: RangeInclusive<f64>,
    default: (f64, f64),
) -> (f64, f64) {
    let Some((from, to)) = diagnostics.pair(key, given, allowed) else { return default };
    if let (Some(given), true) = (given, from > to) {
        diagnostics.note(given.at, format!("{key} goes from {from} to {to}, expected the smaller one first"));
    }
    (from, to)
}
