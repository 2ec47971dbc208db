//! The state of a game's run: what depends on the machine and the people, not on the game.

use serde::{Deserialize, Serialize};

/// How the run of a game stands, from its sim to whoever looks on. JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunState {
    /// What it is about now.
    pub phase: Phase,
    /// Simulated time, s.
    pub now_s: f64,
    /// How it was started to be paced: `lockstep`, `realtime` or a factor such as `4x`.
    pub pace: String,
    /// Simulated seconds a second: what is aimed at, or in lockstep what is not exceeded. None is as fast as can be.
    pub speed: Option<f64>,
    /// Simulated seconds a second, lately.
    pub rate: f64,
    /// Vehicles without an agent, while they are waited for.
    pub minds: Vec<String>,
    /// Real boats that were not heard of, while they are waited for.
    pub gateways: Vec<String>,
    /// Messages refused so far.
    pub refused: u64,
    /// Decisions that began late so far.
    pub overruns: u64,
    /// The recording, if there is one.
    pub recording: Option<RecordingState>,
}

/// What a run is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Agents or real boats are waited for.
    #[default]
    Waiting,
    /// The game is on.
    Playing,
    /// Somebody paused it.
    Paused,
    /// It has ended.
    Over,
}

/// How a recording stands.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingState {
    /// The file, as the sim's machine names it.
    pub file: String,
    /// Bytes written so far.
    pub bytes: u64,
    /// Messages that the disk was too slow for.
    pub dropped: u64,
    /// Why nothing is written any more, if so.
    pub failed: Option<String>,
}

impl RecordingState {
    /// What is wrong with it, in words, if anything is.
    #[must_use]
    pub fn problem(&self) -> Option<String> {
        let file = &self.file;
        match &self.failed {
            Some(reason) if self.bytes == 0 => Some(format!("nothing is recorded in {file}: {reason}")),
            Some(reason) => Some(format!("the recording {file} is not complete: {reason}")),
            None if self.dropped > 0 => {
                Some(format!("the recording {file} lacks {} messages: the disk was too slow", self.dropped))
            }
            None => None,
        }
    }
}
