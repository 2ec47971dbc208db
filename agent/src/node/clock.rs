//! The wall clock of an agent node: for waiting with a limit. Minds never see it.

use std::time::{Duration, Instant};

/// This moment.
#[expect(clippy::disallowed_methods, reason = "a shell limits its waits by the clock")]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// How long ago `start` was.
pub(super) fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}
