//! A MOOSDB on a TCP port: threads and sockets around a [`Database`].
//!
//! Each client has a thread that reads and, unless the client is synchronous, one that writes. No
//! thread locks the database while it waits for a client: a client that does not read loses its
//! mail, then its connection.

use crate::clock::MoosClock;
use crate::database::{CLIENTS_MAX, Database};
use crate::mail::Mail;
use crate::wire::{self, Framer, Kind, Msg};
use bus::{Watched, clock, start_thread};
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// Time without a complete packet after which a client is dropped, as in MOOSDB.
const SILENCE: Duration = Duration::from_secs(5);
/// Time without accepting a byte after which a client is dropped.
const WRITE_MAX: Duration = Duration::from_secs(2);
/// Interval at which threads check whether they should end.
const LOOK_AGAIN: Duration = Duration::from_millis(500);

/// A database that accepts clients.
pub(crate) struct Server {
    shared: Shared,
    /// The address to which clients connect.
    pub(crate) address: SocketAddr,
    is_closed: Arc<AtomicBool>,
}

/// State shared by all threads of a server.
#[derive(Clone)]
struct Shared {
    database: Arc<Watched<Database>>,
    moos: MoosClock,
}

/// Counts a connection until dropped.
struct Connection(Arc<AtomicUsize>);

impl Drop for Connection {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Server {
    /// Starts to listen on this address.
    ///
    /// # Errors
    /// If the port is in use, or the system refuses the socket or the thread.
    pub(crate) fn open(
        address: SocketAddr,
        database: Database,
        moos: MoosClock,
    ) -> io::Result<Server> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let shared = Shared {
            database: Arc::new(Watched::new(database)),
            moos,
        };
        let is_closed = Arc::new(AtomicBool::new(false));
        let server = Server {
            shared: shared.clone(),
            address,
            is_closed: Arc::clone(&is_closed),
        };
        start_thread("moosdb", move || accept(&listener, &shared, &is_closed))?;
        Ok(server)
    }

    /// Reads or changes the database at the current MOOS time.
    pub(crate) fn visit<R>(&self, visit: impl FnOnce(&mut Database, f64) -> R) -> R {
        let now_s = self.shared.moos.now_s();
        self.shared
            .database
            .visit(|database| visit(database, now_s))
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.is_closed.store(true, Ordering::Relaxed);
        // This ends the wait for the next client; if the server cannot connect to itself, the
        // thread ends with the process.
        drop(TcpStream::connect_timeout(&self.address, LOOK_AGAIN));
    }
}

fn accept(listener: &TcpListener, shared: &Shared, is_closed: &Arc<AtomicBool>) {
    let connections = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming() {
        if is_closed.load(Ordering::Relaxed) {
            return;
        }
        let Ok(stream) = stream else {
            // For example, too many files are open: pause instead of retrying at once.
            clock::rest(LOOK_AGAIN);
            continue;
        };
        let connection = Connection(Arc::clone(&connections));
        if connections.fetch_add(1, Ordering::Relaxed) >= 2 * CLIENTS_MAX {
            shared
                .database
                .visit(|database| database.dropped.refused += 1);
            continue;
        }
        let shared = shared.clone();
        let is_closed = Arc::clone(is_closed);
        let serve = move || {
            let _connection = connection;
            serve(&shared, &stream, &is_closed);
            drop(stream.shutdown(Shutdown::Both));
        };
        // If the thread cannot start, the connection closes and the client tries again.
        drop(start_thread("moos client", serve));
    }
}

