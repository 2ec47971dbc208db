//! Waves, by height and period or by the wind that raises them.

use super::wind::PROFILE_EXPONENT;
use crate::math;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawSpectrum, RawSpreading, RawWaves, RawWind};
use crate::sea::{GRAVITY_M_S2, Spreading, Waves};

/// Waves steeper than this (height over length at the peak) break before they get there.
const STEEPEST: f64 = 0.08;
/// Waves higher than this share of the depth break.
const HIGHEST: f64 = 0.6;

/// Checks waves.
pub(super) fn waves(
    diagnostics: &mut Diagnostics,
    given: &At<RawWaves>,
    wind: Option<&At<RawWind>>,
    depth_m: Option<f64>,
) -> Option<Waves> {
    let faults = diagnostics.faults();
    let (raw, at) = (&given.value, given.at);
    let gamma = gamma(diagnostics, raw);
    let components = diagnostics.whole("components", raw.components.as_ref(), 1..=1024, 64) as u32;
    let drift_factor = diagnostics.number("drift_factor", raw.drift_factor.as_ref(), 0.0..=10.0).unwrap_or(1.0);
    let spreading = spreading(diagnostics, raw);
    let from_wind = wind.and_then(|wind| wind.value.from_deg.as_ref());
    let from_deg = diagnostics.required(at, "waves.from_deg", raw.from_deg.as_ref().or(from_wind), -360.0..=360.0);
    let (hs_m, tp_s) = height_and_period(diagnostics, given, wind)?;
    let steepness = hs_m / peak_length_m(tp_s, depth_m);
    let place = raw.hs_m.as_ref().or(raw.fetch_km.as_ref()).map_or(at, |given| given.at);
    if let Some(depth_m) = depth_m.filter(|depth_m| hs_m > HIGHEST * depth_m) {
        let highest_m = HIGHEST * depth_m;
        diagnostics
            .note(place, format!("waves of hs_m {hs_m:.3} break in {depth_m} m, expected at most {highest_m:.3}"));
    } else if steepness > STEEPEST {
        let message = format!(
            "waves of hs_m {hs_m:.3} and tp_s {tp_s:.3} are {steepness:.3} of their length high, expected at most {STEEPEST}"
        );
        diagnostics.note(place, message);
    }
    let waves = Waves { hs_m, tp_s, gamma, from_rad: from_deg.to_radians(), spreading, components, drift_factor };
    (diagnostics.faults() == faults).then_some(waves)
}

fn gamma(diagnostics: &mut Diagnostics, raw: &RawWaves) -> f64 {
    let jonswap = raw.spectrum.unwrap_or_default() == RawSpectrum::Jonswap;
    match &raw.gamma {
        Some(given) if !jonswap => {
            diagnostics.note(given.at, format!("gamma is {}, expected none: it belongs to \"jonswap\"", given.value));
            1.0
        }
        given => diagnostics.number("gamma", given.as_ref(), 1.0..=7.0).unwrap_or(if jonswap { 3.3 } else { 1.0 }),
    }
}

