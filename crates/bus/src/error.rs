//! What can go wrong between nodes.

use crate::keys::Identity;
use crate::zenoh_threads::KEYS_RUNTIME;
use thiserror::Error;

/// What can go wrong between nodes.
#[derive(Debug, Error)]
pub enum BusError {
    /// The session could not be opened.
    #[error("cannot open the network {what}: {reason}")]
    Open {
        /// Where it was tried.
        what: String,
        /// What zenoh says.
        reason: String,
    },
    /// A setting of the configuration was refused.
    #[error("network setting {key} = {value}: {reason}")]
    Setting {
        /// The setting.
        key: String,
        /// Its value.
        value: String,
        /// What zenoh says.
        reason: String,
    },
    /// A request has an answer that is none.
    #[error("the answer at {key} is {reason}")]
    Request {
        /// The key.
        key: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The sim says no, for this reason.
    #[error("the sim refuses: {0}")]
    Refused(String),
    /// The sim says nothing.
    #[error("the sim does not answer")]
    Silent,
    /// The game asks for its token.
    #[error(
        "the game asks for its token, which `squall sim` showed when it began: give it by --token-file FILE, or in the \
         environment as SQUALL_TOKEN"
    )]
    NeedsToken,
    /// The game does not know this token.
    #[error("the token is not that of this game: `squall sim` showed it when it began")]
    WrongToken,
    /// A node answers that does not know the token, or knows another one.
    #[error(
        "{key} was answered, but not by a node that knows this token: it is the token of another game, or a stranger answers"
    )]
    Unsealed {
        /// The key that was asked.
        key: String,
    },
    /// The keys are not those that are needed here, or the other side's are not.
    #[error("{0}")]
    Keys(String),
    /// A session with keys in a process in which zenoh has other threads than one: its TLS links are not safe there.
    #[error("a node with keys needs the environment variable ZENOH_RUNTIME = {KEYS_RUNTIME} from its start; {0}")]
    Threads(String),
    /// The game has keys, and none were given.
    #[error("{0} speaks TLS: the game has keys, give yours by --keys FOLDER (see `squall keys`)")]
    NeedsKeys(String),
    /// Who shows this certificate may not ask for this.
    #[error("{identity} may not do this: its keys do not allow it, take those of an operator")]
    NotAllowed {
        /// Whose keys they are.
        identity: Identity,
    },
    /// Something could not be declared or sent.
    #[error("cannot {doing} {key}: {reason}")]
    Use {
        /// For example `publish on`.
        doing: &'static str,
        /// The key.
        key: String,
        /// What zenoh says.
        reason: String,
    },
}

/// What zenoh says, without the place in its source that it adds.
pub(crate) fn reason(error: &zenoh::Error) -> String {
    let text = error.to_string();
    text.split(" at /").next().unwrap_or(&text).trim_end_matches(['!', ' ']).to_owned()
}
