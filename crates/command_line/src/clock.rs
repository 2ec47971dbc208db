//! The wall clock of commands that play in this process. Nodes use that of `bus`, which a simulated
//! network can replace.

use std::time::{Duration, Instant};

/// The current time.
#[expect(clippy::disallowed_methods, reason = "how long something takes is told to people")]
pub fn now() -> Instant {
    Instant::now()
}

/// Sleeps where no condition can be waited for.
#[expect(clippy::disallowed_methods, reason = "between two looks at whether somebody wants it to stop")]
pub fn rest(time: Duration) {
    std::thread::sleep(time);
}
