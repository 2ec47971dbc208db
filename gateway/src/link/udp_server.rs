//! Our own UDP port; its peers are the recent senders.

use super::clock::{self, TICK};
use super::connection::{CHUNK, Connection};
use super::interface::LinkEvent;
use super::peer::End;
use super::port::Port;
use super::threads::{PEERS_MAX, Threads};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Silence after which a peer is forgotten. The settings may only shorten this time.
const IDLE_MAX: Duration = Duration::from_secs(10);

struct UdpPeer {
    from: SocketAddr,
    connection: Connection,
    received_at: Instant,
}

/// Opens the port.
pub(super) fn bind(at: (&str, u16)) -> io::Result<(UdpSocket, SocketAddr)> {
    let socket = UdpSocket::bind(at)?;
    socket.set_read_timeout(Some(TICK))?;
    socket.set_write_timeout(Some(TICK))?;
    let address = socket.local_addr()?;
    Ok((socket, address))
}

/// Receives from all peers until the link is closed.
pub(super) fn run(threads: &Arc<Threads>, socket: &Arc<UdpSocket>) {
    let silence_max = threads
        .settings
        .silence
        .map_or(IDLE_MAX, |silence| silence.min(IDLE_MAX));
    let mut peers: Vec<UdpPeer> = Vec::new();
    let mut buffer = vec![0; CHUNK];
    while !threads.is_stopped() {
        match socket.recv_from(&mut buffer) {
            Ok((count, from)) => receive(threads, socket, &mut peers, from, &buffer[..count]),
            Err(e) if e.kind() == io::ErrorKind::WouldBlock => {}
            Err(_) if threads.stops_within(TICK) => break,
            Err(_) => {}
        }
        while let Some((at, end)) = first_to_close(&peers, silence_max) {
            peers.swap_remove(at).connection.close(&end);
        }
    }
    for peer in peers {
        peer.connection.close(&End::Stopped);
    }
}

fn receive(
    threads: &Arc<Threads>,
    socket: &Arc<UdpSocket>,
    peers: &mut Vec<UdpPeer>,
    from: SocketAddr,
    bytes: &[u8],
) {
    let at = clock::now();
    // A peer is any sender of a datagram: UDP has no connections, and back seats expect replies on
    // the port they sent from.
    let known = peers.iter_mut().find(|peer| peer.from == from);
    let peer = if let Some(peer) = known {
        peer.received_at = at;
        peer.connection.peer.number
    // Forged senders must not each start a thread.
    } else if peers.len() < PEERS_MAX {
        let port = Port::UdpTo(Arc::clone(socket), from);
        // If no thread can start, the peer may send again later.
        let Ok(connection) = Connection::open(threads, port, from.to_string()) else {
            return;
        };
        let peer = connection.peer.number;
        peers.push(UdpPeer {
            from,
            connection,
            received_at: at,
        });
        peer
    } else {
        return;
    };
    if !bytes.is_empty() {
        threads.emit(LinkEvent::Bytes {
            peer,
            at,
            bytes: bytes.to_vec(),
        });
    }
}

/// The first peer whose connection must end, and why.
fn first_to_close(peers: &[UdpPeer], silence_max: Duration) -> Option<(usize, End)> {
    let end = |peer: &UdpPeer| {
        let silent = || {
            (clock::since(peer.received_at) >= silence_max)
                .then(|| format!("no bytes for {silence_max:?}"))
        };
        peer.connection
            .peer
            .is_to_end()
            .or_else(|| silent().map(End::Lost))
    };
    peers
        .iter()
        .enumerate()
        .find_map(|(at, peer)| Some((at, end(peer)?)))
}
