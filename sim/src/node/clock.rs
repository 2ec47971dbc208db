//! The wall clock of a sim node. Only pacing and patience look at it; the game never does.

use std::time::{Duration, Instant};

/// This moment.
#[expect(clippy::disallowed_methods, reason = "a shell paces the game by the clock")]
pub(super) fn now() -> Instant {
    Instant::now()
}

/// How long ago `start` was.
pub(super) fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}
