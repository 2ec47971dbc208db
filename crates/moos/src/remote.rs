//! A client of an existing MOOSDB that reconnects automatically.

use crate::clock::MoosClock;
use crate::database::Dropped;
use crate::mail::Mail;
use crate::server::{End, Packets};
use crate::wire::{self, Kind, Msg};
use bus::{Watched, clock, start_thread};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The name of the bridge among the clients.
const NAME: &str = "squall_bridge";
/// Maximum time to connect, and to write.
const CONNECT_MAX: Duration = Duration::from_secs(2);
/// Pause between two attempts to connect, and maximum time to wait for bytes.
const RETRY: Duration = Duration::from_millis(500);
/// Interval of clock comparisons, which also keep the connection alive.
const TIMING: Duration = Duration::from_secs(1);

/// The state that the connection's threads share with the bridge.
#[derive(Default)]
struct State {
    /// The newest value of each variable, until the bridge has read it.
    heard: BTreeMap<String, Msg>,
    notes: Vec<String>,
    is_connected: bool,
    dropped: Dropped,
}

/// A connection to a MOOSDB, or the attempts to open one.
pub(crate) struct Remote {
    state: Arc<Watched<State>>,
    mail: Arc<Watched<Mail>>,
    is_closed: Arc<AtomicBool>,
}

impl Remote {
    /// Starts to connect to `address`, such as `localhost:9001`, and to read these variables.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub(crate) fn open(
        address: &str,
        reads: BTreeSet<String>,
        moos: MoosClock,
    ) -> io::Result<Remote> {
        let remote = Remote {
            state: Arc::default(),
            mail: Arc::default(),
            is_closed: Arc::default(),
        };
        let link = Link {
            state: Arc::clone(&remote.state),
            mail: Arc::clone(&remote.mail),
            is_closed: Arc::clone(&remote.is_closed),
            address: address.to_owned(),
            reads,
            moos,
        };
        start_thread("moos link", move || link.keep_connected())?;
        Ok(remote)
    }

    /// Queues a message. Without a connection, the message is dropped, because newer values will
    /// replace it.
    pub(crate) fn publish(&self, msg: &Msg) {
        if self.state.visit(|state| state.is_connected) {
            let mut encoded = Vec::new();
            wire::encode(
                &Msg {
                    source: NAME.to_owned(),
                    ..msg.clone()
                },
                &mut encoded,
            );
            let displaced = self.mail.visit(|mail| mail.push(&encoded.into()));
            self.state.visit(|state| state.dropped.unread += displaced);
        }
    }

    /// Receives a value published by the bridge itself, which the database does not send back.
    pub(crate) fn hear(&self, msg: Msg) {
        self.state.visit(|state| wire::keep(&mut state.heard, msg));
    }

    /// The values and notes since the last call, and whether the database is connected.
    pub(crate) fn take_heard(&self) -> (Vec<Msg>, Vec<String>, bool) {
        self.state.visit(|state| {
            let heard = std::mem::take(&mut state.heard).into_values().collect();
            (heard, std::mem::take(&mut state.notes), state.is_connected)
        })
    }

    /// Whether a value of one of these variables is waiting for the bridge, and whether the
    /// database is connected.
    pub(crate) fn presence(&self, names: &[&str]) -> (bool, bool) {
        self.state.visit(|state| {
            let has = |name: &&str| state.heard.contains_key(*name);
            (names.iter().any(has), state.is_connected)
        })
    }

    /// The messages and connections dropped so far.
    pub(crate) fn dropped(&self) -> Dropped {
        self.state.visit(|state| state.dropped)
    }
}

impl Drop for Remote {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Relaxed);
        self.mail.visit(|mail| mail.is_closed = true);
    }
}

/// The thread that connects and reads.
struct Link {
    state: Arc<Watched<State>>,
    mail: Arc<Watched<Mail>>,
    is_closed: Arc<AtomicBool>,
    address: String,
    reads: BTreeSet<String>,
    moos: MoosClock,
}

impl Link {
    fn keep_connected(&self) {
        let mut told = String::new();
        while !self.is_closed.load(Ordering::Relaxed) {
            let problem = self.connect().and_then(|stream| {
                let ended = self.converse(&stream);
                drop(stream.shutdown(Shutdown::Both));
                ended
            });
            let was_connected = self
                .state
                .visit(|state| std::mem::take(&mut state.is_connected));
            if let Err(problem) = problem
                && (was_connected || problem != told)
            {
                self.state.visit(|state| {
                    state
                        .notes
                        .push(format!("MOOSDB at {}: {problem}", self.address))
                });
                told = problem;
            }
            clock::rest(RETRY);
        }
    }

    /// Connects and sends the handshake.
    fn connect(&self) -> Result<TcpStream, String> {
        let mut addresses = self.address.to_socket_addrs().map_err(|e| e.to_string())?;
        let address = addresses.next().ok_or("the host name has no address")?;
        let stream =
            TcpStream::connect_timeout(&address, CONNECT_MAX).map_err(|e| e.to_string())?;
        let set_up = stream
            .set_nodelay(true)
            .and_then(|()| stream.set_read_timeout(Some(RETRY)))
            .and_then(|()| stream.set_write_timeout(Some(CONNECT_MAX)));
        let hello = Msg::text(Kind::DATA, wire::ASYNCHRONOUS, NAME, self.moos.now_s());
        let greeting = [wire::GREETING.to_vec(), wire::packet_of(&[hello])].concat();
        set_up
            .and_then(|()| (&stream).write_all(&greeting))
            .map_err(|e| e.to_string())?;
        Ok(stream)
    }

