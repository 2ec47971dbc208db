//! A UDP port of our own, whose peers are those who spoke to it lately.

use super::peer::{CHUNK, End, Seat};
use super::port::{Port, TICK};
use super::threads::{Threads, Woken};
use super::{LinkError, LinkEvent, PEERS_MAX, clock};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// A peer that says nothing for this long is forgotten, or sooner if the settings say so.
const FORGOTTEN: Duration = Duration::from_secs(10);

struct Guest {
    from: SocketAddr,
    seat: Seat,
    heard_at: Instant,
}

/// Takes the port.
pub(super) fn bind(host: &str, port: u16) -> Result<(UdpSocket, SocketAddr), LinkError> {
    let bound = || -> io::Result<(UdpSocket, SocketAddr)> {
        let socket = UdpSocket::bind((host, port))?;
        socket.set_read_timeout(Some(TICK))?;
        socket.set_write_timeout(Some(TICK))?;
        let address = socket.local_addr()?;
        Ok((socket, address))
    };
    bound().map_err(|e| LinkError::Listen { kind: "UDP", host: host.to_owned(), port, reason: e.to_string() })
}

/// Listens to whoever speaks, until the link is closed.
pub(super) fn keep(crew: &Arc<Threads>, socket: &Arc<UdpSocket>) {
    let patience = crew.settings.silence.map_or(FORGOTTEN, |silence| silence.min(FORGOTTEN));
    let mut guests: Vec<Guest> = Vec::new();
    let mut buffer = vec![0; CHUNK];
    while !crew.is_stopped() {
        match socket.recv_from(&mut buffer) {
            Ok((count, from)) => hear(crew, socket, &mut guests, from, &buffer[..count]),
            Err(e) if e.kind() == io::ErrorKind::WouldBlock => {}
            Err(_) if crew.rest(TICK) == Woken::Stopped => break,
            Err(_) => {}
        }
        while let Some((at, end)) = leaver(&guests, patience) {
            guests.swap_remove(at).seat.leave(&end);
        }
    }
    for guest in guests {
        guest.seat.leave(&End::Stopped);
    }
}

fn hear(crew: &Arc<Threads>, socket: &Arc<UdpSocket>, guests: &mut Vec<Guest>, from: SocketAddr, bytes: &[u8]) {
    let at = clock::now();
    let known = guests.iter_mut().find(|guest| guest.from == from);
    let peer = if let Some(guest) = known {
        guest.heard_at = at;
        guest.seat.peer.number
    } else if guests.len() < PEERS_MAX {
        let port = Port::UdpTo(Arc::clone(socket), from);
        // Out of threads: it may speak again later.
        let Ok(seat) = Seat::take(crew, port, from.to_string()) else { return };
        let peer = seat.peer.number;
        guests.push(Guest { from, seat, heard_at: at });
        peer
    } else {
        return;
    };
    if !bytes.is_empty() {
        crew.tell(LinkEvent::Bytes { peer, at, bytes: bytes.to_vec() });
    }
}

/// The first guest whose time is over, and why.
fn leaver(guests: &[Guest], patience: Duration) -> Option<(usize, End)> {
    let end = |guest: &Guest| {
        let silent = || (clock::since(guest.heard_at) >= patience).then(|| format!("no bytes for {patience:?}"));
        guest.seat.peer.is_to_end().or_else(|| silent().map(End::Lost))
    };
    guests.iter().enumerate().find_map(|(at, guest)| Some((at, end(guest)?)))
}
