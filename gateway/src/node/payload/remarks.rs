//! What is logged of a payload, no more than a remark now and then.

use super::super::loop_input::Call;
use bus::{InboxSender, clock};
use parking_lot::Mutex;
use std::time::{Duration, Instant};

/// No more than one in this time.
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

    /// Has something logged, unless something was just now.
    pub(super) fn make(&self, text: &str) {
        let mut last = self.last.lock();
        if last.is_some_and(|at| clock::since(at) < EVERY) {
            return;
        }
        *last = Some(clock::now());
        // A loop that has no room for it has worse to tell.
        self.calls.offer(Call::Remark(format!("payload {}: {text}", self.name)));
    }
}
