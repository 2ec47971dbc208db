//! Recordings of games and of gateways: MCAP files that ROS 2 tools read as bags.
//!
//! | topic of a game | content | form |
//! |---|---|---|
//! | `frame` | the true state, at every decision | message |
//! | `picture/<team>` | the picture of a team's minds | message |
//! | `inputs` | before each frame, all inputs of the game since the previous frame: sufficient for a rerun | message |
//! | `nav/<boat>`, `external/<boat>`, `link/<boat>` | of real boats: navigation, commands, every byte of the link | message |
//! | `say/<team>`, `policy/<boat>` | messages of minds and policies | message |
//! | `status/<boat>` | the state of gateways | JSON |
//! | `control`, `run` | operator requests, and the state of the run | JSON |
//!
//! | topic of a gateway | content | form |
//! |---|---|---|
//! | `link/<boat>` | every byte of the link, both ways | message |
//! | `input`, `event` | all other inputs of the gateway, and its events | JSON |
//!
//! All messages are CDR, as the profile `ros2` demands: either a Squall message, or a JSON object
//! in a `std_msgs/msg/String`. `log_time` is the UTC time when the recording began plus the time of
//! the game or of the gateway's clock; `publish_time` is the UTC time when the message was
//! recorded. Both are in ns since 1970. `sequence` counts messages within a topic. Schemas are
//! complete ROS 2 message definitions. Chunks are uncompressed and always written whole, so that a
//! truncated file is valid up to its last chunk.
//!
//! The first metadata is the header, with its own checksum: `squall` for a game (version, commit,
//! game, pace, seed, scenario, waves), `gateway` for a gateway (version, commit, boat, plan). A
//! game also has `drawn` (the randomised values) and, unless the file is truncated, `result`
//! (digest, outcome, run, number of dropped messages).

pub mod alog;
mod bag;
mod compressed;
mod damaged;
mod game_recording;
mod index;
mod json_string;
pub mod logs;
mod new_file;
mod recorder;
mod records;
mod source;
pub mod utc;
mod writer;

pub use bag::{Bag, RecordedMessage, RecordingError};
pub use damaged::Damaged;
pub use game_recording::{Ending, FRAME, Header, INPUTS, Recording, picture};
pub use new_file::{LentFile, NewFile, stem};
pub use recorder::Recorder;
pub use writer::{Decision, Entry, Opening, Writer};

use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// The file with the turning points of a recorded game, next to the recording.
pub fn turning_points_of(recording: &Path) -> PathBuf {
    recording.with_extension("turning-points.json")
}

/// The contents of a metadata record.
pub type Facts = BTreeMap<String, String>;

/// Name of the metadata at the end.
const RESULT: &str = "result";

/// The kind of recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A game.
    Game,
    /// The gateway of a real boat.
    Gateway,
}

impl Kind {
    const ALL: [Kind; 2] = [Kind::Game, Kind::Gateway];

    /// The name of the header metadata.
    const fn header(self) -> &'static str {
        match self {
            Kind::Game => "squall",
            Kind::Gateway => "gateway",
        }
    }
}

impl Display for Kind {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Kind::Game => "game",
            Kind::Gateway => "gateway",
        })
    }
}

/// Facts of every header: the version, the start of the recording (UTC, ns since 1970), and a
/// checksum of all facts.
const VERSION: &str = "version";
const BEGAN: &str = "began_utc_ns";
const CHECKSUM: &str = "checksum";

/// The CRC-32 of these facts, excluding the checksum itself. MCAP has checksums for each chunk and,
/// at the end, for the whole file; the header needs its own because the end may be missing.
fn checksum(facts: &Facts) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in facts.iter().filter(|(key, _)| *key != CHECKSUM) {
        [key, "\0", value, "\0"]
            .iter()
            .for_each(|text| hasher.update(text.as_bytes()));
    }
    hasher.finalize().to_string()
}

/// Why recording failed.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The data does not conform to the format.
    #[error("the recording cannot be written: {0}")]
    Mcap(mcap::McapError),
    /// The file is missing or not writable, or the disk is full.
    #[error(transparent)]
    File(#[from] std::io::Error),
}

impl From<mcap::McapError> for RecordError {
    fn from(error: mcap::McapError) -> RecordError {
        match error {
            // The system's error is the informative one.
            mcap::McapError::Io(error) => error.into(),
            other => RecordError::Mcap(other),
        }
    }
}
