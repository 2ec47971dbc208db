//! The wall clock of everything that runs on the network: for pacing, and for waits that have a limit. The core is told the
//! time and never reads a clock.

use crate::simulated;
use std::time::{Duration, Instant};

/// This moment; in a simulated network, that of virtual time.
#[must_use]
#[expect(clippy::disallowed_methods, reason = "the one place where nodes read the clock")]
pub fn now() -> Instant {
    simulated::now().unwrap_or_else(Instant::now)
}

/// How long ago `start` was.
#[must_use]
pub fn since(start: Instant) -> Duration {
    now().saturating_duration_since(start)
}

/// How long this machine has been suspended since it was started, of which [`now`] knows nothing: the boot-time clock less the monotonic
/// one, of Linux. In a simulated network no time passes so.
#[must_use]
pub fn suspended() -> Duration {
    #[cfg(target_os = "linux")]
    if !simulated::is_inside() {
        use rustix::time::{ClockId, clock_gettime};
        let read = |id| Duration::try_from(clock_gettime(id)).unwrap_or_default();
        // In this order the difference is never too large.
        let boot_time = read(ClockId::Boottime);
        // `CLOCK_MONOTONIC` stands still while a machine is suspended, `CLOCK_BOOTTIME` does
        // not: the difference is the time that a closed lid has cost, for which a sim blames
        // nobody.
        return boot_time.saturating_sub(read(ClockId::Monotonic));
    }
    Duration::ZERO
}

/// Waits where there is no condition to wait for: between two attempts, or two pictures for a person.
#[expect(clippy::disallowed_methods, reason = "the one place where nodes wait for time to pass")]
pub fn rest(time: Duration) {
    if simulated::is_inside() {
        simulated::wait_until(0, now().checked_add(time));
    } else {
        std::thread::sleep(time);
    }
}
