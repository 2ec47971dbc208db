//! Byte links to boats and to back seats; each reconnects by itself.
//!
//! A link is a few threads of its own: one that connects or accepts, and for every peer one that reads and
//! one that writes. They report events through one callback and take write requests from outboxes of depth
//! one, so that a slow peer gets the newest command late rather than old ones in order.
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

/// The most peers that a link serves at once.
const PEERS_MAX: usize = 8;

/// How long dropping a link waits for its threads.
// Several ticks of 25 ms for threads to notice, and the graceful close of 80 ms.
const CLOSE_MAX: Duration = Duration::from_millis(190);

/// The timeouts of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSettings {
    /// After this long without bytes a peer counts as gone, as one that lost power. `None` is never, for the
    /// side that listens. A pseudo-terminal's peers may be silent; a UDP server's for 10 s at most.
    pub silence: Option<Duration>,
    /// The wait before the second attempt; it doubles with each.
    pub retry_first: Duration,
    /// The longest wait between attempts.
    pub retry_max: Duration,
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        LinkSettings {
            // A boat sends at least once a second. TCP alone notices a pulled cable after
            // minutes, UDP and serial lines never.
            silence: Some(Duration::from_secs(3)),
            retry_first: Duration::from_millis(100),
            // An E-stop may be waiting for the connection: no longer back-off.
            retry_max: Duration::from_secs(1),
        }
    }
}

/// An event of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkEvent {
    /// A peer is there. Peers are numbered from 0 and never again the same within a link's life.
    Up {
        /// Its number.
        peer: u32,
        /// Where it is: an address, or a device.
        name: String,
    },
    /// A peer sent something.
    Bytes {
        /// Its number.
        peer: u32,
        /// When the read returned.
        at: Instant,
        /// What it sent, whole lines or not, at most 64 KiB.
        bytes: Vec<u8>,
    },
    /// A peer is gone.
    Down {
        /// Its number.
        peer: u32,
        /// What happened.
        reason: String,
    },
    /// The peer could not be reached.
    Failed {
        /// What happened.
        reason: String,
        /// When it is tried again.
        retry_in: Duration,
    },
    /// Everything sent under this tag has been written, to all peers that were up then. Not emitted if there was
    /// none, or if one of them missed it.
    Written {
        /// The tag.
        tag: u64,
        /// When the system took the last of it.
        at: Instant,
    },
}

/// Why a link cannot be opened at all.
#[derive(Debug, Error)]
pub enum LinkError {
    /// The port cannot be listened on.
    #[error("cannot listen on {kind} port {} of {}: {reason}", at.port, at.host)]
    Listen {
        /// `TCP` or `UDP`.
        kind: &'static str,
        /// The port.
        at: HostPort,
        /// What the system says.
        reason: String,
    },
    /// A serial line does not have this speed.
    #[error("{path}: baud is {baud}, allowed: {BAUDS:?}")]
    Baud {
        /// The device.
        path: PathBuf,
        /// What was asked for.
        baud: u32,
    },
    /// There is no pseudo-terminal to be had.
    #[error("cannot open a pseudo-terminal: {reason}")]
    Pty {
        /// What the system says.
        reason: String,
    },
    /// The symlink to a pseudo-terminal cannot be made.
    #[error("cannot make the symlink {path}: {reason}")]
    Symlink {
        /// Where it was wanted.
        path: PathBuf,
        /// What is in the way.
        reason: String,
    },
    /// There is no thread to be had.
    #[error("cannot start a thread for {address}: {source}")]
    Thread {
        /// The link.
        address: String,
        /// What the system says.
        source: io::Error,
    },
}

/// The way of a gateway's bytes to its boat.
pub trait BoatLink {
    /// Queues bytes; never blocks. What was queued before and has not been begun is displaced.
    fn send(&self, bytes: Vec<u8>, tag: u64);

    /// As [`BoatLink::send`], for a command that stops the boat: earlier commands that still wait in a line that has stalled
    /// are discarded as far as possible.
    fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        self.send(bytes, tag);
    }

    /// How many were displaced so far.
    fn displaced(&self) -> u64;

    /// Sends a shutdown message, as [`Link::send_and_wait`] does.
    fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool;
}

/// Called with the descriptor of every connection before it is used, and with nothing when it is over.
pub type OnPort = Box<dyn Fn(Option<BorrowedFd<'_>>) + Send + Sync>;

/// A link that reconnects by itself, in threads of its own. Dropped, it closes everything within 200 ms: what
/// was written still arrives, what was only queued is lost. A shutdown message is sent with
/// [`Link::send_and_wait`].
pub struct Link {
    threads: Arc<Threads>,
    reach: String,
}

impl Link {
    /// Opens a link. `on_event` is called in several threads; while it waits, its link does.
    ///
    /// # Errors
    /// [`LinkError`] only for what will never work. A peer that is not there is [`LinkEvent::Failed`].
    pub fn open(
        address: &LinkAddress,
        settings: LinkSettings,
        on_event: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Result<Link, LinkError> {
        Link::open_watched(address, settings, None, on_event)
    }

    /// As [`Link::open`]; `on_port` may duplicate the descriptors, to write to them when this process cannot.
    ///
    /// # Errors
    /// [`LinkError`], as there.
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

    /// The address that others can connect to, as in `tcp://127.0.0.1:8003`: with port 0 the real port, for
    /// a PTY the slave's path.
    #[must_use]
    pub fn reach(&self) -> String {
        self.reach.clone()
    }

    /// Queues bytes for all peers that are up; never blocks. What was queued before and has not been begun is
    /// displaced, at each peer separately.
    pub fn send(&self, bytes: Vec<u8>, tag: u64) {
        // Nobody waits here: if the boat does not read, the next command takes the place of
        // this one.
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Normal));
    }

    /// As [`Link::send`], for a command that stops the boat: what a serial line still holds of earlier ones is discarded.
    pub fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Stop));
    }

    /// How many were displaced so far, summed over the peers.
    #[must_use]
    pub fn displaced(&self) -> u64 {
        self.threads.displaced()
    }

    /// Sends a shutdown message: displaces what is queued, writes these bytes to all peers, and waits for that up to
    /// `limit`. Returns whether there was a peer, and the system took the bytes for all of them; what had not begun by
    /// then stays queued. They are not displaced by what other threads send meanwhile. Works while panicking.
    pub fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool {
        self.threads.enqueue(bytes.to_vec(), None, Priority::Shutdown).wait(limit)
    }

    /// Breaks the connections now; a client connects again after the first wait.
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

/// What a link's first thread does.
type Work = Box<dyn FnOnce() + Send>;

/// The address at which others reach the link, and what its first thread does.
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

/// What `bound` has taken, and its address.
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
