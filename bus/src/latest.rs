//! Cells that hold only the newest message each: a slow reader never works on stale ones.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Numbered cells, each with the newest item or nothing.
pub struct Latest<T> {
    cells: Mutex<Vec<Option<T>>>,
    news: Condvar,
}

impl<T> Latest<T> {
    /// `count` empty cells.
    #[must_use]
    pub fn new(count: usize) -> Latest<T> {
        Latest { cells: Mutex::new((0..count).map(|_| None).collect()), news: Condvar::new() }
    }

    /// Puts `item` into a cell, over whatever is there.
    pub fn put(&self, cell: usize, item: T) {
        self.change(cell, |_| item);
    }

    /// Puts into a cell what `next` makes of what is there.
    pub fn change(&self, cell: usize, next: impl FnOnce(Option<T>) -> T) {
        if let Some(cell) = self.lock().get_mut(cell) {
            *cell = Some(next(cell.take()));
        }
        self.news.notify_all();
    }

    /// Waits up to `limit` for news; takes what is there, by cell. All `None` means that nothing came.
    pub fn take(&self, limit: Duration) -> Vec<Option<T>> {
        let guard = self.lock();
        let empty = |cells: &mut Vec<Option<T>>| cells.iter().all(Option::is_none);
        let (mut cells, _) = self.news.wait_timeout_while(guard, limit, empty).unwrap_or_else(PoisonError::into_inner);
        cells.iter_mut().map(Option::take).collect()
    }

    /// A cell is whole whatever happened to the thread that filled it last.
    fn lock(&self) -> MutexGuard<'_, Vec<Option<T>>> {
        self.cells.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
