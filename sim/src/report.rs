//! The report of a game: its outcome and how it was run.

use messages::refusal::Refusals;
use scenario::Outcome;
use serde::{Deserialize, Serialize};

/// The report of a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The result of the game.
    pub outcome: Outcome,
    /// How the game was run.
    pub run: Run,
}

/// Results that depend on the machines and the network rather than on the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// The pace of the game.
    pub pace: String,
    /// Wall-clock duration, s.
    pub wall_s: f64,
    /// Refused messages from agents and gateways.
    pub refused: Refusals,
    /// Decisions that began late (real time only).
    pub overruns: u64,
    /// Whether it was stopped early.
    pub cut_short: bool,
    /// The fault in the recording, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording_problem: Option<String>,
}
