//! The wall clock of everything that runs on the network: for pacing, and for waits that have a limit. The core is told the
//! time and never reads a clock.

use std::time::{Duration, Instant};

/// This moment.
#[must_use]
#[expect(clippy::disallowed_methods, reason = "the one place where nodes read the clock")]
pub fn now() -> Instant {
    Instant::now()
}

/// How long ago `start` was.
#[must_use]
pub fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// Waits where there is no condition to wait for: between two attempts, or two pictures for a person.
#[expect(clippy::disallowed_methods, reason = "the one place where nodes wait for time to pass")]
pub fn rest(time: Duration) {
    std::thread::sleep(time);
}
