//! The wall clock of the page's server. Everything else gets the time as an argument.

use std::time::Instant;

/// This moment.
#[expect(clippy::disallowed_methods, reason = "a page is told news by the clock")]
pub(super) fn now() -> Instant {
    Instant::now()
}