/// Serves a client until it leaves, stalls or sends something malformed.
fn serve(shared: &Shared, stream: &TcpStream, is_closed: &AtomicBool) {
    let Shared { database, moos } = shared;
    let set_up = stream
        .set_nodelay(true)
        .and_then(|()| stream.set_read_timeout(Some(LOOK_AGAIN)))
        .and_then(|()| stream.set_write_timeout(Some(WRITE_MAX)));
    let mut packets = Packets::new(stream, is_closed);
    let Some(hello) = set_up.ok().and_then(|()| packets.greeting()) else {
        database.visit(|database| database.dropped.malformed += 1);
        return;
    };
    let now_s = moos.now_s();
    let (welcome, mail) = match database.visit(|database| database.admit(&hello, now_s)) {
        Ok(admitted) => admitted,
        Err(reason) => {
            // If this fails, the client is already gone.
            let poison = Msg::text(Kind::POISON, "", &reason, now_s);
            drop((&mut &*stream).write_all(&wire::packet_of(&[poison])));
            return;
        }
    };
    let name = hello.as_text().unwrap_or_default().trim().to_owned();
    let is_asynchronous = hello.key == wire::ASYNCHRONOUS;
    if (&mut &*stream)
        .write_all(&wire::packet_of(&[welcome]))
        .is_ok()
    {
        let writer = is_asynchronous
            .then(|| start_writer(stream, &mail, database))
            .transpose();
        if writer.is_ok() {
            read(shared, &mut packets, (&name, &mail, is_asynchronous));
        }
    }
    let end = packets.end;
    let now_s = moos.now_s();
    database.visit(|database| {
        database.remove(&name, now_s);
        database.dropped.stalled += u64::from(end == End::Stalled);
        database.dropped.malformed += u64::from(end == End::Malformed);
    });
}

/// Processes a client's packets.
fn read(
    shared: &Shared,
    packets: &mut Packets<'_>,
    (name, mail, is_asynchronous): (&str, &Watched<Mail>, bool),
) {
    let Shared { database, moos } = shared;
    while let Some(messages) = packets.next_packet() {
        let now_s = moos.now_s();
        let timing = database.visit(|database| database.receive(name, messages, now_s));
        if is_asynchronous {
            if timing.is_some() {
                mail.visit(|mail| mail.timing = timing);
            }
            continue;
        }
        // A synchronous client waits for exactly one packet, which must begin with the time.
        let null = Msg::number(Kind::NULL, "", moos.now_s(), now_s);
        let answer = mail.visit(|mail| mail.take_packet(Some(&null)));
        if (&mut &*packets.stream)
            .write_all(&answer.unwrap_or_default())
            .is_err()
        {
            packets.end = End::Stalled;
            return;
        }
    }
}

/// Starts the thread that writes a client's mail.
fn start_writer(
    stream: &TcpStream,
    mail: &Arc<Watched<Mail>>,
    database: &Arc<Watched<Database>>,
) -> io::Result<()> {
    let mut stream = stream.try_clone()?;
    let mail = Arc::clone(mail);
    let database = Arc::clone(database);
    start_thread("moos mail", move || {
        loop {
            mail.wait(LOOK_AGAIN, |mail| {
                !mail.messages.is_empty() || mail.timing.is_some() || mail.is_closed
            });
            let (packet, is_closed) = mail.visit(|mail| {
                let timing = mail.timing.take();
                (mail.take_packet(timing.as_ref()), mail.is_closed)
            });
            if is_closed {
                return;
            }
            if packet.is_some_and(|packet| stream.write_all(&packet).is_err()) {
                // Do not count the client if the reading thread has already done so.
                let is_counted = mail.visit(|mail| mail.is_closed);
                database.visit(|database| database.dropped.stalled += u64::from(!is_counted));
                // This ends the reading thread too.
                drop(stream.shutdown(Shutdown::Both));
                return;
            }
        }
    })
}

/// Why a connection has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    /// The peer has left, or this side is closing the connection.
    Closed,
    /// The peer was silent, or did not read.
    Stalled,
    /// The peer sent bytes that do not form a packet.
    Malformed,
}

/// The packets from a socket with a read timeout.
pub(crate) struct Packets<'a> {
    pub(crate) stream: &'a TcpStream,
    framer: Framer,
    is_closed: &'a AtomicBool,
    /// Why there are no more packets.
    pub(crate) end: End,
}

