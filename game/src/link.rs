//! What stands between a mind and its boat, and between a boat and what it sees of others: radio links and
//! contact reports with their delays and losses.
//!
//! These belong to the game and are seeded like everything in it. Faults of the real network are another matter.

use crate::frame::Ned;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The radio link between the minds ashore and each boat: reports come in over it, orders go out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Link {
    /// Shortest time a message takes, s.
    pub delay_s: f64,
    /// Mean of what it takes longer, s; exponentially distributed.
    pub jitter_s: f64,
    /// Losses.
    pub loss: Loss,
    /// How far it reaches, m; `None` is everywhere.
    pub range_m: Option<f64>,
    /// Where the station ashore stands.
    pub station: Ned,
}

/// Losses in bursts, after Gilbert and Elliott: the link is good or bad, and loses messages in either state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loss {
    /// Share lost while the link is good.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub good: f64,
    /// Share lost while it is bad.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub bad: f64,
    /// How long it stays good on average, s (always at 0).
    #[schemars(range(min = 0, max = 86400), extend("default" = 0))]
    pub good_time_s: f64,
    /// How long it stays bad on average, s.
    #[schemars(range(min = 0.01, max = 86400), extend("default" = 2))]
    pub bad_time_s: f64,
}

/// What a team is shown of other boats. The default is all of it at once, as Aquaticus shares it ashore.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sharing {
    /// A boat is seen by whoever is nearer than this, m; `None` is from everywhere.
    pub range_m: Option<f64>,
    /// Full angle of view about the bow, rad; `None` is all round.
    pub view_rad: Option<f64>,
    /// How old a report is when it comes, s.
    pub delay_s: f64,
    /// Standard deviation of its position, each axis, m.
    pub noise_m: f64,
    /// Standard deviation of its velocity, each axis, m/s.
    pub velocity_noise_m_s: f64,
    /// Share of reports that is lost.
    pub loss: f64,
    /// A contact is forgotten when its last report is older than this, s.
    pub memory_s: f64,
}
