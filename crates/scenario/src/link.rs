//! Radio links between minds and boats, with their delays and losses.
//!
//! Like everything in a game, they depend on its seed. Faults of the real network are separate.

use primitives::frame::Ned;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The radio link between each boat and its mind on shore.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Link {
    /// Minimum delay of a message, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.02))]
    pub delay_s: f64,
    /// Mean additional delay, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0))]
    pub jitter_s: f64,
    /// Message loss. Default: none.
    #[serde(default)]
    #[schemars(with = "Option<Loss>", !default)]
    pub loss: Loss,
    /// Range, m. Default: unlimited.
    #[schemars(range(min = 1, max = 1000000))]
    pub range_m: Option<f64>,
    /// Position of the shore station, [x, y] in m from the datum. Default: the centre of the field.
    #[serde(default)]
    #[schemars(with = "Option<[f64; 2]>", !default, inner(range(min = -1000000, max = 1000000)))]
    #[schemars(extend("x-field" = "station"))]
    pub station: Ned,
}

/// Burst losses (Gilbert-Elliott): the link alternates between a good and a bad state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loss {
    /// Fraction lost in the good state.
    #[schemars(range(min = 0, max = 1), extend("default" = 0))]
    pub good: f64,
    /// Fraction lost in the bad state.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub bad: f64,
    /// Mean duration of the good state, s; 0: always good.
    #[schemars(range(min = 0, max = 86400), extend("default" = 0))]
    pub good_time_s: f64,
    /// Mean duration of the bad state, s.
    #[schemars(range(min = 0.01, max = 86400), extend("default" = 2))]
    pub bad_time_s: f64,
}
