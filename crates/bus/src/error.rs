//! Errors between nodes.

use crate::keys::Identity;
use crate::zenoh_threads::KEYS_RUNTIME;
use thiserror::Error;

/// An error between nodes.
#[derive(Debug, Error)]
pub enum BusError {
    /// The session could not be opened.
    #[error("cannot {what}: {reason}")]
    Open {
        /// The endpoint or role that failed to open.
        what: String,
        /// zenoh's error.
        reason: String,
    },
    /// A setting of the configuration was rejected.
    #[error("network setting {key} = {value}: {reason}")]
    Setting {
        /// The key of the setting.
        key: String,
        /// The value of the setting.
        value: String,
        /// zenoh's error.
        reason: String,
    },
    /// A query got an invalid answer.
    #[error("invalid answer at {key}: {reason}")]
    Request {
        /// The key of the query.
        key: String,
        /// The fault in the answer.
        reason: String,
    },
    /// The sim refuses, for the given reason.
    #[error("refused by the sim: {0}")]
    Refused(String),
    /// The sim does not respond.
    #[error("the sim does not respond")]
    Silent,
    /// The game requires its token.
    #[error(
        "the game requires its token, which `squall sim` printed when it started: pass it with --token-file FILE, or in \
         the environment as SQUALL_TOKEN"
    )]
    NeedsToken,
    /// The token belongs to a different game.
    #[error("wrong token for this game: use the one that `squall sim` printed when it started")]
    WrongToken,
    /// A node answered without proving that it knows this token.
    #[error(
        "no node with this token answered at {key}: the token belongs to a different game, or an untrusted node answered"
    )]
    Unsealed {
        /// The key of the query.
        key: String,
    },
    /// This node's keys or the peer's are wrong.
    #[error("{0}")]
    Keys(String),
    /// A session with keys in a process with more than one zenoh thread, where its TLS links are
    /// not safe.
    #[error(
        "a node with keys must be started with ZENOH_RUNTIME={KEYS_RUNTIME} in its environment; {0}"
    )]
    Threads(String),
    /// The game has keys, but this node has none.
    #[error("{0} uses TLS: the game has keys; pass yours with --keys FOLDER (see `squall keys`)")]
    NeedsKeys(String),
    /// The certificate of this node gives no right to this query.
    #[error("the keys of {identity} do not allow this request: use an operator's keys")]
    NotAllowed {
        /// The identity in the certificate.
        identity: Identity,
    },
    /// A declaration or a message failed.
    #[error("cannot {doing} {key}: {reason}")]
    Use {
        /// The failed action, for example `publish on`.
        doing: &'static str,
        /// The key of the topic.
        key: String,
        /// zenoh's error.
        reason: String,
    },
}

/// zenoh's error, without the appended source location and the repeated endpoints.
pub(crate) fn reason(error: &zenoh::Error) -> String {
    let text = error.to_string();
    let text = text
        .split(" at /")
        .next()
        .unwrap_or(&text)
        .trim_end_matches(['!', ' ']);
    if text.starts_with("Unable to connect to any of") {
        return "no response; check the address and port, and that the sim is running".to_owned();
    }
    match text
        .rsplit_once(": ")
        .filter(|_| text.starts_with("Can not create a new"))
    {
        Some((_, cause)) => cause.to_owned(),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_endpoint_is_explained_without_zenohs_notation() {
        for (text, want) in [
            (
                "Unable to connect to any of [Single(tcp/10.0.0.5:1)]! at /a/b.rs:1.",
                "no response; check",
            ),
            (
                "Can not create a new TCP listener bound to tcp/10.0.0.5:1: [10.0.0.5:1: Address already in use (os error \
                 98) at /a/b.rs:1.]",
                "Address already in use (os error 98)",
            ),
            ("Invalid key [x]!", "Invalid key [x]"),
        ] {
            assert!(
                reason(&text.into()).starts_with(want),
                "{}",
                reason(&text.into())
            );
        }
    }
}
