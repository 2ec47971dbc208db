//! What can go wrong between nodes.

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
