//! A bounded queue from zenoh's threads to a node's own.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::time::Duration;

/// The sending side, for callbacks. Never blocks: what does not fit is dropped and counted.
pub struct InboxSender<T> {
    sender: SyncSender<T>,
    dropped: Arc<AtomicU64>,
}

impl<T> Clone for InboxSender<T> {
    fn clone(&self) -> InboxSender<T> {
        InboxSender { sender: self.sender.clone(), dropped: Arc::clone(&self.dropped) }
    }
}

/// The receiving side.
pub struct Inbox<T> {
    receiver: Receiver<T>,
    dropped: Arc<AtomicU64>,
}

/// A queue for `capacity` items.
#[must_use]
pub fn inbox<T>(capacity: usize) -> (InboxSender<T>, Inbox<T>) {
    let (sender, receiver) = sync_channel(capacity);
    let dropped = Arc::new(AtomicU64::new(0));
    (InboxSender { sender, dropped: Arc::clone(&dropped) }, Inbox { receiver, dropped })
}

impl<T> InboxSender<T> {
    /// Hands `item` over.
    pub fn put(&self, item: T) {
        if let Err(TrySendError::Full(_)) = self.sender.try_send(item) {
            self.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl<T> Inbox<T> {
    /// The next item, if one comes within `limit`.
    pub fn take(&self, limit: Duration) -> Option<T> {
        self.receiver.recv_timeout(limit).ok()
    }

    /// The next item, if one is there.
    pub fn take_now(&self) -> Option<T> {
        self.receiver.try_recv().ok()
    }

    /// How many items did not fit so far.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}
