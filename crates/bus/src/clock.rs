//! The wall clock of everything that runs on the network: for pacing, and for waits that have a limit. The core is told the
//! time and never reads a clock.

use crate::runtime::runtime;
use std::time::{Duration, Instant};

/// This moment.
#[must_use]
pub fn now() -> Instant {
    runtime().now()
}

/// How long ago `start` was.
#[must_use]
pub fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// How long this machine has been suspended since it was started, of which [`now`] knows nothing: the boot-time clock less the monotonic
/// one, of Linux.
#[must_use]
pub fn suspended() -> Duration {
    runtime().suspended()
}

/// Waits where there is no condition to wait for: between two attempts, or two pictures for a person.
pub fn rest(time: Duration) {
    runtime().sleep(time);
}
