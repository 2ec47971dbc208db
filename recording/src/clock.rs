//! The clock of recorders.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// UTC, ns since 1970; 0 where the host's clock stands before that.
#[expect(clippy::disallowed_methods, reason = "a recording says when it was made")]
pub(super) fn utc_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// Waits. Whoever is waited for need not wake anybody.
#[expect(clippy::disallowed_methods, reason = "notes are written down in batches, by the clock")]
pub(super) fn rest(time: Duration) {
    std::thread::sleep(time);
}

/// Now, for spans.
#[expect(clippy::disallowed_methods, reason = "what is recorded is handed to the disk by the clock")]
pub(super) fn now() -> Instant {
    Instant::now()
}
