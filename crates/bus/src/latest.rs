//! Cells that each hold only the newest message, so that a slow reader never works on stale
//! messages.

use crate::Watched;
use std::time::Duration;

/// Numbered cells, each empty or with the newest item.
pub struct Latest<T>(Watched<Vec<Option<T>>>);

impl<T> Latest<T> {
    /// `count` empty cells.
    pub fn new(count: usize) -> Latest<T> {
        Latest(Watched::new((0..count).map(|_| None).collect()))
    }

    /// Stores `item` in a cell and overwrites its content.
    pub fn put(&self, cell: usize, item: T) {
        self.change(cell, |_| item);
    }

    /// Replaces the content of a cell by applying `next` to it.
    pub fn change(&self, cell: usize, next: impl FnOnce(Option<T>) -> T) {
        self.0.visit(|cells| {
            if let Some(cell) = cells.get_mut(cell) {
                *cell = Some(next(cell.take()));
            }
        });
    }

    /// Waits up to `limit` for an item, then empties all cells and returns their items by cell.
    /// After a timeout, all are `None`.
    pub fn take(&self, limit: Duration) -> Vec<Option<T>> {
        self.0
            .wait(limit, |cells| cells.iter().any(Option::is_some));
        // Empty all cells at once: then an agent with boats of several teams works on the newest
        // picture of each team.
        self.0
            .visit(|cells| cells.iter_mut().map(Option::take).collect())
    }
}