impl<'a> Packets<'a> {
    pub(crate) fn new(stream: &'a TcpStream, is_closed: &'a AtomicBool) -> Packets<'a> {
        Packets {
            stream,
            framer: Framer::default(),
            is_closed,
            end: End::Closed,
        }
    }

    /// The handshake message of a client; `None` if the peer is not a MOOS client.
    fn greeting(&mut self) -> Option<Msg> {
        let mut greeting = [0; wire::GREETING.len()];
        let mut length = 0;
        let start = clock::now();
        while length < greeting.len() {
            length += self.read_some(&mut greeting[length..])?;
            // A trickle of single bytes must not extend the timeout.
            if clock::since(start) > SILENCE {
                return None;
            }
        }
        let hello = if greeting == wire::GREETING {
            self.next_packet()?
        } else {
            return None;
        };
        hello
            .into_iter()
            .next()
            .filter(|msg| msg.kind == Kind::DATA)
    }

    /// The messages of the next packet; `None` at the end of the connection.
    pub(crate) fn next_packet(&mut self) -> Option<Vec<Msg>> {
        let start = clock::now();
        let mut bytes = [0; 16 << 10];
        loop {
            match self.framer.next_packet() {
                Ok(None) => {}
                Ok(packet) => return packet,
                Err(_) => {
                    self.end = End::Malformed;
                    return None;
                }
            }
            let length = self.read_some(&mut bytes)?;
            self.framer.push(&bytes[..length]);
            if clock::since(start) > SILENCE {
                self.end = End::Stalled;
                return None;
            }
        }
    }

    /// The number of bytes read; 0 after a timeout, `None` at the end of the connection.
    fn read_some(&mut self, bytes: &mut [u8]) -> Option<usize> {
        if self.is_closed.load(Ordering::Relaxed) {
            return None;
        }
        match (&mut &*self.stream).read(bytes) {
            Ok(0) => None,
            Ok(length) => Some(length),
            Err(error) => {
                let is_timeout = matches!(
                    error.kind(),
                    io::ErrorKind::WouldBlock
                        | io::ErrorKind::TimedOut
                        | io::ErrorKind::Interrupted
                );
                is_timeout.then_some(0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::DataType;
    use std::collections::BTreeSet;
    use std::time::Instant;

    const MOOS: MoosClock = MoosClock { warp: 4.0 };
    /// Limit on every wait in a test.
    const LIMIT: Duration = Duration::from_secs(20);

    fn server() -> Server {
        let database = Database::new("blue_one", BTreeSet::new(), MOOS.now_s());
        Server::open("127.0.0.1:0".parse().unwrap(), database, MOOS).unwrap()
    }

    /// A stand-in for a client, after its handshake with this key.
    struct Peer(TcpStream, Framer);

    impl Peer {
        fn connect(server: &Server, name: &str, key: &str) -> Peer {
            let mut peer = Peer(
                TcpStream::connect(server.address).unwrap(),
                Framer::default(),
            );
            peer.0.set_read_timeout(Some(LIMIT)).unwrap();
            peer.0.write_all(&wire::GREETING).unwrap();
            peer.send(&[Msg::text(Kind::DATA, key, name, MOOS.now_s())]);
            let welcome = peer.next_packet().unwrap();
            assert_eq!(
                (welcome[0].kind, welcome[0].community.as_str()),
                (Kind::WELCOME, "blue_one")
            );
            peer
        }

        fn send(&mut self, messages: &[Msg]) {
            self.0.write_all(&wire::packet_of(messages)).unwrap();
        }

        /// The next packet; `None` if the server closes the connection.
        fn next_packet(&mut self) -> Option<Vec<Msg>> {
            loop {
                if let Some(packet) = self.1.next_packet().unwrap() {
                    return Some(packet);
                }
                let mut bytes = [0; 4096];
                let length = self.0.read(&mut bytes).unwrap_or(0);
                self.1.push(&bytes[..length]);
                if length == 0 {
                    return None;
                }
            }
        }
    }

    fn wait_for(start: Instant, what: &str, mut holds: impl FnMut() -> bool) {
        while !holds() {
            assert!(clock::since(start) < LIMIT, "{what}");
            clock::rest(Duration::from_millis(5));
        }
    }

    #[test]
    fn asynchronous_clients_get_mail_at_once_and_synchronous_ones_a_packet_for_a_packet() {
        let server = server();
        let mut helm = Peer::connect(&server, "pHelmIvP", wire::ASYNCHRONOUS);
        let mut viewer = Peer::connect(&server, "pymoos2", "");
        let sent_s = MOOS.now_s();
        helm.send(&[Msg::number(Kind::TIMING, "_async_timing", 0.0, sent_s)]);
        let timing = helm.next_packet().unwrap().remove(0);
        assert_eq!((timing.kind, timing.time_s), (Kind::TIMING, sent_s));
        assert!(
            (timing.number - sent_s).abs() < 4.0 * LIMIT.as_secs_f64(),
            "{timing:?}"
        );
        let register = Msg::number(Kind::REGISTER, "NAV_X", 0.0, sent_s);
        viewer.send(&[register.clone(), Msg::number(Kind::NULL, "", 0.0, sent_s)]);
        let null = viewer.next_packet().unwrap();
        assert_eq!(
            (null.len(), null[0].kind, null[0].data),
            (1, Kind::NULL, DataType::Double)
        );
        helm.send(&[register, Msg::number(Kind::NOTIFY, "NAV_X", 7.0, sent_s)]);
        let mail = helm.next_packet().unwrap();
        assert_eq!(
            (
                mail[0].key.as_str(),
                mail[0].number,
                mail[0].source.as_str()
            ),
            ("NAV_X", 7.0, "pHelmIvP")
        );
        viewer.send(&[Msg::number(Kind::NULL, "", 0.0, sent_s)]);
        let kinds: Vec<Kind> = viewer
            .next_packet()
            .unwrap()
            .iter()
            .map(|msg| msg.kind)
            .collect();
        assert_eq!(kinds, [Kind::NULL, Kind::NOTIFY]);
        drop(helm);
        wait_for(
            clock::now(),
            "a name is free again after its client has left",
            || {
                server.visit(|database, now_s| {
                    let admitted = database
                        .admit(&Msg::text(Kind::DATA, "", "pHelmIvP", now_s), now_s)
                        .is_ok();
                    database.remove(if admitted { "pHelmIvP" } else { "" }, now_s);
                    admitted
                })
            },
        );
    }

    #[test]
    fn clients_that_send_garbage_or_read_nothing_harm_nobody() {
        let server = server();
        let mut stranger = Peer(
            TcpStream::connect(server.address).unwrap(),
            Framer::default(),
        );
        stranger
            .0
            .write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n")
            .unwrap();
        assert_eq!(stranger.next_packet(), None, "no MOOS client");
        let mut liar = Peer::connect(&server, "pLiar", wire::ASYNCHRONOUS);
        liar.0.write_all(&i32::MAX.to_le_bytes()).unwrap();
        liar.0.write_all(&[0; 32]).unwrap();
        assert_eq!(liar.next_packet(), None, "a packet of 2 GiB");
        let mut deaf = Peer::connect(&server, "pDeaf", wire::ASYNCHRONOUS);
        let mut other = Peer::connect(&server, "pOther", wire::ASYNCHRONOUS);
        deaf.send(&[Msg::text(
            Kind::WILDCARD,
            "pDeaf",
            "AppPattern=*,VarPattern=*,Interval=0",
            MOOS.now_s(),
        )]);
        other.send(&[Msg::number(Kind::REGISTER, "COUNT", 0.0, MOOS.now_s())]);
        let start = clock::now();
        let mut count = 0.0;
        // Until the unresponsive client is dropped, each value reaches the other client.
        wait_for(start, "the deaf client is dropped", || {
            count += 1.0;
            server.visit(|database, now_s| {
                database.notify(
                    Msg::text(Kind::NOTIFY, "IMAGE", &"x".repeat(200_000), now_s),
                    now_s,
                );
                database.notify(Msg::number(Kind::NOTIFY, "COUNT", count, now_s), now_s);
            });
            let got = other.next_packet().unwrap();
            assert!(got.iter().any(|msg| msg.number == count), "{got:?}");
            other.send(&[Msg::number(Kind::NULL, "", 0.0, MOOS.now_s())]);
            server.visit(|database, _| database.dropped.stalled) == 1
        });
        let dropped = server.visit(|database, _| database.dropped);
        assert!(dropped.malformed == 2 && dropped.unread > 0, "{dropped:?}");
    }
}
