//! The limits for payloads and their clients.

use std::time::Duration;

/// Maximum number of simultaneous clients of a payload.
pub(super) const CLIENTS_MAX: usize = 16;

/// Maximum time to connect to a payload.
pub(super) const CONNECT_MAX: Duration = Duration::from_secs(2);
/// A side that accepts no bytes for this long is disconnected.
pub(super) const WRITE_MAX: Duration = Duration::from_secs(10);
/// How often a thread that waits for bytes checks whether it must end.
pub(super) const LOOK: Duration = Duration::from_millis(100);
/// Maximum pause in the answer to a client that sends nothing more.
pub(super) const ANSWER_PAUSE: Duration = Duration::from_secs(5);
