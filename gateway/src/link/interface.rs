//! The parts of a link that its users see: settings, events and errors.

use super::address::HostPort;
use std::io;
use std::os::fd::BorrowedFd;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use thiserror::Error;

/// The timeouts of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LinkSettings {
    /// Time without bytes after which a peer counts as lost; `None` means never. Whatever this
    /// value, the peer of a pseudo-terminal may stay silent forever, and a peer of a UDP server for
    /// at most 10 s.
    pub silence: Option<Duration>,
    /// The wait before the second attempt; it then doubles each time.
    pub retry_first: Duration,
    /// Maximum wait between attempts.
    pub retry_max: Duration,
}

impl Default for LinkSettings {
    fn default() -> LinkSettings {
        LinkSettings {
            // A boat sends at least once a second. TCP alone notices a pulled cable only after
            // minutes; UDP and serial lines never do.
            silence: Some(Duration::from_secs(3)),
            retry_first: Duration::from_millis(100),
            // Waits must not be longer: an E-stop may be waiting for the connection.
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
        /// The bytes, at most 64 KiB; not necessarily whole lines.
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
    /// Everything sent with this tag has been written to all peers that were up at the time. Not
    /// emitted if there were no peers, or if one of them did not accept all bytes.
    Written {
        /// The tag.
        tag: u64,
        /// When the system accepted the last byte.
        at: Instant,
    },
}

/// A reason why a link cannot be opened.
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
    /// No pseudo-terminal available.
    #[error("cannot open a pseudo-terminal: {reason}")]
    Pty {
        /// The system's error.
        reason: String,
    },
    /// Cannot create the symlink to the pseudo-terminal.
    #[error("cannot create the symlink {path}: {reason}")]
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
    /// Queues bytes for all peers without blocking. For each peer, displaces queued bytes whose
    /// write has not begun.
    fn send(&self, bytes: Vec<u8>, tag: u64);

    /// Like [`BoatLink::send`], for a command that stops the boat. Where possible, it discards
    /// earlier commands that wait in a stalled line.
    fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        self.send(bytes, tag);
    }

    /// The number of displaced writes so far, over all peers.
    fn displaced(&self) -> u64;

    /// Sends a shutdown message: displaces queued bytes, writes these bytes to all peers, and waits
    /// up to `limit`. Returns whether there was a peer and the system accepted the bytes for all of
    /// them. Bytes whose write has not begun by then stay queued. Other threads' bytes do not
    /// displace them. May be called during a panic.
    fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool;
}

/// Called with the descriptor of every connection before its use, and with `None` after its end.
pub type OnPort = Box<dyn Fn(Option<BorrowedFd<'_>>) + Send + Sync>;
