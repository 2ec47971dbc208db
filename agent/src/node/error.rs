//! Why an agent could not play to the end.

use bus::BusError;
use bus::game_search::{NotFound, Refusal};
use std::time::Duration;
use thiserror::Error;

/// Why an agent could not play to the end.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// No sim within the time allowed.
    #[error("no game to join after {0:.0?}: {1}")]
    NoGame(Duration, String),
    /// The sim said no.
    #[error("the sim refuses: {0}")]
    Refused(String),
    /// The sim speaks another version.
    #[error("agent and sim are not of one version: the agent is {ours}, {theirs}", ours = primitives::VERSION)]
    Version {
        /// What is known of the sim's.
        theirs: String,
    },
    /// The sim fell silent.
    #[error("the sim is gone: no picture for {0:.1?}")]
    SimGone(Duration),
    /// Another sim serves a game of the same name, and knows nothing of us.
    #[error("the sim is gone, and another one serves the game: join again")]
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
