//! The recording of a game: what it was, its frames, and how it ended.

use crate::bag::{Bag, RecordedMessage, RecordingError};
use crate::{Facts, Kind, Opening};
use messages::water::Water;
use messages::{Frame, GameInfo};
use scenario::{Outcome, Scenario};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::OnceLock;

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
    /// Version, pace, and the scenario with the seed and the values of all randomised parameters.
    pub info: GameInfo,
    /// The waves.
    pub water: Water,
}

/// What a recording says in the end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ending {
    /// How the game ended.
    pub outcome: Outcome,
    /// How it was run.
    pub run: serde_json::Value,
    /// Messages that are missing, since the disk was too slow for them.
    pub dropped: u64,
}

fn facts<const N: usize>(facts: [(&str, String); N]) -> Facts {
    facts.map(|(key, value)| (key.to_owned(), value)).into()
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("plain data is JSON")
}

impl Header {
    /// How the recording of this game begins.
    #[must_use]
    pub fn opening(&self) -> Opening {
        let scenario = &self.info.scenario;
        let drawn = scenario.drawn.iter().map(|drawn| (drawn.parameter.clone(), drawn.value.to_string()));
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
            teams: scenario.teams.iter().map(|team| team.name.clone()).collect(),
        }
    }

    fn of(bag: &Bag) -> Result<Header, RecordingError> {
        let scenario: Scenario =
            serde_json::from_str(bag.fact("scenario")).map_err(|e| RecordingError::not_understood("scenario", e))?;
        scenario.check_references().map_err(|e| RecordingError::not_understood("scenario", e))?;
        Ok(Header {
            commit: bag.fact("commit").to_owned(),
            game: bag.fact("game").to_owned(),
            began_utc_ns: bag.began_utc_ns(),
            info: GameInfo { version: bag.fact("version").to_owned(), pace: bag.fact("pace").to_owned(), scenario },
            water: serde_json::from_str(bag.fact("water")).map_err(|e| RecordingError::not_understood("water", e))?,
        })
    }
}

impl Ending {
    /// What is written of it. How many messages were dropped is known to whoever writes.
    #[must_use]
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
    /// The places of the frames, once somebody asks for one.
    frames: OnceLock<Vec<usize>>,
}

impl Recording {
    /// Opens the recording of a game in a file.
    ///
    /// # Errors
    /// [`RecordingError`] if it cannot be read, is none of a game, or is of another version.
    pub fn open(path: &Path) -> Result<Recording, RecordingError> {
        Recording::of_bag(Bag::open(path)?)
    }

    /// The recording of a game that these bytes are.
    ///
    /// # Errors
    /// [`RecordingError`] as of a file.
    pub fn of(bytes: Vec<u8>) -> Result<Recording, RecordingError> {
        Recording::of_bag(Bag::of(bytes)?)
    }

    /// The recording of a game that this is.
    ///
    /// # Errors
    /// [`RecordingError`] if it is of something else, or its header is not understood.
    pub fn of_bag(bag: Bag) -> Result<Recording, RecordingError> {
        if bag.kind() != Kind::Game {
            return Err(RecordingError::Kind { wanted: Kind::Game, found: bag.kind() });
        }
        let header = Header::of(&bag)?;
        let ending = bag.result().and_then(Ending::of);
        Ok(Recording { header, ending, frames: OnceLock::new(), bag })
    }

    /// The file and its messages.
    #[must_use]
    pub fn bag(&self) -> &Bag {
        &self.bag
    }

    /// What it says of its game.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The game's scenario.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.header.info.scenario
    }

    /// How the game ended; none where the file ends before.
    #[must_use]
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Whether the file ends before the game did.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.bag.is_cut() || self.ending.is_none()
    }

    /// How many frames there are.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.bag.topics().get(FRAME).copied().unwrap_or(0)
    }

    /// A frame, as recorded.
    ///
    /// # Panics
    /// If there are fewer.
    #[must_use]
    pub fn frame(&self, i: usize) -> RecordedMessage<'_> {
        self.bag.message(self.frames.get_or_init(|| self.bag.places(FRAME).collect())[i])
    }

    /// All frames.
    ///
    /// # Errors
    /// [`RecordingError::Damaged`] names the first that is none.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = Result<Frame, RecordingError>> {
        (0..self.frame_count()).map(|i| self.frame(i).read())
    }
}
