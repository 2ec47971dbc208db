//! The operator's end of a path: datagrams to a control port or a sim, and a permanently open
//! connection to a control port.

use super::datagram::{States, StopRequest, answered_number};
use super::datagram_port::DatagramPort;
use crate::gateway_port::ANSWER_BYTES_MAX;
use crate::token::{Answer, first};
use crate::{CurrentToken, clock, random_number, start_thread};
use messages::external::{GatewayCommand, OperatorReply};
use parking_lot::Mutex;
use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, Shutdown, SocketAddr, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Maximum number of requests awaiting an answer; the oldest are discarded first.
const AWAITED_MAX: usize = 128;
/// Connection timeout, and time until the next attempt.
const CONNECT_MAX: Duration = Duration::from_secs(3);
const CONNECT_AGAIN: Duration = Duration::from_millis(300);
/// Silence after which a connection is reopened; the status is requested every second.
const SILENT_MAX: Duration = Duration::from_secs(4);
/// Write timeout: a blocked peer must not delay a stop on other paths.
const WRITE_MAX: Duration = Duration::from_millis(20);

pub(super) enum PathNews {
    /// The path is open.
    Connected,
    /// The states of boats, in answer to a request.
    States(States, Asked),
}

/// An answered request.
#[derive(Clone, Copy)]
pub(super) struct Asked {
    /// The number of the stop to which it belongs; 0 for none.
    pub(super) stop: u64,
    /// When the request was sent.
    pub(super) at: Instant,
}

/// Receives news from a path.
pub(super) type OnNews = Arc<dyn Fn(PathNews) + Send + Sync>;

/// Datagrams to one address.
pub(super) struct DatagramPath {
    socket: UdpSocket,
    session: u64,
    game: Option<String>,
    sent: Arc<Mutex<Sent>>,
    port: DatagramPort,
}

/// Requests awaiting an answer.
#[derive(Default)]
struct Sent {
    number: u64,
    awaited: VecDeque<(StopRequest, Asked)>,
}

impl DatagramPath {
    pub(super) fn open(
        at: SocketAddr,
        game: Option<String>,
        token: CurrentToken,
        on_news: OnNews,
    ) -> io::Result<DatagramPath> {
        let any: IpAddr = if at.is_ipv4() {
            Ipv4Addr::UNSPECIFIED.into()
        } else {
            Ipv6Addr::UNSPECIFIED.into()
        };
        let socket = UdpSocket::bind((any, 0))?;
        // Accept datagrams only from this address.
        socket.connect(at)?;
        let sent = Arc::new(Mutex::new(Sent::default()));
        let answered = Arc::clone(&sent);
        let port = DatagramPort::open(socket.try_clone()?, "stop-answers", move |bytes| {
            let number = answered_number(bytes)?;
            let awaited = answered
                .lock()
                .awaited
                .iter()
                .find(|(request, _)| request.number == number)
                .cloned();
            let (request, asked) = awaited?;
            let states = request.read_answer(bytes, token.get().as_ref())?;
            on_news(PathNews::States(states, asked));
            None
        })?;
        Ok(DatagramPath {
            socket,
            session: random_number(),
            game,
            sent,
            port,
        })
    }

    /// Tells the thread to end; drop waits for it.
    pub(super) fn close(&self) {
        self.port.close();
    }

    /// Sends a request that belongs to this stop.
    pub(super) fn send(&self, command: &GatewayCommand, stop: u64) {
        let mut sent = self.sent.lock();
        sent.number += 1;
        let number = sent.number;
        let game = self.game.clone();
        let command = command.clone();
        let request = StopRequest {
            session: self.session,
            number,
            game,
            command,
        };
        let bytes = request.encode();
        sent.awaited.push_back((
            request,
            Asked {
                stop,
                at: clock::now(),
            },
        ));
        let surplus = sent.awaited.len().saturating_sub(AWAITED_MAX);
        sent.awaited.drain(..surplus);
        drop(sent);
        // Errors are ignored: the request is repeated, and sent on other paths.
        drop(self.socket.send(&bytes));
    }
}

/// A gateway's control port, over TCP and UDP at once.
pub(super) struct GatewayPath {
    /// The boat, once known.
    pub(super) vehicle: Arc<Mutex<Option<String>>>,
    pub(super) token: CurrentToken,
    datagrams: DatagramPath,
    connection: Arc<Connection>,
}

/// The open connection.
struct Connection {
    at: SocketAddr,
    open: Mutex<Option<Open>>,
    on_news: OnNews,
    is_closing: AtomicBool,
}

