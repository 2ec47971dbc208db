//! Why a game cannot be reached, yet or for good.

use crate::BusError;
use std::time::Duration;
use thiserror::Error;

/// Why something is not there.
#[derive(Debug, Error)]
pub enum Missing {
    /// It may come.
    #[error("{0}")]
    Yet(String),
    /// It will not.
    #[error(transparent)]
    Forever(#[from] Refusal),
}

/// Why a game cannot be joined, and asking again will not help.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The sim says no.
    #[error("{0}")]
    Refused(String),
    /// It speaks another version of Squall; this is what is known of it.
    #[error("not of one version: this program is {ours}, {0}", ours = primitives::VERSION)]
    Version(String),
}

/// Why a search ended without success.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotFound {
    /// The time is up; this was missing last.
    #[error("no game to join after {0:.0?}: {1}")]
    InTime(Duration, String),
    /// It will never be there.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl From<BusError> for Missing {
    fn from(error: BusError) -> Missing {
        match error {
            BusError::NeedsToken
            // No waiting makes these better; a person has to do something. All others may pass:
            // a sim that begins later, a cable that is plugged in.
            | BusError::WrongToken
            | BusError::Keys(_)
            | BusError::NeedsKeys(_)
            | BusError::NotAllowed { .. } => Missing::Forever(Refusal::Refused(error.to_string())),
            // An answer that cannot be read comes from another version, and waiting does not
            // change that.
            BusError::Request { .. } => Missing::Forever(Refusal::Version(error.to_string())),
            other => Missing::Yet(other.to_string()),
        }
    }
}
