//! The threads of one link, and their peers.

use super::interface::{LinkEvent, LinkSettings, OnPort};
use super::outbox::{Completion, Priority, WriteRequest};
use super::peer::{End, Peer};
use parking_lot::{Condvar, Mutex, MutexGuard};
use std::io;
use std::os::fd::BorrowedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Maximum number of peers per link.
pub(super) const PEERS_MAX: usize = 8;

/// State shared by all threads of a link.
pub(super) struct Threads {
    pub(super) settings: LinkSettings,
    on_event: Box<dyn Fn(LinkEvent) + Send + Sync>,
    on_port: Option<OnPort>,
    /// Peers that are up. Never locked while waiting.
    peers: Mutex<Vec<Arc<Peer>>>,
    numbers: AtomicU32,
    displaced: AtomicU64,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    stopped: bool,
    running: usize,
}

/// Counts a running thread until dropped.
struct RunningThread(Arc<Threads>);

impl Drop for RunningThread {
    fn drop(&mut self) {
        self.0.state.lock().running -= 1;
        self.0.changed.notify_all();
    }
}

impl Threads {
    pub(super) fn new(
        settings: LinkSettings,
        on_port: Option<OnPort>,
        on_event: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Arc<Threads> {
        Arc::new(Threads {
            settings,
            on_event: Box::new(on_event),
            on_port,
            peers: Mutex::default(),
            numbers: AtomicU32::new(0),
            displaced: AtomicU64::new(0),
            state: Mutex::default(),
            changed: Condvar::new(),
        })
    }

    pub(super) fn spawn(
        self: &Arc<Threads>,
        name: &str,
        work: impl FnOnce() + Send + 'static,
    ) -> io::Result<JoinHandle<()>> {
        // Count the thread before it starts, so that a link closing at this moment also waits for
        // it. If the spawn fails, dropping `running` undoes this.
        self.state.lock().running += 1;
        let running = RunningThread(Arc::clone(self));
        thread::Builder::new().name(name.to_owned()).spawn(move || {
            let _running = running;
            work();
        })
    }

    /// Reports the descriptor of a new connection, or the end of the connection.
    pub(super) fn tell_port(&self, descriptor: Option<BorrowedFd<'_>>) {
        if let Some(on_port) = &self.on_port {
            on_port(descriptor);
        }
    }

    /// Calls the callback. The caller must hold no lock, because the callback may call any
    /// function.
    pub(super) fn emit(&self, event: LinkEvent) {
        (self.on_event)(event);
    }

    /// A peer number that this link has never used.
    pub(super) fn number(&self) -> u32 {
        self.numbers.fetch_add(1, Ordering::Relaxed)
    }

    pub(super) fn add(&self, peer: &Arc<Peer>) {
        self.peers.lock().push(Arc::clone(peer));
    }

    pub(super) fn remove(&self, peer: &Peer) {
        self.peers
            .lock()
            .retain(|other| other.number != peer.number);
    }

    pub(super) fn count(&self) -> usize {
        self.peers.lock().len()
    }

    pub(super) fn enqueue(
        &self,
        bytes: Vec<u8>,
        tag: Option<u64>,
        priority: Priority,
    ) -> Arc<Completion> {
        let bytes = Arc::new(bytes);
        // Hold the lock to the end, so that all peers get messages in the same order.
        let peers = self.peers.lock();
        // Count only the current peers. A peer that connects later does not get this message, so
        // nothing may wait for it.
        let completion = Completion::new(tag, peers.len());
        let displaced = peers
            .iter()
            .filter(|peer| {
                peer.outbox
                    .push(WriteRequest::new(&bytes, &completion, priority))
            })
            .count();
        self.note_displaced(displaced as u64);
        completion
    }

    pub(super) fn note_displaced(&self, count: u64) {
        self.displaced.fetch_add(count, Ordering::Relaxed);
    }

    pub(super) fn displaced(&self) -> u64 {
        self.displaced.load(Ordering::Relaxed)
    }

    /// Ends all threads and waits for them, up to `limit`.
    pub(super) fn stop(&self, limit: Duration) {
        self.state.lock().stopped = true;
        self.changed.notify_all();
        for peer in self.peers.lock().iter() {
            peer.end(End::Stopped);
        }
        // A thread that is still running is blocked in its callback, and ends when that returns.
        drop(self.wait(limit, |state| state.running > 0));
    }

    pub(super) fn is_stopped(&self) -> bool {
        self.state.lock().stopped
    }

    /// Waits for this time or until the link is closed; returns whether it is closed.
    pub(super) fn stops_within(&self, limit: Duration) -> bool {
        self.wait(limit, |state| !state.stopped).stopped
    }

    fn wait(&self, limit: Duration, nothing_new: impl Fn(&State) -> bool) -> MutexGuard<'_, State> {
        let mut state = self.state.lock();
        self.changed
            .wait_while_for(&mut state, |state| nothing_new(state), limit);
        state
    }
}
