//! A sea file as typed.

use super::{At, Pair};
use crate::sea::GustSpectrum;
use schemars::JsonSchema;
use serde::Deserialize;

/// The water and the air above it: waves, wind and current. Any number may be drawn by lot for every game.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall sea")]
pub(in crate::scenario) struct RawSea {
    /// Another sea file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Density, kg/m³: 900 to 1300. Default 1000, fresh water.
    pub(in crate::scenario) water_density_kg_m3: Option<At<f64>>,
    /// Depth, m: 0.5 to 12000. Default deeper than any wave feels.
    pub(in crate::scenario) depth_m: Option<At<f64>>,
    /// Waves. Default none.
    pub(in crate::scenario) waves: Option<At<RawWaves>>,
    /// Wind. Default none.
    pub(in crate::scenario) wind: Option<At<RawWind>>,
    /// Current. Default none.
    pub(in crate::scenario) current: Option<At<RawCurrent>>,
}

/// Waves: a spectrum by height and period, or by the wind that raises them.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Waves")]
pub(in crate::scenario) struct RawWaves {
    /// The spectrum's shape. Default "jonswap".
    pub(in crate::scenario) spectrum: Option<RawSpectrum>,
    /// Significant wave height, m: 0 to 20.
    pub(in crate::scenario) hs_m: Option<At<f64>>,
    /// Peak period, s: 0.5 to 30.
    pub(in crate::scenario) tp_s: Option<At<f64>>,
    /// Peak enhancement of "jonswap": 1 to 7. Default 3.3.
    pub(in crate::scenario) gamma: Option<At<f64>>,
    /// Instead of height and period: over how much water the wind has raised the waves, km: 0.05 to 1000. Carter (1982).
    pub(in crate::scenario) fetch_km: Option<At<f64>>,
    /// The wind that has raised them, m/s: 0.5 to 50. Default the sea's own wind.
    pub(in crate::scenario) wind_m_s: Option<At<f64>>,
    /// The compass bearing they come from, degrees: -360 to 360. Default where the wind comes from.
    pub(in crate::scenario) from_deg: Option<At<f64>>,
    /// How they spread around it. Default "cosine_squared".
    pub(in crate::scenario) spreading: Option<RawSpreading>,
    /// The exponent s of "cosine_2s": 1 to 200. Default 10.
    pub(in crate::scenario) spread_s: Option<At<f64>>,
    /// How many components stand for the spectrum: 1 to 1024. Default 64.
    pub(in crate::scenario) components: Option<At<i64>>,
    /// Factor on the second-order drift force: 0 to 10. Default 1.
    pub(in crate::scenario) drift_factor: Option<At<f64>>,
}

/// The shape of a wave spectrum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Spectrum")]
pub(in crate::scenario) enum RawSpectrum {
    /// A growing sea, with a sharp peak: hs_m and tp_s, or fetch_km.
    #[default]
    Jonswap,
    /// Any sea: hs_m and tp_s, or fetch_km.
    Bretschneider,
    /// A fully grown sea: hs_m alone, or wind_m_s.
    PiersonMoskowitz,
}

/// How waves spread around their mean direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Spreading")]
pub(in crate::scenario) enum RawSpreading {
    /// Not at all: long crests.
    None,
    /// By the square of the cosine, up to a right angle.
    #[default]
    CosineSquared,
    /// By cos^(2s) of half the angle.
    #[serde(rename = "cosine_2s")]
    Cosine2s,
}

/// Wind: a mean, and gusts that travel with it.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Wind")]
pub(in crate::scenario) struct RawWind {
    /// Mean speed 10 m above the water, m/s: 0 to 50. Required.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
    /// The compass bearing it comes from, degrees: -360 to 360. Required.
    pub(in crate::scenario) from_deg: Option<At<f64>>,
    /// Exponent of the mean profile, U(z) = U10 (z / 10 m)^a: 0 to 0.5. Default 0.12, open water.
    pub(in crate::scenario) profile_exponent: Option<At<f64>>,
    /// How it gusts. Default "ornstein_uhlenbeck".
    pub(in crate::scenario) gusts: Option<RawGusts>,
    /// Standard deviation along the wind over the mean speed: 0 to 0.5. Default 0.14.
    pub(in crate::scenario) intensity: Option<At<f64>>,
    /// Standard deviation across the wind over that along it: 0 to 1. Default 0.75.
    pub(in crate::scenario) across_ratio: Option<At<f64>>,
    /// Length scale of "ornstein_uhlenbeck", m: 1 to 1000. Default 45.
    pub(in crate::scenario) length_m: Option<At<f64>>,
    /// How many components the spectral kinds have: 1 to 1024. Default 64.
    pub(in crate::scenario) components: Option<At<i64>>,
}

