//! How a team learns about other boats.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a team is shown of other boats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sharing {
    /// A boat is seen by whoever is nearer than this, m. Default from everywhere.
    #[schemars(range(min = 1, max = 1000000))]
    pub range_m: Option<f64>,
    /// Full angle of view about the bow, rad.
    #[schemars(description = "Full angle of view about the bow, degrees.")]
    #[schemars(rename = "view_deg", with = "f64", range(min = 1, max = 360))]
    #[schemars(extend("x-field" = "view_rad", "default" = 360))]
    pub view_rad: Option<f64>,
    /// How old a report is when it comes, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub delay_s: f64,
    /// Standard deviation of its position, each axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0))]
    pub noise_m: f64,
    /// Standard deviation of its velocity, each axis, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub velocity_noise_m_s: f64,
    /// Share of reports that is lost.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub loss: f64,
    /// A contact is forgotten when its last report is older than this, s.
    #[schemars(range(min = 0, max = 86400), extend("default" = 10))]
    pub memory_s: f64,
}
