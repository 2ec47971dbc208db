//! Radio links and contact reports as typed.

use super::{At, Pair};
use schemars::JsonSchema;
use serde::Deserialize;

/// The radio link between the minds ashore and each boat. Any number may be drawn by lot for every game.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Link")]
pub(in crate::scenario) struct RawLink {
    /// Shortest time a message takes, s: 0 to 10. Default 0.02.
    pub(in crate::scenario) delay_s: Option<At<f64>>,
    /// Mean of what it takes longer, s: 0 to 10. Default 0.
    pub(in crate::scenario) jitter_s: Option<At<f64>>,
    /// Losses. Default none.
    pub(in crate::scenario) loss: Option<At<RawLoss>>,
    /// How far it reaches, m: 1 to 1000000. Default everywhere.
    pub(in crate::scenario) range_m: Option<At<f64>>,
    /// Where the station ashore stands, [x, y] in m from the datum. Default the middle of the field.
    pub(in crate::scenario) station: Option<At<Pair>>,
}

/// Losses in bursts (Gilbert and Elliott).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Loss")]
pub(in crate::scenario) struct RawLoss {
    /// Share lost while the link is good: 0 to 1. Default 0.
    pub(in crate::scenario) good: Option<At<f64>>,
    /// Share lost while it is bad: 0 to 1. Default 0.5.
    pub(in crate::scenario) bad: Option<At<f64>>,
    /// How long it stays good on average, s: 0 (always) to 86400. Default 0.
    pub(in crate::scenario) good_time_s: Option<At<f64>>,
    /// How long it stays bad on average, s: 0.01 to 86400. Default 2.
    pub(in crate::scenario) bad_time_s: Option<At<f64>>,
}

/// What a team is shown of other boats.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Sharing")]
pub(in crate::scenario) struct RawSharing {
    /// A boat is seen by whoever is nearer than this, m: 1 to 1000000. Default from everywhere.
    pub(in crate::scenario) range_m: Option<At<f64>>,
    /// Full angle of view about the bow, degrees: 1 to 360. Default 360.
    pub(in crate::scenario) view_deg: Option<At<f64>>,
    /// How old a report is when it comes, s: 0 to 10. Default 0.
    pub(in crate::scenario) delay_s: Option<At<f64>>,
    /// Standard deviation of its position, each axis, m: 0 to 100. Default 0.
    pub(in crate::scenario) noise_m: Option<At<f64>>,
    /// Standard deviation of its velocity, each axis, m/s: 0 to 10. Default 0.
    pub(in crate::scenario) velocity_noise_m_s: Option<At<f64>>,
    /// Share of reports that is lost: 0 to 1. Default 0.
    pub(in crate::scenario) loss: Option<At<f64>>,
    /// A contact is forgotten when its last report is older than this, s: 0 to 86400. Default 10.
    pub(in crate::scenario) memory_s: Option<At<f64>>,
}
