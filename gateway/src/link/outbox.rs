//! The outbox of a peer: a queue of depth one, where a new write request displaces the previous
//! one.

use parking_lot::{Condvar, Mutex};
use std::sync::Arc;
use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Priority {
    /// Displaced by any later request.
    Normal,
    /// Like normal, but first discards bytes of earlier requests that the system still holds.
    Stop,
    /// Displaced only by another shutdown message: the final stop must not lose the race against a
    /// set-point.
    Shutdown,
}

/// Bytes to write to one peer. If the request is dropped before they are written, its completion
/// counts them as lost.
pub(super) struct WriteRequest {
    bytes: Arc<Vec<u8>>,
    completion: Arc<Completion>,
    priority: Priority,
    taken: bool,
}

/// Tracks whether all peers have accepted the same bytes.
pub(super) struct Completion {
    tag: Option<u64>,
    count: Mutex<Count>,
    changed: Condvar,
}

struct Count {
    open: usize,
    lost: bool,
}

/// A queue of depth one.
pub(super) struct Outbox {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    queued: Option<WriteRequest>,
    shut: bool,
}

impl Completion {
    /// A completion for bytes that go to this many peers.
    pub(super) fn new(tag: Option<u64>, peers: usize) -> Arc<Completion> {
        // Without peers, the bytes are lost.
        let count = Mutex::new(Count {
            open: peers,
            lost: peers == 0,
        });
        Arc::new(Completion {
            tag,
            count,
            changed: Condvar::new(),
        })
    }

    /// Waits up to `limit`. Returns whether every peer accepted the bytes.
    pub(super) fn wait(&self, limit: Duration) -> bool {
        let mut count = self.count.lock();
        self.changed
            .wait_while_for(&mut count, |count| count.open > 0, limit);
        count.open == 0 && !count.lost
    }

    /// Counts down one peer. Returns whether it was the last one and no peer lost the bytes.
    fn settle(&self, lost: bool) -> bool {
        let mut count = self.count.lock();
        count.open -= 1;
        count.lost |= lost;
        self.changed.notify_all();
        count.open == 0 && !count.lost
    }
}

impl WriteRequest {
    pub(super) fn new(
        bytes: &Arc<Vec<u8>>,
        completion: &Arc<Completion>,
        priority: Priority,
    ) -> WriteRequest {
        WriteRequest {
            bytes: Arc::clone(bytes),
            completion: Arc::clone(completion),
            priority,
            taken: false,
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn priority(&self) -> Priority {
        self.priority
    }

    /// Notes that the peer accepted the bytes. Returns the tag if all peers have accepted them.
    pub(super) fn settle(mut self) -> Option<u64> {
        self.taken = true;
        if self.completion.settle(false) {
            self.completion.tag
        } else {
            None
        }
    }
}

impl Drop for WriteRequest {
    fn drop(&mut self) {
        if !self.taken {
            self.completion.settle(true);
        }
    }
}

impl Outbox {
    pub(super) fn new() -> Outbox {
        Outbox {
            state: Mutex::default(),
            changed: Condvar::new(),
        }
    }

    /// Queues a request. Returns whether a request was displaced, either the queued one or this one
    /// (by a shutdown message).
    pub(super) fn push(&self, request: WriteRequest) -> bool {
        let mut state = self.state.lock();
        if state.shut {
            return false;
        }
        if request.priority != Priority::Shutdown
            && state
                .queued
                .as_ref()
                .is_some_and(|queued| queued.priority == Priority::Shutdown)
        {
            // Nothing may displace a boat's final message.
            return true;
        }
        // Depth one: a slow line gets the newest command late instead of all old ones in order.
        let displaced = state.queued.replace(request).is_some();
        self.changed.notify_one();
        displaced
    }

    /// Waits for a request. Returns `None` once the outbox is shut.
    pub(super) fn next(&self) -> Option<WriteRequest> {
        let mut state = self.state.lock();
        self.changed
            .wait_while(&mut state, |state| state.queued.is_none() && !state.shut);
        state.queued.take()
    }

    /// Drops the queued request and rejects all later requests.
    pub(super) fn shut(&self) {
        let mut state = self.state.lock();
        state.shut = true;
        state.queued = None;
        self.changed.notify_all();
    }
}
