//! The wall clock of a link. Only patience and time stamps look at it.

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
