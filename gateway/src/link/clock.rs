//! The monotonic clock of a link, used only for timeouts and time stamps.

use std::time::{Duration, Instant};

#[expect(
    clippy::disallowed_methods,
    reason = "a shell stamps what it reads and limits its waits"
)]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// Time since `start`.
pub(super) fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// Maximum wait in a system call. Between calls, threads check whether they should end.
pub(super) const TICK: Duration = Duration::from_millis(25);
