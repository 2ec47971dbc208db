//! One other side of a link, from up to down: a thread that reads, and one that writes.

use super::LinkEvent;
use super::clock;
use super::outbox::{Outbox, lock};
use super::port::{Heard, Port, TICK, Wrote};
use super::threads::Threads;
use std::fmt;
use std::io;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The most bytes that one event carries; a datagram fits.
pub(super) const CHUNK: usize = 64 * 1024;

/// Why a connection is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Our side wants a new one.
    Asked,
    /// Our side is closing down.
    Stopped,
    /// It broke.
    Lost(String),
}

/// The other side.
pub(super) struct Peer {
    pub(super) number: u32,
    pub(super) outbox: Outbox,
    port: Port,
    end: Mutex<Option<End>>,
}

/// A peer that is up; gone when dropped, said to be gone with [`Seat::leave`].
pub(super) struct Seat {
    crew: Arc<Threads>,
    pub(super) peer: Arc<Peer>,
    writer: Option<JoinHandle<()>>,
}

/// How a connection went.
pub(super) struct Served {
    pub(super) end: End,
    /// From up to the last bytes.
    pub(super) heard_for: Duration,
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            End::Asked => write!(f, "a reconnect was asked for"),
            End::Stopped => write!(f, "closed here"),
            End::Lost(reason) => write!(f, "{reason}"),
        }
    }
}

impl Peer {
    /// Ends it, for the first reason that was given.
    pub(super) fn end(&self, end: End) {
        lock(&self.end).get_or_insert(end);
        self.outbox.shut();
    }

    /// Whether and why it is to end.
    pub(super) fn is_to_end(&self) -> Option<End> {
        lock(&self.end).clone()
    }

    /// Writes what is handed over, until the end.
    fn write_on(&self, crew: &Threads) {
        while let Some(request) = self.outbox.next() {
            let (begun_at, transit) = (clock::now(), self.port.transit(request.bytes().len()));
            match self.port.write(request.bytes(), || self.is_over()) {
                Ok(Wrote::All) => {
                    let at = clock::now();
                    if let Some(tag) = request.take() {
                        crew.tell(LinkEvent::Written { tag, at });
                    }
                }
                Ok(Wrote::Dropped) => crew.note_displaced(1),
                Err(e) => self.end(End::Lost(format!("cannot write: {e}"))),
            }
            // What is handed over meanwhile can still be displaced here; in the driver it could not.
            while clock::since(begun_at) < transit && !self.is_over() {
                crew.rest(transit.saturating_sub(clock::since(begun_at)).min(TICK));
            }
        }
    }

    fn is_over(&self) -> bool {
        lock(&self.end).is_some()
    }
}

impl Seat {
    /// Makes a peer of a connection.
    pub(super) fn take(crew: &Arc<Threads>, port: Port, name: String) -> io::Result<Seat> {
        let peer = Peer { number: crew.number(), outbox: Outbox::new(), port, end: Mutex::new(None) };
        let mut seat = Seat { crew: Arc::clone(crew), peer: Arc::new(peer), writer: None };
        // First there, then said to be: who answers `Up` with bytes wants them to reach this peer. And only
        // then a writer, so that nothing is `Written` to a peer of which nobody has heard.
        crew.add(&seat.peer);
        crew.tell(LinkEvent::Up { peer: seat.peer.number, name });
        let (hand, peer) = (Arc::clone(crew), Arc::clone(&seat.peer));
        match crew.hire("link writer", move || peer.write_on(&hand)) {
            Ok(writer) => seat.writer = Some(writer),
            Err(e) => {
                seat.leave(&End::Lost(format!("no thread for it: {e}")));
                return Err(e);
            }
        }
        Ok(seat)
    }

    /// Reads to the end.
    pub(super) fn serve(self) -> Served {
        let up_at = clock::now();
        let mut heard_at = up_at;
        let end = self.read_on(&mut heard_at);
        self.leave(&end);
        Served { end, heard_for: heard_at.saturating_duration_since(up_at) }
    }

    fn read_on(&self, heard_at: &mut Instant) -> End {
        let mut buffer = vec![0; CHUNK];
        let silence = self.crew.settings.silence.filter(|_| self.peer.port.can_fall_silent());
        loop {
            if let Some(end) = self.peer.is_to_end() {
                return end;
            }
            // A peer that came up while all others were told to end was told nothing.
            if self.crew.is_stopped() {
                return End::Stopped;
            }
            match self.peer.port.read(&mut buffer) {
                Ok(Heard::Bytes(count)) => {
                    *heard_at = clock::now();
                    let bytes = buffer[..count].to_vec();
                    self.crew.tell(LinkEvent::Bytes { peer: self.peer.number, at: *heard_at, bytes });
                }
                Ok(Heard::Nothing) => {}
                Ok(Heard::End) => return End::Lost("closed by the other side".to_owned()),
                Err(e) => return End::Lost(format!("cannot read: {e}")),
            }
            if let Some(limit) = silence.filter(|limit| clock::since(*heard_at) >= *limit) {
                return End::Lost(format!("no bytes for {limit:?}"));
            }
            if let Err(e) = self.peer.port.freshen() {
                return End::Lost(format!("cannot flush: {e}"));
            }
        }
    }

    /// Ends it and says so.
    pub(super) fn leave(mut self, end: &End) {
        self.crew.remove(&self.peer);
        self.peer.end(end.clone());
        match end {
            End::Lost(_) => self.peer.port.reset(),
            End::Asked | End::Stopped => self.peer.port.finish(),
        }
        if let Some(writer) = self.writer.take() {
            // A writer that panicked is as done as one that did not.
            drop(writer.join());
        }
        self.crew.tell(LinkEvent::Down { peer: self.peer.number, reason: end.to_string() });
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.crew.remove(&self.peer);
        self.peer.end(End::Stopped);
    }
}
