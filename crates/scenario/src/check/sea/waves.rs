//! Checks waves, given by height and period or by the wind that raised them.

use crate::raw;
use crate::read::Document;
use crate::sea::{GRAVITY_M_S2, PROFILE_EXPONENT, Spreading, Waves};
use primitives::math;

/// Maximum steepness, the significant height divided by the wavelength at the peak; steeper waves
/// break.
const STEEPEST: f64 = 0.08;
/// Maximum height as a fraction of the depth; higher waves break.
const HIGHEST: f64 = 0.6;

pub(super) fn waves(document: &Document<raw::Sea>, raw: &raw::Waves) -> Option<Waves> {
    let depth_m = document.raw.depth_m;
    let wind = document.raw.wind.as_ref();
    let is_jonswap = raw.spectrum == raw::Spectrum::Jonswap;
    if !is_jonswap && document.has("waves.gamma") {
        let message = format!(
            "gamma is {}, expected none: it applies only to \"jonswap\"",
            raw.gamma
        );
        document.note("waves.gamma", message);
    }
    if raw.spreading != raw::Spreading::Cosine2s && document.has("waves.spread_s") {
        let message = "spread_s is given, expected spreading = \"cosine_2s\" with it";
        document.note("waves.spread_s", message);
    }
    let from_deg = raw.from_deg.or(wind.map(|wind| wind.from_deg));
    if from_deg.is_none() {
        document.note_missing("waves.from_deg", "-360 to 360, or a [wind] table");
    }
    let (hs_m, tp_s) = height_and_period(document, raw)?;
    let steepness = hs_m / peak_length_m(tp_s, depth_m);
    let size = ["waves.hs_m", "waves.fetch_km", "waves"]
        .into_iter()
        .find(|path| document.has(path));
    let place = size.unwrap_or("waves");
    if let Some(depth_m) = depth_m.filter(|depth_m| hs_m > HIGHEST * depth_m) {
        let highest_m = HIGHEST * depth_m;
        let message = format!(
            "waves of hs_m {hs_m:.3} break in {depth_m} m, expected at most {highest_m:.3}"
        );
        document.note(place, message);
    } else if steepness > STEEPEST {
        let message = format!(
            "waves of hs_m {hs_m:.3} and tp_s {tp_s:.3} have a steepness of {steepness:.3}, expected at most {STEEPEST}"
        );
        document.note(place, message);
    }
    Some(Waves {
        hs_m,
        tp_s,
        gamma: if is_jonswap { raw.gamma } else { 1.0 },
        from_rad: from_deg?.to_radians(),
        spreading: match raw.spreading {
            raw::Spreading::None => Spreading::None,
            raw::Spreading::CosineSquared => Spreading::CosineSquared,
            raw::Spreading::Cosine2s => Spreading::Cosine2s { s: raw.spread_s },
        },
        components: raw.components,
        drift_factor: raw.drift_factor,
    })
}

/// Significant height, m, and peak period, s.
fn height_and_period(document: &Document<raw::Sea>, raw: &raw::Waves) -> Option<(f64, f64)> {
    let wind = document.raw.wind.as_ref();
    let is_fully_grown = raw.spectrum == raw::Spectrum::PiersonMoskowitz;
    if document.has("waves.hs_m") && document.has("waves.fetch_km") {
        let message =
            "fetch_km is given with hs_m, expected either height and period, or the fetch";
        document.note("waves.fetch_km", message);
        return None;
    }
    if is_fully_grown && document.has("waves.tp_s") {
        let message = "tp_s is given, expected none: the period of \"pierson_moskowitz\" follows from the height";
        document.note("waves.tp_s", message);
        return None;
    }
    // A wind of zero would raise no waves; 0.5 m/s is the minimum.
    let wind_m_s = raw
        .wind_m_s
        .or(wind.map(|wind| wind.speed_m_s.clamp(0.5, 50.0)));
    match (raw.hs_m, raw.tp_s, raw.fetch_km, wind_m_s) {
        (Some(hs_m), ..) if is_fully_grown => Some(fully_grown_with(hs_m)),
        (None, _, None, Some(u_10)) if is_fully_grown => {
            let u_19_5 = u_10
                * libm::pow(
                    1.95,
                    wind.map_or(PROFILE_EXPONENT, |wind| wind.profile_exponent),
                );
            Some(fully_grown_with(0.209_2 * u_19_5 * u_19_5 / GRAVITY_M_S2))
        }
        (Some(hs_m), Some(tp_s), ..) => Some((hs_m, tp_s)),
        (_, _, Some(x_km), Some(u)) if !is_fully_grown => {
            // Carter, D. J. T. (1982). Prediction of wave height and period for a constant wind
            // velocity. The sea is fully developed, with Hs = 0.02481 U², after 2.317 U² km.
            let x_km = x_km.min(2.317 * u * u);
            Some((
                0.0163 * x_km.sqrt() * u,
                0.566 * math::exp(0.3 * libm::log(x_km) + 0.4 * libm::log(u)),
            ))
        }
        _ => {
            let expected = match is_fully_grown {
                true => "hs_m, wind_m_s or a [wind] table",
                false => "hs_m and tp_s, or fetch_km with wind_m_s or a [wind] table",
            };
            if document.is_sound("waves") {
                let message = format!("the wave height is missing, expected {expected}");
                document.note_if_intact("waves", message);
            }
            None
        }
    }
}

/// Height and period of a fully developed sea with this height.
///
/// Pierson and Moskowitz (1964): S = 8.1e-3 g² ω^-5 exp(-0.74 (g / (U ω))^4), with U 19.5 m above
/// the water. Hence Hs = 0.2092 U² / g, and the peak is at 0.8772 g / U.
fn fully_grown_with(hs_m: f64) -> (f64, f64) {
    let u_m_s = (hs_m * GRAVITY_M_S2 / 0.209_2).sqrt().max(0.1);
    (
        hs_m,
        std::f64::consts::TAU * u_m_s / (0.877_2 * GRAVITY_M_S2),
    )
}

/// The wavelength at this period, m.
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
