//! Byte links to boats and back seats that reconnect automatically.
//!
//! A link runs a few threads: one that connects or accepts, and for each peer one that reads and one that writes.
//! They report events through one callback. Write requests go through outboxes of depth one, so that a slow peer
//! gets the newest command late instead of old ones in order.
//! Read `connection` first, then `client`, then `port`.

mod address;
mod backoff;
mod client;
mod clock;
mod connection;
mod outbox;
mod peer;
mod port;
mod pty;
mod pty_server;
mod tcp_server;
mod threads;
mod udp_server;

pub use address::{BAUDS, HostPort, LinkAddress, LinkAddressError, Side};

use outbox::Priority;
use std::io;
use std::net::SocketAddr;
use std::os::fd::BorrowedFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;
use threads::Threads;

/// Maximum number of peers per link.
const PEERS_MAX: usize = 8;

/// How long dropping a link waits for its threads.
// Several ticks of 25 ms in which threads notice, and a graceful close of 80 ms.
const CLOSE_MAX: Duration = Duration::from_millis(190);

/// The timeouts of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSettings {
    /// Without bytes for this long, a peer counts as lost. `None`, for the side that listens, means never. The peer of a
    /// pseudo-terminal may stay silent; a peer of a UDP server for at most 10 s.
    pub silence: Option<Duration>,
    /// The wait before the second attempt; doubles each time.
    pub retry_first: Duration,
    /// Maximum wait between attempts.
    pub retry_max: Duration,
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        LinkSettings {
            // A boat sends at least once a second. TCP alone notices a pulled cable after minutes; UDP and
            // serial lines never do.
            silence: Some(Duration::from_secs(3)),
            retry_first: Duration::from_millis(100),
            // No longer back-off, because an E-stop may be waiting for the connection.
            retry_max: Duration::from_secs(1),
        }
    }
}

/// An event of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkEvent {
    /// A peer has connected. Peers are numbered from 0; a link never reuses a number.
    Up {
        /// The peer's number.
        peer: u32,
        /// The peer's address or device.
        name: String,
    },
    /// A peer has sent bytes.
    Bytes {
        /// The peer's number.
        peer: u32,
        /// When the read returned.
        at: Instant,
        /// The bytes, whether whole lines or not; at most 64 KiB.
        bytes: Vec<u8>,
    },
    /// A peer is lost.
    Down {
        /// The peer's number.
        peer: u32,
        /// Why it was lost.
        reason: String,
    },
    /// The peer cannot be reached.
    Failed {
        /// The cause.
        reason: String,
        /// Time until the next attempt.
        retry_in: Duration,
    },
    /// Everything sent with this tag has been written to all peers that were up at the time. Not emitted if there were
    /// none, or if one of them missed it.
    Written {
        /// The tag.
        tag: u64,
        /// When the system accepted the last byte.
        at: Instant,
    },
}

/// Why a link cannot be opened.
#[derive(Debug, Error)]
pub enum LinkError {
    /// Cannot listen on the port.
    #[error("cannot listen on {kind} port {} of {}: {reason}", at.port, at.host)]
    Listen {
        /// `TCP` or `UDP`.
        kind: &'static str,
        /// The port.
        at: HostPort,
        /// The system's error.
        reason: String,
    },
    /// The serial line does not support this speed.
    #[error("{path}: baud is {baud}, allowed: {BAUDS:?}")]
    Baud {
        /// The device.
        path: PathBuf,
        /// The requested speed.
        baud: u32,
    },
    /// No pseudo-terminal available.
    #[error("cannot open a pseudo-terminal: {reason}")]
    Pty {
        /// The system's error.
        reason: String,
    },
    /// Cannot create the symlink to the pseudo-terminal.
    #[error("cannot make the symlink {path}: {reason}")]
    Symlink {
        /// The path of the symlink.
        path: PathBuf,
        /// The cause.
        reason: String,
    },
    /// No thread available.
    #[error("cannot start a thread for {address}: {source}")]
    Thread {
        /// The link's address.
        address: String,
        /// The system's error.
        source: io::Error,
    },
}

/// A gateway's connection to its boat.
pub trait BoatLink {
    /// Queues bytes without blocking. Displaces queued bytes whose write has not begun.
    fn send(&self, bytes: Vec<u8>, tag: u64);

    /// Like [`BoatLink::send`], for a command that stops the boat: discards earlier commands that wait in a stalled line,
    /// where possible.
    fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        self.send(bytes, tag);
    }

    /// The number of displaced writes so far.
    fn displaced(&self) -> u64;

    /// Sends a shutdown message; see [`Link::send_and_wait`].
    fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool;
}