struct Open {
    stream: TcpStream,
    /// The requests awaiting an answer, in order.
    awaited: VecDeque<Asked>,
}

impl GatewayPath {
    /// Starts connecting to a port; `vehicle` is the gateway's boat, if known.
    pub(super) fn open(
        at: SocketAddr,
        vehicle: Option<String>,
        token: CurrentToken,
        on_news: OnNews,
    ) -> io::Result<GatewayPath> {
        let vehicle = Arc::new(Mutex::new(vehicle));
        let learnt = Arc::clone(&vehicle);
        let learn: OnNews = Arc::new(move |mut news| {
            if let PathNews::States(states, _) = &mut news {
                let mut vehicle = learnt.lock();
                let own = vehicle
                    .get_or_insert_with(|| states.keys().next().cloned().unwrap_or_default());
                // A gateway reports only its own boat.
                states.retain(|name, _| name == own);
            }
            on_news(news);
        });
        let datagrams = DatagramPath::open(at, None, token.clone(), Arc::clone(&learn))?;
        let connection = Connection {
            at,
            open: Mutex::default(),
            on_news: learn,
            is_closing: AtomicBool::new(false),
        };
        let connection = Arc::new(connection);
        let at_work = Arc::clone(&connection);
        start_thread("stop-connection", move || at_work.run())?;
        Ok(GatewayPath {
            vehicle,
            token,
            datagrams,
            connection,
        })
    }

    /// Tells the datagram thread to end. Drop waits for it, and tells the connection's
    /// thread to end.
    pub(super) fn close(&self) {
        self.datagrams.close();
    }

    /// Sends a command for this stop over both TCP and UDP.
    pub(super) fn send(&self, command: &GatewayCommand, stop: u64) {
        self.datagrams.send(command, stop);
        self.connection.send(command, stop);
    }
}

impl Drop for GatewayPath {
    fn drop(&mut self) {
        self.connection.is_closing.store(true, Ordering::SeqCst);
        self.connection.close();
    }
}

impl Connection {
    fn run(&self) {
        while !self.is_closing.load(Ordering::SeqCst) {
            if let Ok(stream) = TcpStream::connect_timeout(&self.at, CONNECT_MAX) {
                // However the connection ends, it is reopened.
                drop(self.read(stream));
                self.close();
            }
            clock::rest(CONNECT_AGAIN);
        }
    }

    fn read(&self, stream: TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(WRITE_MAX))?;
        stream.set_read_timeout(Some(SILENT_MAX))?;
        let mut reader = BufReader::new(stream.try_clone()?);
        *self.open.lock() = Some(Open {
            stream,
            awaited: VecDeque::new(),
        });
        (self.on_news)(PathNews::Connected);
        loop {
            let mut line = Vec::new();
            reader
                .by_ref()
                .take(ANSWER_BYTES_MAX)
                .read_until(b'\n', &mut line)?;
            let awaited = self
                .open
                .lock()
                .as_mut()
                .and_then(|open| open.awaited.pop_front());
            let Some(asked) = awaited.filter(|_| line.ends_with(b"\n")) else {
                return Ok(());
            };
            // This connection sends no proofs: requests that need the token use a separate
            // connection.
            match serde_json::from_slice(&line) {
                Ok(Answer::Answer(OperatorReply {
                    refused: None,
                    status,
                })) => {
                    (self.on_news)(PathNews::States(
                        States::from([(status.vehicle, (status.state, 0))]),
                        asked,
                    ));
                }
                // A refusal, as from a different boat's gateway, or a challenge, which this
                // connection does not answer.
                Ok(_) => {}
                Err(_) => return Ok(()),
            }
        }
    }

    fn send(&self, command: &GatewayCommand, stop: u64) {
        let mut line = first(command);
        line.push(b'\n');
        let mut open = self.open.lock();
        let Some(Open { stream, awaited }) = &mut *open else {
            return;
        };
        awaited.push_back(Asked {
            stop,
            at: clock::now(),
        });
        if awaited.len() > AWAITED_MAX || (&*stream).write_all(&line).is_err() {
            // The peer accepts no more data, and a partial line is invalid.
            drop(stream.shutdown(Shutdown::Both));
            *open = None;
        }
    }

    fn close(&self) {
        if let Some(Open { stream, .. }) = self.open.lock().take() {
            drop(stream.shutdown(Shutdown::Both));
        }
    }
}
