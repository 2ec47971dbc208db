//! Byte links to boats and back seats that reconnect automatically.
//!
//! A link runs a few threads: one that connects or accepts, and for each peer one reader and one
//! writer. They report events through one callback. Write requests go through outboxes of depth
//! one, so that a slow peer gets the newest command late instead of old ones in order. Read
//! `connection` first, then `client`, then `port`.

mod address;
mod backoff;
mod client;
mod clock;
mod connection;
mod interface;
mod outbox;
mod peer;
mod port;
mod pty;
mod pty_server;
mod tcp_server;
mod threads;
mod udp_server;

pub use address::{HostPort, LinkAddress, LinkAddressError, Side};
pub use interface::{BoatLink, LinkError, LinkEvent, LinkSettings, OnPort};

use outbox::Priority;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use threads::Threads;

/// Maximum wait for the threads of a dropped link.
// A few ticks of 25 ms for threads to notice, and a graceful close of 80 ms.
const CLOSE_MAX: Duration = Duration::from_millis(190);

/// A link that reconnects automatically, on its own threads. Dropping it closes everything within
/// 200 ms: written bytes still arrive, but queued bytes are lost. To send a shutdown message, use
/// [`BoatLink::send_and_wait`].
pub struct Link {
    threads: Arc<Threads>,
    reach: String,
}

impl Link {
    /// Opens a link. Several threads call `on_event`; while it blocks, so does the link.
    ///
    /// # Errors
    /// [`LinkError`] if the link can never work. An unreachable peer causes [`LinkEvent::Failed`].
    pub fn open(
        address: &LinkAddress,
        settings: LinkSettings,
        on_event: impl Fn(LinkEvent) + Send + Sync + 'static,
    ) -> Result<Link, LinkError> {
        Link::open_watched(address, settings, None, on_event)
    }

    /// Like [`Link::open`]. `on_port` may duplicate the descriptors, so that another process can
    /// write to them when this one cannot.
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
        let failed = |source| LinkError::Thread {
            address: address.to_string(),
            source,
        };
        drop(threads.spawn("link", work).map_err(failed)?);
        Ok(Link { threads, reach })
    }

    /// The address to connect to, such as `tcp://127.0.0.1:8003`: with the real port instead of 0,
    /// or a PTY slave's path.
    pub fn reach(&self) -> String {
        self.reach.clone()
    }
}

impl BoatLink for Link {
    fn send(&self, bytes: Vec<u8>, tag: u64) {
        // Never wait here: if the boat does not read, the next command displaces this one.
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Normal));
    }

    fn send_stop(&self, bytes: Vec<u8>, tag: u64) {
        drop(self.threads.enqueue(bytes, Some(tag), Priority::Stop));
    }

    fn displaced(&self) -> u64 {
        self.threads.displaced()
    }

    fn send_and_wait(&self, bytes: &[u8], limit: Duration) -> bool {
        self.threads
            .enqueue(bytes.to_vec(), None, Priority::Shutdown)
            .wait(limit)
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
            let (listener, at) = listening("TCP", at, tcp_server::bind)?;
            (
                reached("tcp", at),
                Box::new(move || tcp_server::run(&threads, &listener)),
            )
        }
        LinkAddress::Udp(Side::Listens, at) => {
            let (socket, at) = listening("UDP", at, udp_server::bind)?;
            let socket = Arc::new(socket);
            (
                reached("udp", at),
                Box::new(move || udp_server::run(&threads, &socket)),
            )
        }
        LinkAddress::Pty { link } => {
            let pty = Arc::new(pty::Pty::open(link.as_deref())?);
            (
                pty.path().display().to_string(),
                Box::new(move || pty_server::run(&threads, &pty)),
            )
        }
        LinkAddress::Tcp(..)
        | LinkAddress::Udp(..)
        | LinkAddress::UdpListen(_)
        | LinkAddress::Serial { .. } => {
            let address = address.clone();
            (
                address.to_string(),
                Box::new(move || client::run(&threads, &address)),
            )
        }
    })
}

fn listening<T>(
    kind: &'static str,
    at: &HostPort,
    bind: fn((&str, u16)) -> io::Result<T>,
) -> Result<T, LinkError> {
    bind((&at.host, at.port)).map_err(|e| LinkError::Listen {
        kind,
        at: at.clone(),
        reason: e.to_string(),
    })
}

fn reached(scheme: &str, at: SocketAddr) -> String {
    format!("{scheme}://{at}")
}
