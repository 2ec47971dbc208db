//! Radio links and contact reports as typed.

use crate::link::Loss;
use schemars::JsonSchema;
use serde::Deserialize;

/// The radio link between the minds ashore and each boat. Any number may be drawn for every game.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Link {
    /// Shortest time a message takes, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.02))]
    pub(crate) delay_s: f64,
    /// Mean of what it takes longer, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub(crate) jitter_s: f64,
    /// Losses. Default none.
    pub(crate) loss: Option<Loss>,
    /// How far it reaches, m. Default everywhere.
    #[schemars(range(min = 1, max = 1000000))]
    pub(crate) range_m: Option<f64>,
    /// Where the station ashore stands, [x, y] in m from the datum. Default the middle of the field.
    #[schemars(inner(range(min = -1000000, max = 1000000)))]
    pub(crate) station: Option<[f64; 2]>,
}

/// What a team is shown of other boats.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Sharing {
    /// A boat is seen by whoever is nearer than this, m. Default from everywhere.
    #[schemars(range(min = 1, max = 1000000))]
    pub(crate) range_m: Option<f64>,
    /// Full angle of view about the bow, degrees.
    #[schemars(range(min = 1, max = 360), extend("default" = 360))]
    pub(crate) view_deg: f64,
    /// How old a report is when it comes, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub(crate) delay_s: f64,
    /// Standard deviation of its position, each axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0))]
    pub(crate) noise_m: f64,
    /// Standard deviation of its velocity, each axis, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub(crate) velocity_noise_m_s: f64,
    /// Share of reports that is lost.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub(crate) loss: f64,
    /// A contact is forgotten when its last report is older than this, s.
    #[schemars(range(min = 0, max = 86400), extend("default" = 10))]
    pub(crate) memory_s: f64,
}
