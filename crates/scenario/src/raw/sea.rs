//! A sea file as typed.

use crate::sea::{Eddy, PROFILE_EXPONENT, RandomEddies, Wander};
use schemars::JsonSchema;
use serde::Deserialize;

/// The water and the air above it: waves, wind and current. Any number may be drawn for every game.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("x-drawn" = true))]
pub struct Sea {
    /// Density, kg/m³; that of fresh water is 1000.
    #[schemars(range(min = 900, max = 1300), extend("default" = 1000))]
    pub(crate) water_density_kg_m3: f64,
    /// Depth, m. Default deeper than any wave feels.
    #[schemars(range(min = 0.5, max = 12000))]
    pub(crate) depth_m: Option<f64>,
    /// Waves. Default none.
    pub(crate) waves: Option<Waves>,
    /// Wind. Default none.
    pub(crate) wind: Option<Wind>,
    /// Current.
    pub(crate) current: Current,
}

/// Waves: a spectrum by height and period, or by the wind that raises them.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Waves {
    /// The spectrum's shape.
    #[schemars(extend("default" = "jonswap"))]
    pub(crate) spectrum: Spectrum,
    /// Significant wave height, m.
    #[schemars(range(min = 0, max = 20))]
    pub(crate) hs_m: Option<f64>,
    /// Peak period, s.
    #[schemars(range(min = 0.5, max = 30))]
    pub(crate) tp_s: Option<f64>,
    /// Peak enhancement of "jonswap".
    #[schemars(range(min = 1, max = 7), extend("default" = 3.3))]
    pub(crate) gamma: f64,
    /// Instead of height and period: over how much water the wind has raised the waves, km. Carter (1982).
    #[schemars(range(min = 0.05, max = 1000))]
    pub(crate) fetch_km: Option<f64>,
    /// The wind that has raised them, m/s. Default the sea's own wind.
    #[schemars(range(min = 0.5, max = 50))]
    pub(crate) wind_m_s: Option<f64>,
    /// The compass bearing they come from, degrees. Default where the wind comes from.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) from_deg: Option<f64>,
    /// How they spread around it.
    #[schemars(extend("default" = "cosine_squared"))]
    pub(crate) spreading: Spreading,
    /// The exponent s of "cosine_2s".
    #[schemars(range(min = 1, max = 200), extend("default" = 10))]
    pub(crate) spread_s: f64,
    /// How many components stand for the spectrum.
    #[schemars(range(min = 1, max = 1024), extend("default" = 64))]
    pub(crate) components: u32,
    /// Factor on the second-order drift force.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub(crate) drift_factor: f64,
}

/// The shape of a wave spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Spectrum {
    /// A growing sea, with a sharp peak: hs_m and tp_s, or fetch_km.
    Jonswap,
    /// Any sea: hs_m and tp_s, or fetch_km.
    Bretschneider,
    /// A fully grown sea: hs_m alone, or wind_m_s.
    PiersonMoskowitz,
}

/// How waves spread around their mean direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Spreading {
    /// Not at all: long crests.
    None,
    /// By the square of the cosine, up to a right angle.
    CosineSquared,
    /// By cos^(2s) of half the angle.
    #[serde(rename = "cosine_2s")]
    Cosine2s,
}

/// Wind: a mean, and gusts that travel with it.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Wind {
    /// Mean speed 10 m above the water, m/s.
    #[schemars(range(min = 0, max = 50))]
    pub(crate) speed_m_s: f64,
    /// The compass bearing it comes from, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) from_deg: f64,
    /// Exponent of the mean profile, U(z) = U10 (z / 10 m)^a; the default is that of open water.
    #[schemars(range(min = 0, max = 0.5), extend("default" = PROFILE_EXPONENT))]
    pub(crate) profile_exponent: f64,
    /// How it gusts.
    #[schemars(extend("default" = "ornstein_uhlenbeck"))]
    pub(crate) gusts: Gusts,
    /// Standard deviation along the wind over the mean speed.
    #[schemars(range(min = 0, max = 0.5), extend("default" = 0.14))]
    pub(crate) intensity: f64,
    /// Standard deviation across the wind over that along it.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.75))]
    pub(crate) across_ratio: f64,
    /// Length scale of "ornstein_uhlenbeck", m.
    #[schemars(range(min = 1, max = 1000), extend("default" = 45))]
    pub(crate) length_m: f64,
}

/// How the wind gusts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Gusts {
    /// Not at all.
    None,
    /// As an Ornstein-Uhlenbeck process.
    OrnsteinUhlenbeck,
}

/// The water's own motion: the sum of all that is stated.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Current {
    /// Speed of the mean current, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub(crate) speed_m_s: f64,
    /// The compass bearing it goes to, degrees.
    #[schemars(range(min = -360, max = 360), extend("default" = 0))]
    pub(crate) toward_deg: f64,
    /// A speed that wanders about the mean, in its direction.
    pub(crate) wander: Option<Wander>,
    /// A tidal stream.
    pub(crate) tide: Option<Tide>,
    /// A stream that grows across.
    pub(crate) shear: Option<Shear>,
    /// Eddies at stated places.
    pub(crate) eddy: Vec<Eddy>,
    /// Eddies whose places are drawn over the field for every game.
    pub(crate) eddies: Option<RandomEddies>,
}

/// A tidal stream.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Tide {
    /// The strongest flood, m/s.
    #[schemars(range(min = 0, max = 10))]
    pub(crate) speed_m_s: f64,
    /// The compass bearing the flood goes to, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) toward_deg: f64,
    /// Period, h; the moon's is 12.42.
    #[schemars(range(min = 0.01, max = 1000), extend("default" = 12.42))]
    pub(crate) period_h: f64,
    /// Where in the period a game begins: 0 is slack water before the flood, 0.25 is the strongest flood.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub(crate) phase: f64,
}

/// A stream that grows across: that of a river from its bank.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Shear {
    /// The compass bearing the stream goes to, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) toward_deg: f64,
    /// By how much it grows a metre to starboard of itself, m/s.
    #[schemars(range(min = -1, max = 1))]
    pub(crate) per_s: f64,
    /// Where it is nothing, [x, y] in m from the datum.
    #[schemars(inner(range(min = -1000000, max = 1000000)), extend("default" = [0, 0]))]
    pub(crate) origin: [f64; 2],
}
