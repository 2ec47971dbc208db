//! The wall clock of commands that play games in this process. Nodes use the clock of `bus`, which
//! a simulated network can replace.

use std::time::{Duration, Instant};

/// The current time.
#[expect(clippy::disallowed_methods, reason = "durations are shown to users")]
pub fn now() -> Instant {
    Instant::now()
}

/// Sleeps; use this only where there is no condition to wait for.
#[expect(
    clippy::disallowed_methods,
    reason = "interval between polls of the stop flag"
)]
pub fn rest(time: Duration) {
    std::thread::sleep(time);
}
