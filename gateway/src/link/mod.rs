//! Byte links to boats and to back seats, each of which keeps itself up.
//!
//! A link is a few threads of its own: one that connects or accepts, and for every peer one that reads and
//! one that writes. They tell what happens through one callback and take what is to be written through
//! outboxes of depth one, so that a slow peer gets the newest command late rather than old ones in order.
//! Read `peer` first, then `client`, then `port`.

mod address;
mod backoff;
mod client;
mod clock;
mod outbox;
mod peer;
mod port;
mod pty;
mod tcp_server;
mod threads;
mod udp_server;

pub use address::{BAUDS, LinkAddress, LinkAddressError};

use outbox::Rank;
use std::io;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use thiserror::Error;
use threads::Threads;

/// The most peers that a link serves at once.
const PEERS_MAX: usize = 8;

/// How long a link that is dropped waits for its threads.
const GOODBYE: Duration = Duration::from_millis(190);

/// How patient a link is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSettings {
    /// No bytes for this long: the peer counts as gone, as one does that lost power. None: never, for the
    /// side that listens. A pseudo-terminal's peers may be silent, a UDP server's for 10 s at most.
    pub silence: Option<Duration>,
    /// The waits between attempts: the first, which then doubles, and the longest.
    pub retry: (Duration, Duration),
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        let retry = (Duration::from_millis(100), Duration::from_secs(5));
        LinkSettings { silence: Some(Duration::from_secs(3)), retry }
    }
}

/// What happens on a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkEvent {
    /// A peer is there. Peers are numbered from 0 and never again the same within a link's life.
    Up {
        /// Its number.
        peer: u32,
        /// Where it is: an address, or a device.
        name: String,
    },
    /// A peer said something.
    Bytes {
        /// Its number.
        peer: u32,
        /// When the read returned.
        at: Instant,
        /// What it said, whole lines or not, at most 64 KiB.
        bytes: Vec<u8>,
    },
    /// A peer is gone.
    Down {
        /// Its number.
        peer: u32,
        /// What happened.
        reason: String,
    },
    /// The other side could not be reached.
    Failed {
        /// What happened.
        reason: String,
        /// When it is tried again.
        again: Duration,
    },
    /// Everything handed over under this tag has been written, to all peers that were up then. Not said if
    /// there was none, or if one of them missed it.
    Written {
        /// The tag.
        tag: u64,
        /// When the system took the last of it.
        at: Instant,
    },
}

/// What will never work, so that a link does not even begin.
#[derive(Debug, Error)]
pub enum LinkError {
    /// The port cannot be listened on.
    #[error("cannot listen on {kind} port {port} of {host}: {reason}")]
    Listen {
        /// `TCP` or `UDP`.
        kind: &'static str,
        /// The host.
        host: String,
        /// The port.
        port: u16,
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

/// A link that keeps itself up, in threads of its own. Dropped, it closes everything within 200 ms: what
/// was written still arrives, what was only handed over is lost. For last words there is
/// [`Link::send_and_wait`].
pub struct Link {
    crew: Arc<Threads>,
    reach: String,
}

impl Link {
    /// Begins. `take` is told what happens, in several threads; while it waits, its link does.
    ///
    /// # Errors
    /// [`LinkError`] only for what will never work. A peer that is not there is [`LinkEvent::Failed`].
    pub fn open(
        address: &LinkAddress,
        settings: LinkSettings,
        take: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Result<Link, LinkError> {
        let crew = Threads::new(settings, take);
        let hand = Arc::clone(&crew);
        let (reach, work) = plan(hand, address)?;
        let failed = |source| LinkError::Thread { address: address.to_string(), source };
        drop(crew.hire("link", work).map_err(failed)?);
        Ok(Link { crew, reach })
    }

    /// The address that others can connect to, as in `tcp://127.0.0.1:8003`: with port 0 the real port, for
    /// a PTY the slave's path.
    #[must_use]
    pub fn reach(&self) -> String {
        self.reach.clone()
    }

    /// Hands bytes over to be written to all peers that are up; never blocks. What was handed over before
    /// and has not been begun is displaced, at each peer by itself.
    pub fn send(&self, bytes: Vec<u8>, tag: u64) {
        drop(self.crew.hand_over(bytes, Some(tag), Rank::Usual));
    }

    /// How many were displaced so far, summed over the peers.
    #[must_use]
    pub fn displaced(&self) -> u64 {
        self.crew.displaced()
    }

    /// Last words: displaces what is queued, writes these bytes to all peers, and waits for that up to
    /// `limit`. Whether there was somebody, and the system took them for everybody; what had not begun by
    /// then stays queued. They are not displaced by what other threads send meanwhile. Works while panicking.
    pub fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool {
        self.crew.hand_over(bytes.to_vec(), None, Rank::LastWords).wait(limit)
    }

    /// Breaks the connections now; a client connects again after the first wait.
    pub fn reconnect(&self) {
        self.crew.reconnect();
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        self.crew.stop(GOODBYE);
    }
}

/// Where others reach the link, and what keeps it up.
type Plan = (String, Box<dyn FnOnce() + Send>);

fn plan(crew: Arc<Threads>, address: &LinkAddress) -> Result<Plan, LinkError> {
    Ok(match address {
        LinkAddress::TcpServer { host, port } => {
            let (listener, at) = tcp_server::bind(host, *port)?;
            (reached("tcp", at), Box::new(move || tcp_server::keep(&crew, &listener)))
        }
        LinkAddress::UdpServer { host, port } => {
            let (socket, at) = udp_server::bind(host, *port)?;
            let socket = Arc::new(socket);
            (reached("udp", at), Box::new(move || udp_server::keep(&crew, &socket)))
        }
        LinkAddress::Pty { link } => {
            let pty = Arc::new(pty::Pty::open(link.as_deref())?);
            (pty.path().display().to_string(), Box::new(move || pty::keep(&crew, &pty)))
        }
        LinkAddress::Serial { path, baud } if !BAUDS.contains(baud) => {
            return Err(LinkError::Baud { path: path.clone(), baud: *baud });
        }
        LinkAddress::TcpClient { .. } | LinkAddress::UdpClient { .. } | LinkAddress::Serial { .. } => {
            let address = address.clone();
            (address.to_string(), Box::new(move || client::keep(&crew, &address)))
        }
    })
}

fn reached(scheme: &str, at: SocketAddr) -> String {
    format!("{scheme}://{at}")
}
