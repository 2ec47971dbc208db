//! The wall clock of commands that play in this process. Nodes have that of `bus`, which a simulated network can stand in for.

use std::time::{Duration, Instant};

/// This moment.
#[expect(clippy::disallowed_methods, reason = "how long something takes is told to people")]
pub fn now() -> Instant {
    Instant::now()
}

/// Waits where there is no condition to wait for.
#[expect(clippy::disallowed_methods, reason = "between two looks at whether somebody wants it to stop")]
pub fn rest(time: Duration) {
    std::thread::sleep(time);
}
