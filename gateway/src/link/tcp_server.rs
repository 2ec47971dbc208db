//! A TCP port of our own, for some peers at once.

use super::client::tune;
use super::peer::Seat;
use super::port::{Port, TICK};
use super::threads::{Threads, Woken};
use super::{LinkError, PEERS_MAX};
use socket2::SockRef;
use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;

/// Takes the port.
pub(super) fn bind(host: &str, port: u16) -> Result<(TcpListener, SocketAddr), LinkError> {
    let bound = || -> io::Result<(TcpListener, SocketAddr)> {
        let listener = TcpListener::bind((host, port))?;
        // On Linux it holds for `accept` too.
        SockRef::from(&listener).set_read_timeout(Some(TICK))?;
        let address = listener.local_addr()?;
        Ok((listener, address))
    };
    bound().map_err(|e| LinkError::Listen { kind: "TCP", host: host.to_owned(), port, reason: e.to_string() })
}

/// Takes whoever comes, until the link is closed.
pub(super) fn keep(crew: &Arc<Threads>, listener: &TcpListener) {
    while !crew.is_stopped() {
        match listener.accept() {
            Ok((stream, from)) => welcome(crew, stream, from),
            Err(e) if e.kind() == io::ErrorKind::WouldBlock => {}
            // Too many open files, for example: it may pass.
            Err(_) if crew.rest(TICK) == Woken::Stopped => return,
            Err(_) => {}
        }
    }
}

fn welcome(crew: &Arc<Threads>, stream: TcpStream, from: SocketAddr) {
    if crew.count() >= PEERS_MAX {
        return;
    }
    // Whoever cannot be served, since it is gone already or threads are out, finds the connection closed.
    let Ok(stream) = tune(stream.into()) else { return };
    let Ok(seat) = Seat::take(crew, Port::Tcp(stream), from.to_string()) else { return };
    drop(crew.hire("link reader", move || drop(seat.serve())));
}
