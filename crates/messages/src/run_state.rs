//! The state of a game's run: everything that depends on the machine and its operators, not on the
//! game.

use serde::{Deserialize, Serialize};

/// The state of a game's run, from its sim to observers. JSON.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunState {
    /// The current phase.
    pub phase: Phase,
    /// Simulated time, s.
    pub now_s: f64,
    /// The pace at the start: `lockstep`, `realtime` or a factor such as `4x`.
    pub pace: String,
    /// Target speed, or upper limit in lockstep, in simulated seconds per second; `None` is
    /// unlimited.
    pub speed: Option<f64>,
    /// Recent speed, simulated seconds per second.
    pub rate: f64,
    /// Vehicles whose agents the game is waiting for.
    pub minds: Vec<String>,
    /// Real boats whose first report the game is waiting for.
    pub gateways: Vec<String>,
    /// Messages refused so far.
    pub refused: u64,
    /// Decisions that began late so far.
    pub overruns: u64,
    /// The recording, if there is one.
    pub recording: Option<RecordingState>,
}

/// The phase of a run.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, strum::IntoStaticStr,
)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum Phase {
    /// The game waits for agents or real boats.
    #[default]
    Waiting,
    /// The game is running.
    Playing,
    /// The game is paused.
    Paused,
    /// The game has ended.
    Over,
}

/// The state of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RecordingState {
    /// The file's path on the sim's machine.
    pub file: String,
    /// Bytes written so far.
    pub bytes: u64,
    /// Messages dropped because the disk was too slow.
    pub dropped: u64,
    /// Why writing stopped, if it did.
    pub failed: Option<String>,
}

impl RecordingState {
    /// The recording's problem in plain words, if any.
    pub fn problem(&self) -> Option<String> {
        let file = &self.file;
        match &self.failed {
            Some(reason) if self.bytes == 0 => {
                Some(format!("nothing is recorded in {file}: {reason}"))
            }
            Some(reason) => Some(format!("the recording {file} is incomplete: {reason}")),
            None if self.dropped > 0 => Some(format!(
                "the recording {file} lacks {} messages: the disk was too slow",
                self.dropped
            )),
            None => None,
        }
    }
}
