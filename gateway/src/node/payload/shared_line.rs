//! A payload on a serial line or UDP port, shared by its clients: each receives everything it
//! sends, and it receives what each of them sends.

use super::forward::{is_pause, prepare};
use super::passed_payload::{Payload, Talk};
use super::{ANSWER_PAUSE, CONNECT_MAX};
use crate::link::{BoatLink, Link, LinkAddress, LinkError, LinkEvent, LinkSettings};
use bus::{Slot, Watched, clock};
use parking_lot::Mutex;
use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::time::Duration;

/// Maximum bytes of a client written at once, so that the others get their turn: a quarter of a
/// second at 9600 baud.
const PIECE: usize = 256;
/// Maximum time to write them.
const WRITE_LIMIT: Duration = Duration::from_secs(2);
/// Maximum number of pieces that wait for a client that does not read.
const WAITING_MAX: usize = 64;
/// From the line to all clients.
const TO_ALL: u32 = 0;

/// The line.
pub(super) struct SharedLine {
    link: Link,
    /// One piece at a time: of two that wait, the link keeps only the newer.
    writing: Mutex<()>,
    ends: Arc<Ends>,
}

/// Both ends of it.
struct Ends {
    payload: Arc<Payload>,
    talk: Talk,
    is_up: Watched<bool>,
    clients: Mutex<Vec<Client>>,
}

struct Client {
    number: u32,
    pieces: SyncSender<Arc<[u8]>>,
    /// Closes it.
    stream: TcpStream,
}

impl SharedLine {
    pub(super) fn open(
        payload: &Arc<Payload>,
        address: &LinkAddress,
    ) -> Result<SharedLine, LinkError> {
        let (_, talk) = payload.open();
        let ends = Ends {
            payload: Arc::clone(payload),
            talk,
            is_up: Watched::new(false),
            clients: Mutex::default(),
        };
        let ends = Arc::new(ends);
        let settings = LinkSettings {
            silence: None,
            ..LinkSettings::default()
        };
        let theirs = Arc::clone(&ends);
        let link = Link::open(address, settings, move |event| theirs.handle_event(event))?;
        Ok(SharedLine {
            link,
            writing: Mutex::new(()),
            ends,
        })
    }

    /// Whether the line is up, or will be soon.
    pub(super) fn is_up(&self) -> bool {
        self.ends.is_up.wait(CONNECT_MAX, |is_up| *is_up)
    }

    /// Sends bytes to the payload after those of other senders; returns whether the line accepted
    /// them.
    pub(super) fn send(&self, connection: u32, bytes: &[u8]) -> bool {
        // A command of one client is written completely before the next one's begins.
        let _writing = self.writing.lock();
        self.ends
            .payload
            .record_bytes(&self.ends.talk, connection, true, bytes);
        self.link.send_and_wait(bytes, WRITE_LIMIT)
    }

    /// Serves a client until it or the line is lost.
    pub(super) fn serve(&self, slot: &Slot, stream: &TcpStream) {
        let payload = &self.ends.payload;
        let Some(_turn) = payload.turn.client() else {
            return;
        };
        if !self.is_up() {
            return payload.remark(&format!(
                "cannot connect a client to {}",
                payload.port.address
            ));
        }
        let (number, _) = payload.open();
        let (sender, pieces) = sync_channel(WAITING_MAX);
        match prepare(stream).and_then(|()| stream.try_clone()) {
            Ok(stream) => self.ends.clients.lock().push(Client {
                number,
                pieces: sender,
                stream,
            }),
            Err(_) => return,
        }
        std::thread::scope(|scope| {
            let thread = std::thread::Builder::new().name(format!("payload {}", payload.port.name));
            match thread.spawn_scoped(scope, move || write(stream, &pieces)) {
                Ok(_) => self.read(number, slot, stream),
                Err(e) => payload.remark(&format!("cannot start a thread for a client: {e}")),
            }
            // This also closes its queue, which ends the thread.
            self.ends
                .clients
                .lock()
                .retain(|client| client.number != number);
            drop(stream.shutdown(Shutdown::Both));
        });
    }

    /// Sends a client's bytes to the payload.
    fn read(&self, number: u32, slot: &Slot, mut stream: &TcpStream) {
        let mut piece = [0; PIECE];
        loop {
            match stream.read(&mut piece) {
                Ok(0) => {
                    self.ends.payload.record_end(&self.ends.talk, number, true);
                    // The answer may be on its way.
                    return clock::rest(ANSWER_PAUSE);
                }
                Ok(count) => {
                    slot.touch();
                    if !self.send(number, &piece[..count]) {
                        return self
                            .ends
                            .payload
                            .remark(&format!("the line accepted no data for {WRITE_LIMIT:?}"));
                    }
                }
                Err(e) if is_pause(&e) => {}
                Err(_) => return,
            }
        }
    }
}

impl Ends {
    fn handle_event(&self, event: LinkEvent) {
        match event {
            LinkEvent::Up { .. } => self.is_up.visit(|is_up| *is_up = true),
            LinkEvent::Bytes { bytes, .. } => {
                self.payload.record_bytes(&self.talk, TO_ALL, false, &bytes);
                self.give(&bytes.into());
            }
            LinkEvent::Down { reason, .. } | LinkEvent::Failed { reason, .. } => {
                self.is_up.visit(|is_up| *is_up = false);
                self.payload.remark(&reason);
                self.clients.lock().iter().for_each(Client::close);
            }
            LinkEvent::Written { .. } => {}
        }
    }

    /// Sends a piece to all clients; disconnects a client whose queue is full.
    fn give(&self, piece: &Arc<[u8]>) {
        for client in &*self.clients.lock() {
            // A client that does not read must not delay the others, nor make the gateway store
            // what it misses.
            if client.pieces.try_send(Arc::clone(piece)).is_err() {
                self.payload.remark("a client does not read: disconnected");
                client.close();
            }
        }
    }
}

impl Client {
    /// Its threads will notice.
    fn close(&self) {
        drop(self.stream.shutdown(Shutdown::Both));
    }
}

/// Writes queued bytes to a client.
fn write(mut stream: &TcpStream, pieces: &Receiver<Arc<[u8]>>) {
    let written: io::Result<()> = pieces.iter().try_for_each(|piece| stream.write_all(&piece));
    if written.is_err() {
        drop(stream.shutdown(Shutdown::Both));
    }
}
