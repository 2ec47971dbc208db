//! A sea file as written.

use crate::sea::{Eddy, PROFILE_EXPONENT, RandomEddies, Wander};
use crate::size::COMPONENTS_MAX;
use schemars::JsonSchema;
use serde::Deserialize;

/// Water and wind.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("x-drawn" = true))]
pub struct Sea {
    /// Density, kg/m³. Fresh water has 1000.
    #[schemars(range(min = 900, max = 1300), extend("default" = 1000))]
    pub(crate) water_density_kg_m3: f64,
    /// Depth, m. Default: too deep to affect waves.
    #[schemars(range(min = 0.5, max = 12000))]
    pub(crate) depth_m: Option<f64>,
    /// Waves. Default: none.
    pub(crate) waves: Option<Waves>,
    /// Wind. Default: none.
    pub(crate) wind: Option<Wind>,
    /// Current.
    pub(crate) current: Current,
}

/// Waves given by height and period, or by the wind that raised them.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Waves {
    /// Shape of the spectrum.
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
    /// Instead of height and period: fetch of the wind, km (Carter 1982).
    #[schemars(range(min = 0.05, max = 1000))]
    pub(crate) fetch_km: Option<f64>,
    /// Wind that raised the waves, m/s. Default: the sea's wind.
    #[schemars(range(min = 0.5, max = 50))]
    pub(crate) wind_m_s: Option<f64>,
    /// Compass bearing they come from, degrees. Default: that of the wind.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) from_deg: Option<f64>,
    /// Spread of directions around `from_deg`.
    #[schemars(extend("default" = "cosine_squared"))]
    pub(crate) spreading: Spreading,
    /// Exponent s of "cosine_2s".
    #[schemars(range(min = 1, max = 200), extend("default" = 10))]
    pub(crate) spread_s: f64,
    /// Number of components of the spectrum.
    #[schemars(range(min = 1, max = COMPONENTS_MAX), extend("default" = 64))]
    pub(crate) components: u32,
    /// Factor on the second-order (drift) force.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub(crate) drift_factor: f64,
}

/// The shape of a wave spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Spectrum {
    /// A growing sea with a sharp peak; requires `hs_m` and `tp_s`, or `fetch_km`.
    Jonswap,
    /// Any sea; requires `hs_m` and `tp_s`, or `fetch_km`.
    Bretschneider,
    /// A fully developed sea; requires `hs_m` or `wind_m_s`.
    PiersonMoskowitz,
}

/// The spread of waves around their mean direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Spreading {
    /// None: long crests.
    None,
    /// Square of the cosine, up to 90° on each side.
    CosineSquared,
    /// cos^(2s) of half the angle.
    #[serde(rename = "cosine_2s")]
    Cosine2s,
}

/// A mean wind with gusts that travel with it.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Wind {
    /// Mean speed at 10 m height, m/s.
    #[schemars(range(min = 0, max = 50))]
    pub(crate) speed_m_s: f64,
    /// Compass bearing it comes from, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) from_deg: f64,
    /// Exponent a of the mean profile U(z) = U10 (z / 10 m)^a; the default is for open water.
    #[schemars(range(min = 0, max = 0.5), extend("default" = PROFILE_EXPONENT))]
    pub(crate) profile_exponent: f64,
    /// Gust model.
    #[schemars(extend("default" = "ornstein_uhlenbeck"))]
    pub(crate) gusts: Gusts,
    /// Standard deviation along the wind, divided by the mean speed.
    #[schemars(range(min = 0, max = 0.5), extend("default" = 0.14))]
    pub(crate) intensity: f64,
    /// Standard deviation across the wind, divided by that along it.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.75))]
    pub(crate) across_ratio: f64,
    /// Length scale of "ornstein_uhlenbeck", m.
    #[schemars(range(min = 1, max = 1000), extend("default" = 45))]
    pub(crate) length_m: f64,
}

/// The gust model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Gusts {
    /// None.
    None,
    /// An Ornstein-Uhlenbeck process.
    OrnsteinUhlenbeck,
}

/// Current: the sum of all given components.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Current {
    /// Mean speed, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub(crate) speed_m_s: f64,
    /// Compass bearing it flows towards, degrees.
    #[schemars(range(min = -360, max = 360), extend("default" = 0))]
    pub(crate) toward_deg: f64,
    /// A random variation of the mean speed.
    pub(crate) wander: Option<Wander>,
    /// A tidal stream.
    pub(crate) tide: Option<Tide>,
    /// A flow that grows linearly to one side.
    pub(crate) shear: Option<Shear>,
    /// Eddies at given positions.
    pub(crate) eddy: Vec<Eddy>,
    /// Eddies at random positions on the field, drawn for every game.
    pub(crate) eddies: Option<RandomEddies>,
}

/// A tidal stream.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Tide {
    /// Maximum flood speed, m/s.
    #[schemars(range(min = 0, max = 10))]
    pub(crate) speed_m_s: f64,
    /// Compass bearing of the flood, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) toward_deg: f64,
    /// Period, h; 12.42 for the principal lunar tide.
    #[schemars(range(min = 0.01, max = 1000), extend("default" = 12.42))]
    pub(crate) period_h: f64,
    /// Phase at the start: 0 is slack water before the flood, 0.25 maximum flood.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub(crate) phase: f64,
}

/// A flow that grows linearly to one side, like a river away from its bank.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Shear {
    /// Compass bearing of the flow, degrees.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) toward_deg: f64,
    /// Increase per metre to starboard of the flow, m/s.
    #[schemars(range(min = -1, max = 1))]
    pub(crate) per_s: f64,
    /// Where the flow is 0, [x, y] in m from the datum.
    #[schemars(inner(range(min = -1000000, max = 1000000)), extend("default" = [0, 0]))]
    pub(crate) origin: [f64; 2],
}
