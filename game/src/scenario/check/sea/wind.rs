//! Wind.

use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawGusts, RawWind};
use crate::sea::{Gusts, Wind};

/// The exponent of the power law over open water, by default.
pub(super) const PROFILE_EXPONENT: f64 = 0.12;

/// Checks wind.
pub(super) fn wind(diagnostics: &mut Diagnostics, given: &At<RawWind>) -> Option<Wind> {
    let faults = diagnostics.faults();
    let (raw, at) = (&given.value, given.at);
    let speed_10m_m_s = diagnostics.required(at, "wind.speed_m_s", raw.speed_m_s.as_ref(), 0.0..=50.0);
    let from_deg = diagnostics.required(at, "wind.from_deg", raw.from_deg.as_ref(), -360.0..=360.0);
    let exponent = diagnostics.number("profile_exponent", raw.profile_exponent.as_ref(), 0.0..=0.5);
    let gusts = gusts(diagnostics, raw);
    let wind = Wind {
        speed_10m_m_s,
        from_rad: from_deg.to_radians(),
        profile_exponent: exponent.unwrap_or(PROFILE_EXPONENT),
        gusts,
    };
    (diagnostics.faults() == faults).then_some(wind)
}

fn gusts(diagnostics: &mut Diagnostics, raw: &RawWind) -> Gusts {
    let kind = raw.gusts.unwrap_or_default();
    let intensity = diagnostics.number("intensity", raw.intensity.as_ref(), 0.0..=0.5).unwrap_or(0.14);
    let across_ratio = diagnostics.number("across_ratio", raw.across_ratio.as_ref(), 0.0..=1.0).unwrap_or(0.75);
    let length_m = diagnostics.number("length_m", raw.length_m.as_ref(), 1.0..=1000.0).unwrap_or(45.0);
    let components = diagnostics.whole("components", raw.components.as_ref(), 1..=1024, 64) as u32;
    match (kind, kind.spectrum()) {
        (RawGusts::None, _) => Gusts::None,
        (_, None) => Gusts::OrnsteinUhlenbeck { intensity, across_ratio, length_m },
        (_, Some(spectrum)) => Gusts::Spectral { spectrum, intensity, across_ratio, components },
    }
}
