//! The monotonic clock of a link: for timeouts and time stamps only.

use std::time::{Duration, Instant};

/// This moment.
#[expect(clippy::disallowed_methods, reason = "a shell stamps what it reads and limits its waits")]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// How long ago `start` was.
pub(super) fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// The longest wait in a system call. Threads check between calls whether they are to end.
pub(super) const TICK: Duration = Duration::from_millis(25);
