//! A TCP port that is served until dropped, with one thread per connection and a limited number of
//! connections.

use super::POLL;
use bus::{Connections, Slot, clock};
use socket2::SockRef;
use std::io;
use std::net::{IpAddr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// A port. Dropping it closes it and its connections.
pub(super) struct TcpPort {
    server: Arc<Server>,
    thread: Option<JoinHandle<()>>,
    pub(super) address: SocketAddr,
}

/// Serves a connection until it returns.
type Serve = Box<dyn Fn(&Slot, &TcpStream) + Send + Sync>;

/// State shared by the threads.
struct Server {
    /// The name of the threads.
    name: String,
    serve: Serve,
    is_closing: AtomicBool,
    connections: Connections,
}

impl TcpPort {
    /// Opens a port for this many connections. If all are in use, a new connection displaces the
    /// one that has been idle for longest.
    pub(super) fn open(
        listen: SocketAddr,
        name: &str,
        connections_max: usize,
        serve: impl Fn(&Slot, &TcpStream) + Send + Sync + 'static,
    ) -> io::Result<TcpPort> {
        let listener = TcpListener::bind(listen)?;
        // On Linux, this timeout applies to `accept` too.
        SockRef::from(&listener).set_read_timeout(Some(POLL))?;
        let address = listener.local_addr()?;
        let server = Arc::new(Server {
            name: name.to_owned(),
            serve: Box::new(serve),
            is_closing: AtomicBool::new(false),
            connections: Connections::new(connections_max),
        });
        let shared = Arc::clone(&server);
        let thread = std::thread::Builder::new()
            .name(name.to_owned())
            .spawn(move || shared.accept(&listener))?;
        Ok(TcpPort {
            server,
            thread: Some(thread),
            address,
        })
    }
}

impl Drop for TcpPort {
    fn drop(&mut self) {
        self.server.is_closing.store(true, Ordering::SeqCst);
        // The result of a thread that panicked is not needed.
        self.thread
            .take()
            .map(JoinHandle::join)
            .into_iter()
            .for_each(drop);
        self.server.connections.close();
    }
}

impl Server {
    fn accept(self: &Arc<Self>, listener: &TcpListener) {
        while !self.is_closing.load(Ordering::SeqCst) {
            match listener.accept() {
                Ok((stream, from)) => self.open(stream, from.ip()),
                Err(e) if e.kind() == io::ErrorKind::WouldBlock => {}
                // The cause may be temporary, for example too many open files.
                Err(_) => clock::rest(POLL),
            }
        }
    }

    /// Starts a thread for a connection. If no thread can start, the connection is closed.
    fn open(self: &Arc<Self>, stream: TcpStream, from: IpAddr) {
        let Ok(other) = stream.try_clone() else {
            return;
        };
        // `admit` closes the connection that has been idle longest, so that many silent connections
        // cannot lock anyone out; the thread that reads it will notice.
        let slot = self
            .connections
            .admit(from, move || drop(other.shutdown(Shutdown::Both)));
        let server = Arc::clone(self);
        let serve = move || (server.serve)(&slot, &stream);
        drop(
            std::thread::Builder::new()
                .name(self.name.clone())
                .spawn(serve),
        );
    }
}
