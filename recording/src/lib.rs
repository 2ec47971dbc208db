//! Recordings of games: MCAP files that other tools read as well.
//!
//! | topic | what | as |
//! |---|---|---|
//! | `frame` | the truth, at every decision | message |
//! | `picture/<team>` | what a team's minds were shown | message |
//! | `inputs` | before each frame, all that the game was given since the last: it can be played again from this | message |
//! | `nav/<boat>`, `external/<boat>`, `link/<boat>` | of real boats: where they are, what they are to do, every byte of the link | message |
//! | `say/<team>`, `policy/<boat>` | what minds and policies said | message |
//! | `status/<boat>` | how gateways are | JSON |
//! | `control`, `run` | what people asked for, and how the run stood | JSON |
//!
//! All of it is CDR, as the profile `ros2` demands: a message of ours, or JSON as the text of a `std_msgs/msg/String`.
//! `log_time` is simulated time, counted from the moment at which the game began; `publish_time` is UTC when it was
//! recorded. Both in ns since 1970. `sequence` counts within a topic. Schemas are ROS 2 message definitions, complete.
//! Chunks are not compressed and are written whole, so that a file that ends abruptly is good up to there.
//!
//! Metadata: `squall` (version, commit, game, pace, seed, scenario, waves), `drawn` (numbers drawn by lot for this game),
//! and, unless the file ends abruptly, `result` (digest, outcome, run, how much was dropped).

mod clock;
mod reader;
mod recorder;
mod text;
mod walk;
mod writer;

pub use reader::{Recording, RecordingError, Said};
pub use recorder::{Blank, Recorder};
pub use writer::{Note, Turn, Writer};

use game::Outcome;
use game::message::GameInfo;
use game::water::Water;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

/// The names of the metadata.
const SQUALL: &str = "squall";
const DRAWN: &str = "drawn";
const RESULT: &str = "result";

/// In the first of them, the checksum of the others.
const CHECKSUM: &str = "checksum";

/// The CRC-32 of these facts but for the checksum itself. MCAP has one for each chunk, and one of the whole at its end;
/// whether a header can be believed must be known of a file without an end, too.
fn checksum(facts: &BTreeMap<String, String>) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in facts.iter().filter(|(key, _)| *key != CHECKSUM) {
        [key, "\0", value, "\0"].iter().for_each(|text| hasher.update(text.as_bytes()));
    }
    hasher.finalize().to_string()
}

/// The topic of the truth.
pub const FRAME: &str = "frame";
/// The topic of what the game was given.
pub const INPUTS: &str = "inputs";

/// The topic of a team's pictures.
#[must_use]
pub fn picture(team: &str) -> String {
    format!("picture/{team}")
}

/// What a recording says of its game before anything happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The commit that the program was built from.
    pub commit: String,
    /// The game's name.
    pub game: String,
    /// When it began: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// Version, pace, and the scenario with the seed and all numbers drawn.
    pub notice: GameInfo,
    /// The waves.
    pub water: Water,
}

/// What a recording says in the end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How the game ended.
    pub outcome: Outcome,
    /// How it was run.
    pub run: serde_json::Value,
    /// Messages that are missing, since the disk was too slow for them.
    pub dropped: u64,
}

/// Why something cannot be recorded.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file does not take it.
    #[error("the recording cannot be written: {0}")]
    Mcap(#[from] mcap::McapError),
    /// There is no such file, or it must not be written.
    #[error("the recording cannot be written: {0}")]
    File(#[from] std::io::Error),
    /// It is not JSON.
    #[error("the recording cannot hold this: {0}")]
    Json(#[from] serde_json::Error),
}
