//! The state from which a training run is resumed.

use super::evaluation::Played;
use super::league::{League, PastSelf};
use super::learner::Learner;
use crate::environment::SetupError;
use crate::training::Training;
use agent::Action;
use serde::{Deserialize, Serialize};
use thiserror::Error;
use xxhash_rust::xxh3::xxh3_64;

/// A training run's state after an update.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    pub(super) learner: Learner,
    pub(super) updates: u64,
    /// Updates since the last restart of all games.
    pub(super) updates_of_epoch: u64,
    /// Restarts of all games.
    pub(super) epoch: u64,
    pub(super) samples: u64,
    pub(super) stage: usize,
    pub(super) samples_of_stage: u64,
    pub(super) league: League,
    pub(super) evaluations: Vec<Evaluated>,
    pub(super) best: Option<Best>,
    /// The past policies at the last restart of all games; empty until the first update after it.
    pub(super) past_at_restart: Vec<PastSelf>,
    /// The updates since then, which bring the games to this state when replayed.
    pub(super) played: Vec<PlayedUpdate>,
}

/// The effect of an update on the games.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PlayedUpdate {
    /// The opponents' draw weights.
    pub(super) weights: Vec<f64>,
    /// The actions, steps × rows.
    pub(super) actions: Vec<Action>,
    /// The past policy that became an opponent after the steps.
    pub(super) kept: Option<PastSelf>,
}

/// An evaluation of a policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluated {
    /// Number of samples that the policy had learned from.
    pub samples: u64,
    /// Index of the stage.
    pub stage: usize,
    /// The results by the opponent's name.
    pub played: Vec<(String, Played)>,
}

impl Evaluated {
    /// The fraction of all games won; a draw counts half.
    pub fn won(&self) -> f64 {
        self.played
            .iter()
            .map(|(_, played)| played.won())
            .sum::<f64>()
            / self.played.len().max(1) as f64
    }
}

/// The best policy of a training run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// Number of samples that it had learned from.
    pub samples: u64,
    /// The fraction of all evaluation games won; a draw counts half.
    pub won: f64,
    /// Its ONNX file.
    pub onnx: Vec<u8>,
}

/// The beginning of a state, which identifies the training.
#[derive(PartialEq, Serialize, Deserialize)]
struct Head {
    version: String,
    /// The training as JSON.
    training: String,
}

impl Head {
    fn of(training: &Training) -> Head {
        let training = serde_json::to_string(training).expect("numbers and lists can be written");
        Head {
            version: primitives::VERSION.to_owned(),
            training,
        }
    }
}

/// A reason why a training run cannot be resumed.
#[derive(Debug, Error)]
pub enum StateError {
    /// Not the state of a training run.
    #[error("it is not the state of a training run, or it is damaged")]
    Damaged,
    /// The state was written by a different version.
    #[error("it was written by version {found}, expected {}", primitives::VERSION)]
    Version {
        /// The version in the state.
        found: String,
    },
    /// The state is from a different training run.
    #[error("it is the state of a different training run: the training file has changed since")]
    Other,
    /// A setup cannot be played.
    #[error(transparent)]
    Setup(#[from] SetupError),
}

impl State {
    pub(super) fn new(learner: Learner) -> State {
        State {
            learner,
            updates: 0,
            updates_of_epoch: 0,
            epoch: 0,
            samples: 0,
            stage: 0,
            samples_of_stage: 0,
            league: League::default(),
            evaluations: vec![],
            best: None,
            past_at_restart: vec![],
            played: vec![],
        }
    }

    pub(super) fn write(&self, training: &Training) -> Vec<u8> {
        let mut bytes = postcard::to_stdvec(&(Head::of(training), self))
            .expect("numbers and lists can be written");
        let sum = xxh3_64(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    pub(super) fn read(bytes: &[u8], training: &Training) -> Result<State, StateError> {
        // Read it first, because other versions may use a different format after it.
        let (version, _) =
            postcard::take_from_bytes::<String>(bytes).map_err(|_| StateError::Damaged)?;
        if version != primitives::VERSION {
            return Err(StateError::Version { found: version });
        }
        // A flipped bit in a weight is a valid number. The checksum prevents it from silently
        // changing the policy.
        let (bytes, sum) = bytes.split_last_chunk().ok_or(StateError::Damaged)?;
        if xxh3_64(bytes) != u64::from_le_bytes(*sum) {
            return Err(StateError::Damaged);
        }
        let (head, state): (Head, State) =
            postcard::from_bytes(bytes).map_err(|_| StateError::Damaged)?;
        if head != Head::of(training) {
            return Err(StateError::Other);
        }
        Ok(state)
    }
}