    /// Completes the handshake, subscribes, and reads until the connection ends. Returns why it
    /// ended.
    fn converse(&self, stream: &TcpStream) -> Result<(), String> {
        let mut packets = Packets::new(stream, &self.is_closed);
        let answer = packets
            .next_packet()
            .and_then(|packet| packet.into_iter().next());
        match answer {
            Some(msg) if msg.kind == Kind::WELCOME => {}
            Some(msg) if msg.kind == Kind::POISON => {
                return Err(format!(
                    "it rejected {NAME}: {}",
                    msg.as_text().unwrap_or("without a reason")
                ));
            }
            _ => return Err("it does not respond like a MOOSDB".to_owned()),
        }
        let registers = self
            .reads
            .iter()
            .map(|key| Msg::number(Kind::REGISTER, key, 0.0, self.moos.now_s()));
        let registers: Vec<Msg> = registers
            .map(|msg| Msg {
                source: NAME.to_owned(),
                ..msg
            })
            .collect();
        (&mut &*stream)
            .write_all(&wire::packet_of(&registers))
            .map_err(|e| e.to_string())?;
        self.mail.visit(|mail| *mail = Mail::default());
        self.state.visit(|state| state.is_connected = true);
        let writer = stream
            .try_clone()
            .and_then(|stream| self.start_writer(stream));
        writer.map_err(|e| e.to_string())?;
        while let Some(messages) = packets.next_packet() {
            self.state.visit(|state| state.keep(messages, &self.reads));
        }
        self.state.visit(|state| {
            state.dropped.stalled += u64::from(packets.end == End::Stalled);
            state.dropped.malformed += u64::from(packets.end == End::Malformed);
        });
        Err(match packets.end {
            End::Closed => "the connection has ended",
            End::Stalled => "it is silent",
            End::Malformed => "it sent a malformed packet",
        }
        .to_owned())
    }

    /// Starts the thread that writes mail and clock comparisons until the connection ends.
    fn start_writer(&self, mut stream: TcpStream) -> io::Result<()> {
        let mail = Arc::clone(&self.mail);
        let state = Arc::clone(&self.state);
        let moos = self.moos;
        start_thread("moos mail", move || {
            let mut timed = clock::now();
            while state.visit(|state| state.is_connected) {
                mail.wait(TIMING / 2, |mail| {
                    !mail.messages.is_empty() || mail.is_closed
                });
                let now_s = moos.now_s();
                let is_due = clock::since(timed) >= TIMING;
                let timing = is_due.then(|| Msg::number(Kind::TIMING, "_async_timing", 0.0, now_s));
                timed = if is_due { clock::now() } else { timed };
                let packet = mail.visit(|mail| mail.take_packet(timing.as_ref()));
                if packet.is_some_and(|packet| stream.write_all(&packet).is_err()) {
                    // This ends the reading thread too.
                    drop(stream.shutdown(Shutdown::Both));
                    return;
                }
            }
        })
    }
}

impl State {
    /// Stores values of other applications.
    fn keep(&mut self, messages: Vec<Msg>, reads: &BTreeSet<String>) {
        for msg in messages
            .into_iter()
            .filter(|msg| msg.kind == Kind::NOTIFY && msg.source != NAME)
        {
            if reads.contains(&msg.key) {
                wire::keep(&mut self.heard, msg);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::database::Database;
    use crate::server::Server;
    use std::net::SocketAddr;

    const MOOS: MoosClock = MoosClock { warp: 1.0 };

    fn reads() -> BTreeSet<String> {
        BTreeSet::from(["DEPLOY".to_owned(), "NAV_X".to_owned()])
    }

    fn server(address: SocketAddr) -> Server {
        Server::open(
            address,
            Database::new("blue_one", reads(), MOOS.now_s()),
            MOOS,
        )
        .unwrap()
    }

    /// The keys received by the client and the server, once each has received one.
    fn exchange(remote: &Remote, server: &Server) -> [String; 2] {
        let mut heard = [String::new(), String::new()];
        let start = clock::now();
        while heard.iter().any(String::is_empty) {
            assert!(clock::since(start) < Duration::from_secs(20), "{heard:?}");
            server.visit(|database, now_s| {
                database.notify(Msg::text(Kind::NOTIFY, "DEPLOY", "true", now_s), now_s);
            });
            remote.publish(&Msg::number(Kind::NOTIFY, "NAV_X", 1.0, MOOS.now_s()));
            let at_remote = remote.take_heard().0.pop();
            let at_server = server.visit(|database, _| database.take_heard().0.pop());
            for (heard, msg) in heard.iter_mut().zip([at_remote, at_server]) {
                msg.into_iter().for_each(|msg| *heard = msg.key);
            }
            clock::rest(Duration::from_millis(10));
        }
        heard
    }

    #[test]
    fn values_cross_both_ways_and_again_after_the_database_was_restarted() {
        let first = server("127.0.0.1:0".parse().unwrap());
        let address = first.address;
        let remote = Remote::open(&address.to_string(), reads(), MOOS).unwrap();
        assert_eq!(exchange(&remote, &first), ["DEPLOY", "NAV_X"]);
        drop(first);
        let start = clock::now();
        while remote.take_heard().2 {
            assert!(
                clock::since(start) < Duration::from_secs(20),
                "the loss is noticed"
            );
            clock::rest(Duration::from_millis(10));
        }
        let second = server(address);
        assert_eq!(exchange(&remote, &second), ["DEPLOY", "NAV_X"]);
    }
}
