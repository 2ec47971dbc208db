//! Our own TCP port, which serves several peers at once.

use super::client::tune;
use super::clock::TICK;
use super::connection::Connection;
use super::port::Port;
use super::threads::{PEERS_MAX, Threads};
use socket2::SockRef;
use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;

/// Opens the port.
pub(super) fn bind(at: (&str, u16)) -> io::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind(at)?;
    // On Linux, this timeout applies to `accept` too.
    SockRef::from(&listener).set_read_timeout(Some(TICK))?;
    let address = listener.local_addr()?;
    Ok((listener, address))
}

/// Accepts connections until the link is closed.
pub(super) fn run(threads: &Arc<Threads>, listener: &TcpListener) {
    while !threads.is_stopped() {
        match listener.accept() {
            Ok((stream, from)) => serve_peer(threads, stream, from),
            Err(e) if e.kind() == io::ErrorKind::WouldBlock => {}
            // The cause may be temporary, for example too many open files.
            Err(_) if threads.stops_within(TICK) => return,
            Err(_) => {}
        }
    }
}

fn serve_peer(threads: &Arc<Threads>, stream: TcpStream, from: SocketAddr) {
    // Dropping the stream closes it: the peer sees at once that there is no free slot.
    if threads.count() >= PEERS_MAX {
        return;
    }
    // A peer that has left, or for which there is no thread, finds the connection closed.
    let Ok(stream) = tune(stream.into()) else {
        return;
    };
    let Ok(connection) = Connection::open(threads, Port::Tcp(stream), from.to_string()) else {
        return;
    };
    drop(threads.spawn("link reader", move || {
        connection.serve();
    }));
}
