//! The threads of one link, with the peers they serve.

use super::outbox::{Completion, Rank, WriteRequest, lock};
use super::peer::{End, Peer};
use super::{LinkEvent, LinkSettings};
use std::io;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// What all threads of a link share.
pub(super) struct Threads {
    pub(super) settings: LinkSettings,
    take: Box<dyn Fn(LinkEvent) + Send + Sync>,
    /// Those that are up. Never held while anything waits.
    peers: Mutex<Vec<Arc<Peer>>>,
    numbers: AtomicU32,
    displaced: AtomicU64,
    watch: Mutex<Watch>,
    changed: Condvar,
}

#[derive(Default)]
struct Watch {
    stopped: bool,
    reconnects: u64,
    hands: usize,
}

/// Why a pause ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Woken {
    /// It was long enough.
    Rested,
    /// Somebody asked for a reconnect.
    Asked,
    /// The link is closed.
    Stopped,
}

/// A thread at work, until dropped.
struct Shift(Arc<Threads>);

impl Drop for Shift {
    fn drop(&mut self) {
        lock(&self.0.watch).hands -= 1;
        self.0.changed.notify_all();
    }
}

impl Threads {
    pub(super) fn new(settings: LinkSettings, take: impl Fn(LinkEvent) + Send + Sync + 'static) -> Arc<Threads> {
        Arc::new(Threads {
            settings,
            take: Box::new(take),
            peers: Mutex::default(),
            numbers: AtomicU32::new(0),
            displaced: AtomicU64::new(0),
            watch: Mutex::default(),
            changed: Condvar::new(),
        })
    }

    /// Starts a thread.
    pub(super) fn hire(
        self: &Arc<Threads>,
        name: &str,
        work: impl FnOnce() + Send + 'static,
    ) -> io::Result<JoinHandle<()>> {
        lock(&self.watch).hands += 1;
        let shift = Shift(Arc::clone(self));
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            let _shift = shift;
            work();
        })
    }

    /// Tells what happened. Never with a lock held: who listens may do as they like.
    pub(super) fn tell(&self, event: LinkEvent) {
        (self.take)(event);
    }

    /// A number that no peer has had.
    pub(super) fn number(&self) -> u32 {
        self.numbers.fetch_add(1, Ordering::Relaxed)
    }

    pub(super) fn add(&self, peer: &Arc<Peer>) {
        lock(&self.peers).push(Arc::clone(peer));
    }

    pub(super) fn remove(&self, peer: &Peer) {
        lock(&self.peers).retain(|other| other.number != peer.number);
    }

    pub(super) fn count(&self) -> usize {
        lock(&self.peers).len()
    }

    /// Queues bytes for all peers.
    pub(super) fn hand_over(&self, bytes: Vec<u8>, tag: Option<u64>, rank: Rank) -> Arc<Completion> {
        let bytes = Arc::new(bytes);
        // Held to the end, so that all peers see the same order.
        let peers = lock(&self.peers);
        let completion = Completion::new(tag, peers.len());
        let displaced =
            peers.iter().filter(|peer| peer.outbox.put(WriteRequest::new(&bytes, &completion, rank))).count();
        self.note_displaced(displaced as u64);
        completion
    }

    pub(super) fn note_displaced(&self, count: u64) {
        self.displaced.fetch_add(count, Ordering::Relaxed);
    }

    pub(super) fn displaced(&self) -> u64 {
        self.displaced.load(Ordering::Relaxed)
    }

    /// Breaks all connections.
    pub(super) fn reconnect(&self) {
        lock(&self.watch).reconnects += 1;
        self.changed.notify_all();
        self.end_all(&End::Asked);
    }

    /// Ends all threads; waits for them up to `limit`.
    pub(super) fn stop(&self, limit: Duration) {
        lock(&self.watch).stopped = true;
        self.changed.notify_all();
        self.end_all(&End::Stopped);
        // Whoever is not back by then hangs in what it tells, and ends after that.
        drop(self.wait(limit, |watch| watch.hands > 0));
    }

    pub(super) fn is_stopped(&self) -> bool {
        lock(&self.watch).stopped
    }

    /// How often a reconnect was asked for.
    pub(super) fn reconnects(&self) -> u64 {
        lock(&self.watch).reconnects
    }

    /// Waits this long, unless the link is closed.
    pub(super) fn rest(&self, limit: Duration) -> Woken {
        if self.wait(limit, |watch| !watch.stopped).stopped { Woken::Stopped } else { Woken::Rested }
    }

    /// As [`Threads::rest`], unless a reconnect is asked for, or was since `seen`, which is then brought up to date.
    pub(super) fn pause(&self, limit: Duration, seen: &mut u64) -> Woken {
        let watch = self.wait(limit, |watch| !watch.stopped && watch.reconnects == *seen);
        if watch.stopped {
            return Woken::Stopped;
        }
        let before = std::mem::replace(seen, watch.reconnects);
        if before == *seen { Woken::Rested } else { Woken::Asked }
    }

    fn wait(&self, limit: Duration, nothing_new: impl Fn(&Watch) -> bool) -> MutexGuard<'_, Watch> {
        let waited = self.changed.wait_timeout_while(lock(&self.watch), limit, |watch| nothing_new(watch));
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    fn end_all(&self, end: &End) {
        for peer in lock(&self.peers).iter() {
            peer.end(end.clone());
        }
    }
}
