//! The recording of a game: its header, its frames and its ending.

use crate::bag::{Bag, RecordedMessage, RecordingError};
use crate::{Facts, Kind, Opening};
use messages::water::Water;
use messages::{Frame, GameInfo};
use scenario::{Outcome, Scenario};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::OnceLock;

/// The topic of frames.
pub const FRAME: &str = "frame";
/// The topic of the game's inputs.
pub const INPUTS: &str = "inputs";

/// The topic of a team's pictures.
pub fn picture(team: &str) -> String {
    format!("picture/{team}")
}

/// The header of a game's recording, known before the game starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The commit from which the program was built.
    pub commit: String,
    /// The game's name.
    pub game: String,
    /// Start of the recording: UTC, ns since 1970.
    pub began_utc_ns: u64,
    /// Version, pace, and the scenario with its seed and all randomised values.
    pub info: GameInfo,
    /// The waves.
    pub water: Water,
}

/// The ending of a game's recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How the game ended.
    pub outcome: Outcome,
    /// Report on how the game was run.
    pub run: serde_json::Value,
    /// Messages dropped because the disk was too slow.
    pub dropped: u64,
}

fn facts<const N: usize>(facts: [(&str, String); N]) -> Facts {
    facts.map(|(key, value)| (key.to_owned(), value)).into()
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("plain data is JSON")
}

impl Header {
    /// The opening of this game's recording.
    pub fn opening(&self) -> Opening {
        let scenario = &self.info.scenario;
        let drawn = scenario
            .drawn
            .iter()
            .map(|drawn| (drawn.parameter.clone(), drawn.value.to_string()));
        Opening {
            kind: Kind::Game,
            began_utc_ns: self.began_utc_ns,
            facts: facts([
                ("version", self.info.version.clone()),
                ("commit", self.commit.clone()),
                ("game", self.game.clone()),
                ("pace", self.info.pace.clone()),
                ("seed", scenario.seed.to_string()),
                ("scenario", json(scenario)),
                ("water", json(&self.water)),
            ]),
            more: vec![("drawn", drawn.collect())],
            teams: scenario
                .teams
                .iter()
                .map(|team| team.name.clone())
                .collect(),
        }
    }

    fn of(bag: &Bag) -> Result<Header, RecordingError> {
        let scenario: Scenario = serde_json::from_str(bag.fact("scenario"))
            .map_err(|e| RecordingError::not_understood("scenario", e))?;
        scenario
            .check_received()
            .map_err(|e| RecordingError::not_understood("scenario", e))?;
        Ok(Header {
            commit: bag.fact("commit").to_owned(),
            game: bag.fact("game").to_owned(),
            began_utc_ns: bag.began_utc_ns,
            info: GameInfo {
                version: bag.fact("version").to_owned(),
                pace: bag.fact("pace").to_owned(),
                scenario,
            },
            water: serde_json::from_str(bag.fact("water"))
                .map_err(|e| RecordingError::not_understood("water", e))?,
        })
    }
}

impl Ending {
    /// The facts of the ending, except the number of dropped messages, which the recorder adds.
    pub fn facts(&self) -> Facts {
        facts([
            ("digest", self.outcome.digest.clone()),
            ("outcome", json(&self.outcome)),
            ("run", self.run.to_string()),
            ("dropped", self.dropped.to_string()),
        ])
    }

    fn of(facts: &Facts) -> Option<Ending> {
        Some(Ending {
            outcome: serde_json::from_str(facts.get("outcome")?).ok()?,
            run: serde_json::from_str(facts.get("run")?).ok()?,
            dropped: facts.get("dropped")?.parse().ok()?,
        })
    }
}

/// The recording of a game.
#[derive(Debug)]
pub struct Recording {
    bag: Bag,
    header: Header,
    ending: Option<Ending>,
    /// The positions of the frames, computed on first use.
    frames: OnceLock<Vec<usize>>,
}

impl Recording {
    /// Opens the recording of a game.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, is not the recording of a game, or is from a
    /// different version.
    pub fn open(path: &Path) -> Result<Recording, RecordingError> {
        Recording::of_bag(Bag::open(path)?)
    }

    /// Opens the recording of a game in memory.
    ///
    /// # Errors
    /// [`RecordingError`] as for a file.
    pub fn of(bytes: Vec<u8>) -> Result<Recording, RecordingError> {
        Recording::of_bag(Bag::of(bytes)?)
    }

    /// Interprets a recording as that of a game.
    ///
    /// # Errors
    /// [`RecordingError`] if the recording is of a different kind, or its header is invalid.
    pub fn of_bag(bag: Bag) -> Result<Recording, RecordingError> {
        if bag.kind != Kind::Game {
            return Err(RecordingError::Kind {
                wanted: Kind::Game,
                found: bag.kind,
            });
        }
        let header = Header::of(&bag)?;
        let ending = bag.result.as_ref().and_then(Ending::of);
        Ok(Recording {
            header,
            ending,
            frames: OnceLock::new(),
            bag,
        })
    }

    /// The underlying recording.
    pub fn bag(&self) -> &Bag {
        &self.bag
    }

    /// The header.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The game's scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.header.info.scenario
    }

    /// The ending; `None` if the file is truncated.
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Whether the file is truncated.
    pub fn is_cut(&self) -> bool {
        self.bag.is_cut || self.ending.is_none()
    }

    /// The number of frames.
    pub fn frame_count(&self) -> usize {
        self.bag.topics().get(FRAME).copied().unwrap_or(0)
    }

    /// The `i`th frame, as recorded.
    ///
    /// # Panics
    /// If `i` is out of range.
    pub fn frame(&self, i: usize) -> RecordedMessage<'_> {
        self.bag
            .message(self.frames.get_or_init(|| self.bag.places(FRAME).collect())[i])
    }

    /// All frames.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] for each frame that does not decode.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = Result<Frame, RecordingError>> {
        (0..self.frame_count()).map(|i| self.frame(i).read())
    }
}
