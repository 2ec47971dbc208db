//! Rate-limited remarks about a payload.

use super::super::loop_input::Call;
use bus::{InboxSender, clock};
use parking_lot::Mutex;
use std::time::{Duration, Instant};

/// Minimum time between remarks.
const EVERY: Duration = Duration::from_secs(10);

/// The remarks of a payload.
pub(super) struct Remarks {
    name: String,
    calls: InboxSender<Call>,
    last: Mutex<Option<Instant>>,
}

impl Remarks {
    pub(super) fn new(name: &str, calls: InboxSender<Call>) -> Remarks {
        Remarks { name: name.to_owned(), calls, last: Mutex::default() }
    }

    /// Logs a remark, unless one was logged just now.
    pub(super) fn make(&self, text: &str) {
        let mut last = self.last.lock();
        if last.is_some_and(|at| clock::since(at) < EVERY) {
            return;
        }
        *last = Some(clock::now());
        // A loop whose queue is full has worse to report.
        self.calls.offer(Call::Remark(format!("payload {}: {text}", self.name)));
    }
}