/// How the wind gusts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Gusts")]
pub(in crate::scenario) enum RawGusts {
    /// Not at all.
    None,
    /// As an Ornstein-Uhlenbeck process.
    #[default]
    OrnsteinUhlenbeck,
    /// By Davenport's spectrum (1961).
    Davenport,
    /// By Harris' spectrum (1971).
    Harris,
    /// By the Frøya spectrum, for wind over the sea.
    Froya,
}

impl RawGusts {
    /// The spectrum it means, if it means one.
    pub(in crate::scenario) fn spectrum(self) -> Option<GustSpectrum> {
        match self {
            RawGusts::None | RawGusts::OrnsteinUhlenbeck => None,
            RawGusts::Davenport => Some(GustSpectrum::Davenport),
            RawGusts::Harris => Some(GustSpectrum::Harris),
            RawGusts::Froya => Some(GustSpectrum::Froya),
        }
    }
}

/// The water's own motion: the sum of all that is stated.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Current")]
pub(in crate::scenario) struct RawCurrent {
    /// Speed of the mean current, m/s: 0 to 10. Default 0.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
    /// The compass bearing it goes to, degrees: -360 to 360. Default 0.
    pub(in crate::scenario) toward_deg: Option<At<f64>>,
    /// A speed that wanders about the mean, in its direction.
    pub(in crate::scenario) wander: Option<At<RawWander>>,
    /// A tidal stream.
    pub(in crate::scenario) tide: Option<At<RawTide>>,
    /// A stream that grows across.
    pub(in crate::scenario) shear: Option<At<RawShear>>,
    /// Eddies at stated places.
    pub(in crate::scenario) eddy: Option<Vec<At<RawEddy>>>,
    /// Eddies whose places are drawn over the field for every game.
    pub(in crate::scenario) eddies: Option<At<RawEddies>>,
}

/// A first-order Gauss-Markov process.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Wander")]
pub(in crate::scenario) struct RawWander {
    /// Standard deviation, m/s: 0 to 5. Required.
    pub(in crate::scenario) sigma_m_s: Option<At<f64>>,
    /// Correlation time, s: 1 to 86400. Default 300.
    pub(in crate::scenario) time_s: Option<At<f64>>,
    /// What mean and process together are clipped to, m/s: -10 to 10. Default [-10, 10].
    pub(in crate::scenario) speed_m_s: Option<At<Pair>>,
}

/// A tidal stream.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Tide")]
pub(in crate::scenario) struct RawTide {
    /// The strongest flood, m/s: 0 to 10. Required.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
    /// The compass bearing the flood goes to, degrees: -360 to 360. Required.
    pub(in crate::scenario) toward_deg: Option<At<f64>>,
    /// Period, h: 0.01 to 1000. Default 12.42, the moon's.
    pub(in crate::scenario) period_h: Option<At<f64>>,
    /// Where in the period a game begins: 0 to 1. Default 0, slack water before the flood; 0.25 is the strongest flood.
    pub(in crate::scenario) phase: Option<At<f64>>,
}

/// A stream that grows across: that of a river from its bank.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Shear")]
pub(in crate::scenario) struct RawShear {
    /// The compass bearing the stream goes to, degrees: -360 to 360. Required.
    pub(in crate::scenario) toward_deg: Option<At<f64>>,
    /// By how much it grows a metre to starboard of itself, m/s: -1 to 1. Required.
    pub(in crate::scenario) per_s: Option<At<f64>>,
    /// Where it is nothing, [x, y] in m from the datum. Default [0, 0].
    pub(in crate::scenario) origin: Option<At<Pair>>,
}

/// A vortex (Lamb-Oseen).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Eddy")]
pub(in crate::scenario) struct RawEddy {
    /// Its middle, [x, y] in m from the datum. Required.
    pub(in crate::scenario) centre: Option<At<Pair>>,
    /// Radius of its core, m: 1 to 1000. Required.
    pub(in crate::scenario) radius_m: Option<At<f64>>,
    /// Its fastest flow, m/s: -5 to 5; positive turns clockwise. Required.
    pub(in crate::scenario) peak_m_s: Option<At<f64>>,
}

/// Vortices by lot.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Eddies")]
pub(in crate::scenario) struct RawEddies {
    /// How many: 0 to 100. Required.
    pub(in crate::scenario) count: Option<At<i64>>,
    /// Radius of a core, from and to, m: 1 to 1000. Default [10, 40].
    pub(in crate::scenario) radius_m: Option<At<Pair>>,
    /// Fastest flow, from and to, m/s: 0 to 5; either way round. Default [0.1, 0.3].
    pub(in crate::scenario) peak_m_s: Option<At<Pair>>,
}
