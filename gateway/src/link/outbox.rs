//! What waits to be written to one peer: never more than the newest.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// What may push aside what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rank {
    /// Makes room for the next.
    Usual,
    /// Nothing usual displaces it: a stop must not lose a race against a set point.
    LastWords,
}

/// Bytes for one peer. Dropped before it was taken, it is lost, and its completion knows.
pub(super) struct WriteRequest {
    bytes: Arc<Vec<u8>>,
    completion: Arc<Completion>,
    rank: Rank,
    taken: bool,
}

/// Who of all peers has taken the same bytes.
pub(super) struct Completion {
    tag: Option<u64>,
    count: Mutex<Count>,
    settled: Condvar,
}

struct Count {
    open: usize,
    lost: bool,
}

/// A queue of depth one.
pub(super) struct Outbox {
    state: Mutex<State>,
    news: Condvar,
}

#[derive(Default)]
struct State {
    queued: Option<WriteRequest>,
    shut: bool,
}

/// A count or a queue is whole whatever happened to the thread that changed it last; and last words are
/// said while a thread panics.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Completion {
    /// For bytes that go to so many peers.
    pub(super) fn new(tag: Option<u64>, peers: usize) -> Arc<Completion> {
        // What nobody is there to take is lost.
        let count = Mutex::new(Count { open: peers, lost: peers == 0 });
        Arc::new(Completion { tag, count, settled: Condvar::new() })
    }

    /// Waits up to `limit`; whether every peer took the bytes.
    pub(super) fn wait(&self, limit: Duration) -> bool {
        let guard = lock(&self.count);
        let open = |count: &mut Count| count.open > 0;
        let (count, _) = self.settled.wait_timeout_while(guard, limit, open).unwrap_or_else(PoisonError::into_inner);
        count.open == 0 && !count.lost
    }

    /// One peer less; whether it was the last, and none lost the bytes.
    fn settle(&self, lost: bool) -> bool {
        let mut count = lock(&self.count);
        count.open -= 1;
        count.lost |= lost;
        self.settled.notify_all();
        count.open == 0 && !count.lost
    }
}

impl WriteRequest {
    pub(super) fn new(bytes: &Arc<Vec<u8>>, completion: &Arc<Completion>, rank: Rank) -> WriteRequest {
        WriteRequest { bytes: Arc::clone(bytes), completion: Arc::clone(completion), rank, taken: false }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Notes that the peer took it; gives the tag once all did.
    pub(super) fn take(mut self) -> Option<u64> {
        self.taken = true;
        if self.completion.settle(false) { self.completion.tag } else { None }
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
        Outbox { state: Mutex::default(), news: Condvar::new() }
    }

    /// Queues a request; whether one had to go for it (the queued one, or this if last words are queued).
    pub(super) fn put(&self, request: WriteRequest) -> bool {
        let mut state = lock(&self.state);
        if state.shut {
            return false;
        }
        if request.rank == Rank::Usual && state.queued.as_ref().is_some_and(|queued| queued.rank == Rank::LastWords) {
            return true;
        }
        let displaced = state.queued.replace(request).is_some();
        self.news.notify_one();
        displaced
    }

    /// Waits for a request; none comes any more once it is shut.
    pub(super) fn next(&self) -> Option<WriteRequest> {
        let guard = lock(&self.state);
        let idle = |state: &mut State| state.queued.is_none() && !state.shut;
        let mut state = self.news.wait_while(guard, idle).unwrap_or_else(PoisonError::into_inner);
        state.queued.take()
    }

    /// Loses what is queued and takes nothing more.
    pub(super) fn shut(&self) {
        let mut state = lock(&self.state);
        state.shut = true;
        state.queued = None;
        self.news.notify_all();
    }
}
