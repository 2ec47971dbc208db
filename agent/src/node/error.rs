//! Errors that end an agent's game early.

use bus::BusError;
use bus::game_search::{NotFound, Refusal};
use std::time::Duration;
use thiserror::Error;

/// An error that ends an agent's game early.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// No sim was found within the allowed time.
    #[error("found no game to join within {0:.0?}: {1}")]
    NoGame(Duration, String),
    /// The sim rejected the request.
    #[error("refused by the sim: {0}")]
    Refused(String),
    /// The sim has a different version.
    #[error("agent and sim have different versions: the agent is {ours}, {theirs}", ours = primitives::VERSION)]
    Version {
        /// The sim's version, if known.
        theirs: String,
    },
    /// No picture has arrived from the sim for this long.
    #[error("lost the sim: no picture for {0:.1?}")]
    SimGone(Duration),
    /// A different sim now serves a game with the same name, and does not know this agent.
    #[error("lost the sim, and another one now serves the game: join again")]
    SimReplaced,
}

impl From<NotFound> for NodeError {
    fn from(not_found: NotFound) -> NodeError {
        match not_found {
            NotFound::InTime(after, missing) => NodeError::NoGame(after, missing),
            NotFound::Refused(Refusal::Refused(reason)) => NodeError::Refused(reason),
            NotFound::Refused(Refusal::Version(theirs)) => NodeError::Version { theirs },
        }
    }
}
