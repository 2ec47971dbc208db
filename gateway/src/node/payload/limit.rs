//! The limits of what a payload, or a client of it, may take.

use std::time::Duration;

/// The most clients of a payload at once.
pub(super) const CLIENTS_MAX: usize = 16;

/// The longest attempt to reach a payload.
pub(super) const CONNECT_MAX: Duration = Duration::from_secs(2);
/// Whoever takes nothing for this long is given up.
pub(super) const WRITE_MAX: Duration = Duration::from_secs(10);
/// How often a thread that waits for bytes looks whether it is to end.
pub(super) const LOOK: Duration = Duration::from_millis(100);
/// How long the answer to a client that sends nothing more may pause.
pub(super) const ANSWER_PAUSE: Duration = Duration::from_secs(5);