/// Called with the descriptor of every connection before its use, and with `None` after its end.
pub type OnPort = Box<dyn Fn(Option<BorrowedFd<'_>>) + Send + Sync>;

/// A link that reconnects automatically, on its own threads. Dropping it closes everything within 200 ms: written
/// bytes still arrive, queued ones are lost. To send a shutdown message, use [`Link::send_and_wait`].
pub struct Link {
    threads: Arc<Threads>,
    reach: String,
}

impl Link {
    /// Opens a link. Several threads call `on_event`; while it blocks, so does the link.
    ///
    /// # Errors
    /// [`LinkError`] if the link can never work. An unreachable peer is [`LinkEvent::Failed`].
    pub fn open(
        address: &LinkAddress,
        settings: LinkSettings,
        on_event: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Result<Link, LinkError> {
        Link::open_watched(address, settings, None, on_event)
    }

    /// Like [`Link::open`]. `on_port` may duplicate the descriptors, to write to them when this process cannot.
    ///
    /// # Errors
    /// As for [`Link::open`].
    pub fn open_watched(
        address: &LinkAddress,
        settings: LinkSettings,
        on_port: Option<OnPort>,
        on_event: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Result<Link, LinkError> {
        let threads = Threads::new(settings, on_port, on_event);
        let (reach, work) = prepare(Arc::clone(&threads), address)?;
        let failed = |source| LinkError::Thread { address: address.to_string(), source };
        drop(threads.spawn("link", work).map_err(failed)?);
        Ok(Link { threads, reach })
    }

    /// The address to connect to, such as `tcp://127.0.0.1:8003`: with the real port instead of 0, or a PTY slave's
    /// path.
    #[must_use]
    pub fn reach(&self) -> String {
        self.reach.clone()
    }

    /// Queues bytes for all peers without blocking. For each peer, displaces queued bytes whose write has not begun.
    pub fn send(&self, bytes: Vec<u8>, tag: u64) {
        // Never wait here: if the boat does not read, the next command displaces this one.
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Normal));
    }

    /// Like [`Link::send`], for a command that stops the boat: discards what a serial line still holds of earlier commands.
    pub fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Stop));
    }

    /// The number of displaced writes so far, over all peers.
    #[must_use]
    pub fn displaced(&self) -> u64 {
        self.threads.displaced()
    }

    /// Sends a shutdown message: displaces what is queued, writes these bytes to all peers, and waits up to `limit`.
    /// Returns whether there was a peer and the system accepted the bytes for all of them. Bytes whose write has not
    /// begun by then stay queued. Other threads' bytes do not displace them. Works while panicking.
    pub fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool {
        self.threads.enqueue(bytes.to_vec(), None, Priority::Shutdown).wait(limit)
    }

    /// Breaks all connections; a client reconnects after the first wait.
    pub fn reconnect(&self) {
        self.threads.reconnect();
    }
}

impl BoatLink for Link {
    fn send(&self, bytes: Vec<u8>, tag: u64) {
        Link::send(self, bytes, tag);
    }

    fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        Link::send_stop(self, bytes, tag);
    }

    fn displaced(&self) -> u64 {
        Link::displaced(self)
    }

    fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool {
        Link::send_and_wait(self, bytes, limit)
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.threads.stop(CLOSE_MAX);
    }
}

/// The work of a link's first thread.
type Work = Box<dyn FnOnce() + Send>;

/// Returns the address at which others reach the link, and the work of its first thread.
fn prepare(threads: Arc<Threads>, address: &LinkAddress) -> Result<(String, Work), LinkError> {
    Ok(match address {
        LinkAddress::Tcp(Side::Listens, at) => {
            let (listener, at) = tcp_server::bind(at)?;
            (reached("tcp", at), Box::new(move || tcp_server::run(&threads, &listener)))
        }
        LinkAddress::Udp(Side::Listens, at) => {
            let (socket, at) = udp_server::bind(at)?;
            let socket = Arc::new(socket);
            (reached("udp", at), Box::new(move || udp_server::run(&threads, &socket)))
        }
        LinkAddress::Pty { link } => {
            let pty = Arc::new(pty::Pty::open(link.as_deref())?);
            (pty.path().display().to_string(), Box::new(move || pty_server::run(&threads, &pty)))
        }
        LinkAddress::Serial { path, baud } if !BAUDS.contains(baud) => {
            return Err(LinkError::Baud { path: path.clone(), baud: *baud });
        }
        LinkAddress::Tcp(..) | LinkAddress::Udp(..) | LinkAddress::UdpListen(_) | LinkAddress::Serial { .. } => {
            let address = address.clone();
            (address.to_string(), Box::new(move || client::run(&threads, &address)))
        }
    })
}

fn listening<T>(
    kind: &'static str,
    at: &HostPort,
    bound: impl FnOnce((&str, u16)) -> io::Result<T>,
) -> Result<T, LinkError> {
    bound((&at.host, at.port)).map_err(|e| LinkError::Listen { kind, at: at.clone(), reason: e.to_string() })
}

fn reached(scheme: &str, at: SocketAddr) -> String {
    format!("{scheme}://{at}")
}
