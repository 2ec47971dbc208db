//! How a game went: what came of it, and how it was run.

use messages::refusal::Refusals;
use scenario::Outcome;
use serde::{Deserialize, Serialize};

/// How a game went.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// How the game ended.
    pub outcome: Outcome,
    /// How it was run.
    pub run: Run,
}

/// What depends on the machines and the network, not on the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// How the game was paced.
    pub pace: String,
    /// Wall-clock time it took, s.
    pub wall_s: f64,
    /// What was refused from agents and gateways.
    pub refused: Refusals,
    /// Decision ticks that began late (real time only).
    pub overruns: u64,
    /// Whether it was ended before its end.
    pub cut_short: bool,
    /// What is wrong with the recording, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording_problem: Option<String>,
}
