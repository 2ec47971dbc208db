//! Why a game cannot be reached, for now or for good.

use crate::BusError;
use std::time::Duration;
use thiserror::Error;

/// Why something is missing.
#[derive(Debug, Error)]
pub enum Missing {
    /// It may appear later.
    #[error("{0}")]
    Yet(String),
    /// It never will.
    #[error(transparent)]
    Forever(#[from] Refusal),
}

/// Why a game cannot be joined even after retries.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Refusal {
    /// The sim refuses, for this reason.
    #[error("{0}")]
    Refused(String),
    /// The sim has another version of Squall; the text describes it.
    #[error("not of one version: this program is {ours}, {0}", ours = primitives::VERSION)]
    Version(String),
}

/// Why a search failed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NotFound {
    /// The search timed out; the text names what was still missing.
    #[error("no game to join after {0:.0?}: {1}")]
    InTime(Duration, String),
    /// The search can never succeed.
    #[error(transparent)]
    Refused(#[from] Refusal),
}

impl From<BusError> for Missing {
    fn from(error: BusError) -> Missing {
        match error {
            BusError::NeedsToken
            // Waiting does not fix these; a person has to act. All others may pass, such as a sim
            // that starts later or an unplugged cable.
            | BusError::WrongToken
            | BusError::Keys(_)
            | BusError::NeedsKeys(_)
            | BusError::NotAllowed { .. } => Missing::Forever(Refusal::Refused(error.to_string())),
            // An unreadable answer comes from another version, and waiting does not change that.
            BusError::Request { .. } => Missing::Forever(Refusal::Version(error.to_string())),
            other => Missing::Yet(other.to_string()),
        }
    }
}