/// Significant height, m, and peak period, s.
fn height_and_period(
    diagnostics: &mut Diagnostics,
    given: &At<RawWaves>,
    wind: Option<&At<RawWind>>,
) -> Option<(f64, f64)> {
    let (raw, at) = (&given.value, given.at);
    let hs_m = diagnostics.number("hs_m", raw.hs_m.as_ref(), 0.0..=20.0);
    let tp_s = diagnostics.number("tp_s", raw.tp_s.as_ref(), 0.5..=30.0);
    let fetch_km = diagnostics.number("fetch_km", raw.fetch_km.as_ref(), 0.05..=1000.0);
    let own_m_s = diagnostics.number("wind_m_s", raw.wind_m_s.as_ref(), 0.5..=50.0);
    if let (Some(_), Some(fetch)) = (&raw.hs_m, &raw.fetch_km) {
        diagnostics.note(fetch.at, "fetch_km beside hs_m, expected either height and period, or the fetch");
        return None;
    }
    let fully_grown = raw.spectrum == Some(RawSpectrum::PiersonMoskowitz);
    if let (true, Some(tp)) = (fully_grown, &raw.tp_s) {
        diagnostics.note(tp.at, "tp_s is given, expected none: that of \"pierson_moskowitz\" follows from the height");
        return None;
    }
    // A sea without wind raises no waves; 0.5 m/s is the least that may be stated here.
    let of_sea = wind.and_then(|wind| wind.value.speed_m_s.as_ref()).map(|speed| speed.value.clamp(0.5, 50.0));
    let wind_m_s = own_m_s.or(of_sea);
    match (hs_m, tp_s, fetch_km, wind_m_s) {
        (Some(hs_m), _, _, _) if fully_grown => Some(fully_grown_with(hs_m)),
        (None, _, None, Some(u_10)) if fully_grown => {
            let u_19_5 = u_10 * libm::pow(1.95, profile_exponent(wind));
            Some(fully_grown_with(0.209_2 * u_19_5 * u_19_5 / GRAVITY_M_S2))
        }
        (Some(hs_m), Some(tp_s), _, _) => Some((hs_m, tp_s)),
        (_, _, Some(x_km), Some(u)) if !fully_grown => {
            // Carter, D. J. T. (1982). Prediction of wave height and period for a constant wind velocity. The sea is fully
            // grown, with Hs = 0.02481 U², after 2.317 U² km.
            let x_km = x_km.min(2.317 * u * u);
            Some((0.0163 * x_km.sqrt() * u, 0.566 * math::exp(0.3 * libm::log(x_km) + 0.4 * libm::log(u))))
        }
        _ => {
            let expected = match fully_grown {
                true => "hs_m, or wind_m_s, or a wind",
                false => "hs_m and tp_s, or fetch_km with wind_m_s or a wind",
            };
            diagnostics.note_missing(at, "waves' size", expected);
            None
        }
    }
}

/// That of the wind's power law; its range is checked with the wind.
fn profile_exponent(wind: Option<&At<RawWind>>) -> f64 {
    let given = wind.and_then(|wind| wind.value.profile_exponent.as_ref());
    given.map_or(PROFILE_EXPONENT, |given| given.value)
}

/// Height and period of a fully grown sea of this height.
///
/// Pierson and Moskowitz (1964): S = 8.1e-3 g² ω^-5 exp(-0.74 (g / (U ω))^4), with U 19.5 m above the water. Hence
/// Hs = 0.2092 U² / g, and the peak is at 0.8772 g / U.
fn fully_grown_with(hs_m: f64) -> (f64, f64) {
    let u_m_s = (hs_m * GRAVITY_M_S2 / 0.209_2).sqrt().max(0.1);
    (hs_m, std::f64::consts::TAU * u_m_s / (0.877_2 * GRAVITY_M_S2))
}

/// The length of waves of this period, m.
fn peak_length_m(tp_s: f64, depth_m: Option<f64>) -> f64 {
    let omega = std::f64::consts::TAU / tp_s;
    let deep = omega * omega / GRAVITY_M_S2;
    // Guo (2002), within 0.75 %.
    let k = depth_m.map_or(deep, |h| {
        let x = h * omega / (GRAVITY_M_S2 * h).sqrt();
        x * x / h * libm::pow(1.0 - math::exp(-libm::pow(x, 2.4908)), -0.4015)
    });
    std::f64::consts::TAU / k
}

fn spreading(diagnostics: &mut Diagnostics, raw: &RawWaves) -> Spreading {
    let kind = raw.spreading.unwrap_or_default();
    let s = diagnostics.number("spread_s", raw.spread_s.as_ref(), 1.0..=200.0);
    if let (Some(given), true) = (&raw.spread_s, kind != RawSpreading::Cosine2s) {
        diagnostics.note(given.at, "spread_s is given, expected spreading = \"cosine_2s\" with it");
    }
    match kind {
        RawSpreading::None => Spreading::None,
        RawSpreading::CosineSquared => Spreading::CosineSquared,
        RawSpreading::Cosine2s => Spreading::Cosine2s { s: s.unwrap_or(10.0) },
    }
}
