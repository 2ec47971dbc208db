//! Waves, wind and current, checked and in SI.
//!
//! `sim::sea` defines their effect on boats. Waves and wind are given by the direction they come
//! from, the current by the direction it flows towards.

use primitives::frame::Ned;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Exponent of the mean wind profile over open water.
pub const PROFILE_EXPONENT: f64 = 0.12;

/// Standard gravity, m/s².
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// A sea.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sea {
    /// The sea file's stem.
    pub name: String,
    /// Density of the water, kg/m³.
    pub water_density_kg_m3: f64,
    /// Depth of the water, m; `None`: too deep to affect waves.
    pub depth_m: Option<f64>,
    /// The waves.
    pub waves: Option<Waves>,
    /// The wind.
    pub wind: Option<Wind>,
    /// The current.
    pub current: Current,
}

impl Sea {
    /// Whether the sea has no waves, wind or current. Otherwise, one end of the field may have an
    /// advantage.
    pub fn is_at_rest(&self) -> bool {
        let Current {
            mean_m_s,
            wander,
            tide,
            shear,
            eddies,
            random_eddies,
        } = &self.current;
        let stream =
            *mean_m_s != Ned::default() || wander.is_some() || tide.is_some() || shear.is_some();
        let calm = self.waves.as_ref().is_none_or(|waves| waves.hs_m <= 0.0);
        let wind = self.wind.as_ref();
        let windless = wind.is_none_or(|wind| wind.speed_10m_m_s <= 0.0);
        calm && windless && !stream && eddies.is_empty() && random_eddies.is_none()
    }

    /// Fresh water at rest, without wind.
    pub fn at_rest() -> Sea {
        Sea {
            name: "at_rest".into(),
            water_density_kg_m3: 1000.0,
            depth_m: None,
            waves: None,
            wind: None,
            current: Current::default(),
        }
    }
}

/// A spectrum with its directional spreading.
///
/// The spectrum is JONSWAP with peak enhancement γ; γ = 1 gives the Pierson-Moskowitz spectrum in
/// Bretschneider's two-parameter form.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Waves {
    /// Significant wave height, m.
    pub hs_m: f64,
    /// Peak period, s.
    pub tp_s: f64,
    /// Peak enhancement, 1 to 7.
    pub gamma: f64,
    /// Compass bearing they come from, rad.
    pub from_rad: f64,
    /// The directional spreading.
    pub spreading: Spreading,
    /// The number of components that represent the spectrum.
    pub components: u32,
    /// Factor on the second-order (drift) force.
    pub drift_factor: f64,
}

/// The spreading of wave energy around the mean direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Spreading {
    /// None: long-crested waves.
    None,
    /// (2/π) cos² μ within 90° of the mean direction.
    CosineSquared,
    /// Proportional to cos^(2s) (μ/2), in all directions (Longuet-Higgins).
    Cosine2s {
        /// s: the larger it is, the narrower the spread.
        s: f64,
    },
}

/// A wind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wind {
    /// Mean speed 10 m above the water, m/s.
    pub speed_10m_m_s: f64,
    /// Compass bearing it comes from, rad.
    pub from_rad: f64,
    /// Exponent of the mean profile: U(z) = U10 (z / 10 m)^α.
    pub profile_exponent: f64,
    /// The variation about the mean.
    pub gusts: Gusts,
}

/// The variation of the wind about its mean. Gusts travel with the mean wind, unchanged (Taylor's
/// hypothesis), so boats feel the same gust one after the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Gusts {
    /// None.
    None,
    /// One Ornstein-Uhlenbeck process along the wind, another across it.
    OrnsteinUhlenbeck {
        /// Standard deviation along the wind divided by the mean speed.
        intensity: f64,
        /// Standard deviation across the wind divided by that along it.
        across_ratio: f64,
        /// Length scale, m; the time constant is this divided by the mean speed at the boat.
        length_m: f64,
    },
}

/// The current: the sum of all given components.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Current {
    /// Uniform and constant, m/s.
    pub mean_m_s: Ned,
    /// A random variation of the speed in the mean direction, uniform over the field.
    pub wander: Option<Wander>,
    /// A tide.
    pub tide: Option<Tide>,
    /// A linear change across the flow.
    pub shear: Option<Shear>,
    /// Eddies at given positions.
    pub eddies: Vec<Eddy>,
    /// Eddies at random positions on the field.
    #[serde(alias = "eddies_by_lot")]
    pub random_eddies: Option<RandomEddies>,
}

/// A first-order Gauss-Markov process.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Wander {
    /// The unit vector along which the speed varies: that of the mean current.
    #[serde(default)]
    #[schemars(skip)]
    pub toward: Ned,
    /// Standard deviation, m/s.
    #[schemars(range(min = 0, max = 5))]
    pub sigma_m_s: f64,
    /// Correlation time, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 300))]
    pub time_s: f64,
    /// Range to which the sum of mean and process is clipped, m/s.
    #[schemars(with = "[f64; 2]", inner(range(min = -10, max = 10)), extend("default" = [-10, 10]))]
    pub speed_m_s: (f64, f64),
}

/// A tidal stream, sinusoidal in time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tide {
    /// The maximum flood stream, m/s.
    pub flood_m_s: Ned,
    /// Period, s; that of the moon's principal tide is 12.42 h.
    pub period_s: f64,
    /// Phase at the start of the game, as a fraction of the period: 0 and 1 are slack water before
    /// the flood.
    pub phase: f64,
}

/// A current that grows linearly across its direction: V(p) = `per_s` (p − origin) · `across`,
/// along `toward`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shear {
    /// The unit vector of the flow.
    pub toward: Ned,
    /// The unit vector along which it grows, a quarter turn to starboard of the flow.
    pub across: Ned,
    /// Increase of the flow per metre across it, 1/s.
    pub per_s: f64,
    /// The point with zero current, m from the datum.
    pub origin: Ned,
}

/// A Lamb-Oseen vortex: v(r) = Γ / (2 π r) (1 − exp(−r² / a²)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Eddy {
    /// Centre, [x, y] in m from the datum.
    #[schemars(with = "[f64; 2]", inner(range(min = -1000000, max = 1000000)), extend("x-field" = "centre"))]
    pub centre: Ned,
    /// Core radius, m; the flow is fastest at 1.121 times this radius.
    #[schemars(range(min = 1, max = 1000))]
    pub radius_m: f64,
    /// Maximum flow, m/s; positive is clockwise.
    #[schemars(range(min = -5, max = 5))]
    pub peak_m_s: f64,
}

/// Vortices at random positions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RandomEddies {
    /// Number of eddies.
    #[schemars(range(min = 0, max = 100))]
    pub count: u32,
    /// Minimum and maximum core radius, m.
    #[schemars(with = "[f64; 2]", inner(range(min = 1, max = 1000)), extend("default" = [10, 40]))]
    pub radius_m: (f64, f64),
    /// Minimum and maximum peak flow, m/s; in either direction.
    #[schemars(with = "[f64; 2]", inner(range(min = 0, max = 5)), extend("default" = [0.1, 0.3]))]
    pub peak_m_s: (f64, f64),
}
