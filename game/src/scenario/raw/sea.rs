//! A sea file as typed.

use super::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// The water.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall sea")]
pub(in crate::scenario) struct RawSea {
    /// Another sea file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Density, kg/m³: 900 to 1300. Default 1000, fresh water.
    pub(in crate::scenario) water_density_kg_m3: Option<At<f64>>,
    /// A current, the same everywhere and always. Default none.
    pub(in crate::scenario) current: Option<RawCurrent>,
}

/// A steady current.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Current")]
pub(in crate::scenario) struct RawCurrent {
    /// Its speed, m/s: 0 to 10. Default 0.
    pub(in crate::scenario) speed_m_s: Option<At<f64>>,
    /// The compass bearing it goes to, degrees: -360 to 360. Default 0.
    pub(in crate::scenario) toward_deg: Option<At<f64>>,
}
