//! How a team gets information about other boats.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Limits on a team's information about other boats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sharing {
    /// Maximum range at which a boat is seen, m. Default: unlimited.
    #[schemars(range(min = 1, max = 1000000))]
    pub range_m: Option<f64>,
    /// Full angle of view about the bow, rad.
    #[schemars(description = "Full angle of view about the bow, degrees.")]
    #[schemars(rename = "view_deg", with = "f64", range(min = 1, max = 360))]
    #[schemars(extend("x-field" = "view_rad", "default" = 360))]
    pub view_rad: Option<f64>,
    /// Age of a report on arrival, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub delay_s: f64,
    /// Standard deviation of position, per axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0))]
    pub noise_m: f64,
    /// Standard deviation of velocity, per axis, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub velocity_noise_m_s: f64,
    /// Fraction of reports lost.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub loss: f64,
    /// Time without reports after which a contact is forgotten, s.
    #[schemars(range(min = 0, max = 86400), extend("default" = 10))]
    pub memory_s: f64,
}
