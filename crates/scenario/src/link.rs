//! The links between a mind and its boat, and between a boat and its observations of others: radio
//! links and contact reports with their delays and losses.
//!
//! These belong to the game and are seeded like everything in it. Faults of the real network are
//! separate.

use primitives::frame::Ned;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The radio link between the minds ashore and each boat. Any number may be drawn for every game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Link {
    /// Shortest time a message takes, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.02))]
    pub delay_s: f64,
    /// Mean of what it takes longer, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub jitter_s: f64,
    /// Losses. Default none.
    #[serde(default)]
    #[schemars(with = "Option<Loss>", !default)]
    pub loss: Loss,
    /// How far it reaches, m. Default everywhere.
    #[schemars(range(min = 1, max = 1000000))]
    pub range_m: Option<f64>,
    /// Where the station ashore stands, [x, y] in m from the datum. Default the middle of the field.
    #[serde(default)]
    #[schemars(with = "Option<[f64; 2]>", !default, inner(range(min = -1000000, max = 1000000)))]
    #[schemars(extend("x-field" = "station"))]
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
