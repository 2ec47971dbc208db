//! The wall clock of network code: for pacing and timeouts. The core receives the time as an
//! argument and never reads a clock.

use crate::runtime::runtime;
use std::time::{Duration, Instant};

/// The current time.
pub fn now() -> Instant {
    runtime().now()
}

/// Time elapsed since `start`.
pub fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// How long this machine has been suspended since boot, which [`now`] does not count: on Linux, the
/// boot-time clock minus the monotonic one; on other systems, always zero.
pub fn suspended() -> Duration {
    runtime().suspended()
}

/// Sleeps between two attempts or two screen updates, where there is no condition to wait for.
pub fn rest(time: Duration) {
    runtime().sleep(time);
}

/// The wall-clock time since 1970, ns, for other programs that need it. Squall never compares such
/// times.
pub fn unix_ns() -> i64 {
    i64::try_from(time::OffsetDateTime::now_utc().unix_timestamp_nanos()).unwrap_or(i64::MAX)
}
