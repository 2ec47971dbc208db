//! A board on which callbacks write, and which a node reads, or watches until something stands on it.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Something that one thread changes and another waits for.
pub struct Watched<T> {
    state: Mutex<T>,
    news: Condvar,
}

impl<T> Watched<T> {
    /// A board with this on it.
    #[must_use]
    pub fn new(state: T) -> Watched<T> {
        Watched { state: Mutex::new(state), news: Condvar::new() }
    }

    /// Reads or changes what is on it, and wakes those who watch.
    pub fn visit<R>(&self, visit: impl FnOnce(&mut T) -> R) -> R {
        let result = visit(&mut self.lock());
        self.news.notify_all();
        result
    }

    /// Waits up to `limit` until `is_there` holds, and says whether it does.
    pub fn wait(&self, limit: Duration, mut is_there: impl FnMut(&T) -> bool) -> bool {
        let waiting = self.news.wait_timeout_while(self.lock(), limit, |state| !is_there(state));
        !waiting.unwrap_or_else(PoisonError::into_inner).1.timed_out()
    }

    /// What is on it is whole whatever happened to the thread that wrote it: visits only replace whole items.
    fn lock(&self) -> MutexGuard<'_, T> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::Watched;
    use std::sync::Arc;
    use std::time::Duration;

    #[test]
    fn a_watcher_sees_what_is_written_and_does_not_wait_forever() {
        let board = Arc::new(Watched::new(0));
        assert!(!board.wait(Duration::from_millis(1), |n| *n == 1));
        let writer = Arc::clone(&board);
        let thread = std::thread::spawn(move || writer.visit(|n| *n = 1));
        assert!(board.wait(Duration::from_secs(60), |n| *n == 1));
        thread.join().expect("it writes");
    }
}
