//! Arguments from Python.

use experiment::Packed;
use learn::environment::{ActionSpace, CriticInput, ObservationSpace, RawObservation, RawSetup};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use std::fmt::Display;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::PathBuf;

/// A mapping with these keys, which are explained in the stub.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Arguments {
    game: PathBuf,
    team_sizes: Option<[[u32; 2]; 2]>,
    observation: String,
    frames: u8,
    action: String,
    helm: Option<PathBuf>,
    decision_s: Option<f64>,
    decision_min_s: f64,
    episode_max_s: Option<f64>,
    starts: Option<u32>,
    team: Option<String>,
    mates: Option<PathBuf>,
    opponents: Vec<(f64, Option<PathBuf>)>,
    rewards: Option<PathBuf>,
    discount: f64,
    state: bool,
}

impl Arguments {
    /// Checks the arguments.
    pub(crate) fn setup(self) -> PyResult<RawSetup> {
        let observation = match self.observation.as_str() {
            "pyquaticus" => RawObservation::Space(ObservationSpace::Pyquaticus),
            "pyquaticus_2023" => RawObservation::Space(ObservationSpace::Pyquaticus2023),
            "pyquaticus_2026" => RawObservation::Space(ObservationSpace::Pyquaticus2026),
            "squall" => RawObservation::Squall {
                frames: self.frames,
            },
            other => {
                return Err(refused(format!(
                    "observation is {other:?}, expected \"squall\", \"pyquaticus\", \"pyquaticus_2023\" or \"pyquaticus_2026\""
                )));
            }
        };
        let action = match self.action.as_str() {
            "pyquaticus" => ActionSpace::Pyquaticus,
            "continuous" => ActionSpace::Continuous,
            "options" => ActionSpace::Options,
            other => {
                let expected = "\"pyquaticus\", \"continuous\" or \"options\"";
                return Err(refused(format!("action is {other:?}, expected {expected}")));
            }
        };
        Ok(RawSetup {
            game: self.game,
            sea: None,
            team_sizes: self.team_sizes,
            observation,
            action,
            helm: self.helm,
            decision_s: self.decision_s,
            decision_min_s: self.decision_min_s,
            episode_max_s: self.episode_max_s,
            starts: self.starts,
            team: self.team,
            mates: self.mates,
            opponents: self.opponents,
            rewards: self.rewards,
            discount: self.discount,
            critic: if self.state {
                CriticInput::Truth
            } else {
                CriticInput::Observation
            },
        })
    }
}

/// Converts one of our errors to Python's `ValueError`, with its full message.
pub(crate) fn refused(error: impl Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// A packed plan in Python, explained in the stub.
pub(crate) type PackedParts = (String, Vec<(PathBuf, Vec<u8>)>, String);

/// Converts a packed plan for Python.
pub(crate) fn parts_of(
    Packed {
        spec,
        files,
        digest,
    }: Packed,
) -> PackedParts {
    (spec, files, digest)
}

/// Converts a packed plan from Python.
pub(crate) fn packed_of((spec, files, digest): PackedParts) -> Packed {
    Packed {
        spec,
        files,
        digest,
    }
}

/// Checks overrides of the number of games and the first seed.
pub(crate) fn games_and_seed(
    games: Option<u32>,
    seed: Option<u64>,
) -> PyResult<(Option<u32>, Option<u64>)> {
    if let Some(games) = games.filter(|games| !(2..=1_000_000).contains(games)) {
        return Err(refused(format!("games is {games}, expected 2 to 1000000")));
    }
    if let Some(seed) = seed.filter(|seed| i64::try_from(*seed).is_err()) {
        return Err(refused(format!(
            "seed is {seed}, expected 0 to {}",
            i64::MAX
        )));
    }
    Ok((games, seed))
}

/// Checks a range of games and the number of threads.
pub(crate) fn stretch(
    (begin, end): (usize, usize),
    games: usize,
    threads: usize,
) -> PyResult<(Range<usize>, NonZeroUsize)> {
    if begin > end || end > games {
        return Err(PyIndexError::new_err(format!(
            "games {begin} to {end}, expected from 0 to {games} and in order"
        )));
    }
    let threads =
        NonZeroUsize::new(threads).ok_or_else(|| refused("threads is 0, expected at least 1"))?;
    Ok((begin..end, experiment::threads(Some(threads), end - begin)))
}
