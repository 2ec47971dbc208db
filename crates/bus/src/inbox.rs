//! A bounded queue from the network's threads to a node's own thread.

use crate::Watched;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The state shared by both sides.
struct Queue<T> {
    items: Watched<VecDeque<T>>,
    capacity: usize,
    dropped: AtomicU64,
}

/// The sending side, for callbacks. Never blocks: items that do not fit are dropped and counted.
pub struct InboxSender<T>(Arc<Queue<T>>);

impl<T> Clone for InboxSender<T> {
    fn clone(&self) -> InboxSender<T> {
        InboxSender(Arc::clone(&self.0))
    }
}

/// The receiving side.
pub struct Inbox<T>(Arc<Queue<T>>);

/// A queue for `capacity` items.
pub fn inbox<T>(capacity: usize) -> (InboxSender<T>, Inbox<T>) {
    let queue = Arc::new(Queue {
        items: Watched::new(VecDeque::new()),
        capacity,
        dropped: AtomicU64::new(0),
    });
    (InboxSender(Arc::clone(&queue)), Inbox(queue))
}

impl<T> InboxSender<T> {
    /// Enqueues `item`, or drops and counts it if the queue is full.
    pub fn put(&self, item: T) {
        let is_dropped = !self.offer(item);
        self.0
            .dropped
            .fetch_add(u64::from(is_dropped), Ordering::Relaxed);
    }

    /// Enqueues `item` if there is a free slot; returns whether there was one.
    pub fn offer(&self, item: T) -> bool {
        let Queue {
            items, capacity, ..
        } = &*self.0;
        let surplus = items.visit(|items| {
            // Drop the newest item, not the oldest: accepted items are processed in order, and a
            // flood loses its own messages.
            if items.len() >= *capacity {
                return Some(item);
            }
            items.push_back(item);
            None
        });
        surplus.is_none()
    }
}

impl<T> Inbox<T> {
    /// Waits up to `limit` for the next item.
    pub fn take(&self, limit: Duration) -> Option<T> {
        self.0.items.wait(limit, |items| !items.is_empty());
        self.take_now()
    }

    /// The next item, without waiting.
    pub fn take_now(&self) -> Option<T> {
        self.0.items.visit(VecDeque::pop_front)
    }

    /// The number of items dropped so far.
    pub fn dropped(&self) -> u64 {
        self.0.dropped.load(Ordering::Relaxed)
    }
}
