//! One connection to a peer, from up to down, with a reading and a writing thread.

use super::clock::{self, TICK};
use super::interface::LinkEvent;
use super::outbox::Priority;
use super::peer::{End, Peer};
use super::port::{Port, Received, Wrote};
use super::threads::Threads;
use std::io;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Maximum bytes per event; a datagram fits.
pub(super) const CHUNK: usize = 64 * 1024;

/// A serial adapter forwards bytes within this time.
const SETTLED: Duration = Duration::from_millis(30);

/// An open connection to a peer. Dropping it closes it; [`Connection::close`] also emits
/// [`LinkEvent::Down`].
pub(super) struct Connection {
    threads: Arc<Threads>,
    pub(super) peer: Arc<Peer>,
    writer: Option<JoinHandle<()>>,
}

impl Connection {
    /// Opens a connection over a port.
    pub(super) fn open(threads: &Arc<Threads>, port: Port, name: String) -> io::Result<Connection> {
        let peer = Arc::new(Peer::new(threads.number(), port));
        let mut connection = Connection {
            threads: Arc::clone(threads),
            peer,
            writer: None,
        };
        // Add the peer before `Up` is announced, so that bytes sent in response to `Up` reach this
        // peer. The writer starts last, so that no `Written` precedes `Up`.
        threads.tell_port(connection.peer.port.descriptor());
        threads.add(&connection.peer);
        threads.emit(LinkEvent::Up {
            peer: connection.peer.number,
            name,
        });
        let shared = Arc::clone(threads);
        let peer = Arc::clone(&connection.peer);
        match threads.spawn("link writer", move || write_on(&peer, &shared)) {
            Ok(writer) => connection.writer = Some(writer),
            Err(e) => {
                connection.close(&End::Lost(format!("cannot start a thread: {e}")));
                return Err(e);
            }
        }
        Ok(connection)
    }

    /// Reads until the connection ends; returns the time between coming up and the last bytes
    /// received.
    pub(super) fn serve(self) -> Duration {
        let up_at = clock::now();
        let mut received_at = up_at;
        let end = self.read_on(&mut received_at);
        self.close(&end);
        received_at.saturating_duration_since(up_at)
    }

    fn read_on(&self, received_at: &mut Instant) -> End {
        let mut buffer = vec![0; CHUNK];
        // A pseudo-terminal may have no other user for hours, which is not a fault.
        let silence = self
            .threads
            .settings
            .silence
            .filter(|_| self.peer.port.can_fall_silent());
        loop {
            if let Some(end) = self.peer.is_to_end() {
                return end;
            }
            // `Threads::stop` ends only the peers that it finds, so a peer that has just come up
            // checks here.
            if self.threads.is_stopped() {
                return End::Stopped;
            }
            match self.peer.port.read(&mut buffer) {
                Ok(Received::Bytes(count)) => {
                    *received_at = clock::now();
                    let bytes = buffer[..count].to_vec();
                    self.threads.emit(LinkEvent::Bytes {
                        peer: self.peer.number,
                        at: *received_at,
                        bytes,
                    });
                }
                Ok(Received::Nothing) => {}
                Ok(Received::End) => return End::Lost("closed by the other side".to_owned()),
                Err(e) => return End::Lost(format!("cannot read: {e}")),
            }
            if let Some(limit) = silence.filter(|limit| clock::since(*received_at) >= *limit) {
                return End::Lost(format!("no bytes for {limit:?}"));
            }
            if let Err(e) = self.peer.port.flush_if_stale() {
                return End::Lost(format!("cannot flush: {e}"));
            }
        }
    }

    /// Closes the connection and emits `Down`.
    pub(super) fn close(mut self, end: &End) {
        self.threads.remove(&self.peer);
        self.peer.end(end.clone());
        match end {
            // Bytes still queued on a lost connection are outdated commands.
            End::Lost(_) => self.peer.port.reset(),
            End::Stopped => self.peer.port.finish(),
        }
        self.threads.tell_port(None);
        if let Some(writer) = self.writer.take() {
            // A writer that panicked has also ended.
            drop(writer.join());
        }
        self.threads.emit(LinkEvent::Down {
            peer: self.peer.number,
            reason: end.to_string(),
        });
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.threads.remove(&self.peer);
        self.peer.end(End::Stopped);
    }
}

/// Writes queued bytes until the connection ends.
fn write_on(peer: &Peer, threads: &Threads) {
    let mut settled_at = clock::now();
    while let Some(request) = peer.outbox.next() {
        // Earlier bytes should have been sent long ago; if any are left, the line has stalled.
        if request.priority() != Priority::Normal && clock::since(settled_at) >= SETTLED {
            peer.port.discard_unsent();
        }
        let begun_at = clock::now();
        let transit = peer.port.transit(request.bytes().len());
        match peer
            .port
            .write(request.bytes(), || peer.is_to_end().is_some())
        {
            Ok(Wrote::All) => {
                let at = clock::now();
                // Report the write after the system has accepted the last byte, to measure the
                // latency of orders.
                if let Some(tag) = request.settle() {
                    threads.emit(LinkEvent::Written { tag, at });
                }
            }
            Ok(Wrote::Dropped) => threads.note_displaced(1),
            Err(e) => peer.end(End::Lost(format!("cannot write: {e}"))),
        }
        // Wait: bytes queued meanwhile can be displaced in the outbox, but not in the driver.
        while clock::since(begun_at) < transit && peer.is_to_end().is_none() {
            threads.stops_within(transit.saturating_sub(clock::since(begun_at)).min(TICK));
        }
        settled_at = clock::now();
    }
}
