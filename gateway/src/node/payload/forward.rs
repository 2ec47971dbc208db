//! A client of a payload behind a TCP port, with its own connection to the payload, over which
//! bytes pass both ways.

use super::super::LOOK;
use super::passed_payload::{Payload, Talk};
use super::{ANSWER_PAUSE, CONNECT_MAX, WRITE_MAX};
use crate::link::HostPort;
use bus::{Slot, clock};
use socket2::{SockRef, TcpKeepalive};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Maximum bytes passed at once.
const PIECE: usize = 64 * 1024;
/// Idle time before a connection is probed, interval of the probes, and their number before it is
/// closed.
const KEEPALIVE: TcpKeepalive = TcpKeepalive::new()
    .with_time(Duration::from_secs(10))
    .with_interval(Duration::from_secs(5))
    .with_retries(3);

/// A client and its connection to the payload.
struct Forward<'a> {
    payload: &'a Payload,
    slot: &'a Slot,
    client: &'a TcpStream,
    upstream: TcpStream,
    number: u32,
    talk: Talk,
    /// Whether the payload and the client have closed their sides.
    ended: [AtomicBool; 2],
}

/// Serves a client until it or the payload is lost.
pub(super) fn serve(payload: &Payload, at: &HostPort, slot: &Slot, client: &TcpStream) {
    let Some(_turn) = payload.turn.client() else {
        return;
    };
    let upstream = match prepare(client).and_then(|()| connect(at)) {
        Ok(upstream) => upstream,
        Err(e) => {
            return payload.remark(&format!(
                "cannot connect a client to {}: {e}",
                payload.port.address
            ));
        }
    };
    let (number, talk) = payload.open();
    let forward = Forward {
        payload,
        slot,
        client,
        upstream,
        number,
        talk,
        ended: Default::default(),
    };
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name(format!("payload {}", payload.port.name));
        match thread.spawn_scoped(scope, || forward.pass(false)) {
            Ok(_) => forward.pass(true),
            Err(e) => payload.remark(&format!("cannot start a thread for a client: {e}")),
        }
    });
}

/// Connects to a payload.
pub(super) fn connect(at: &HostPort) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in (at.host.as_str(), at.port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_MAX) {
            // Nothing listens on this port of the ephemeral range, and our own socket got that very
            // port.
            Ok(stream) if stream.local_addr()? == address => {
                last = ErrorKind::ConnectionRefused.into()
            }
            Ok(stream) => {
                prepare(&stream)?;
                return Ok(stream);
            }
            Err(e) => last = e,
        }
    }
    Err(last)
}

/// Sets the options of a connection so that no wait is unlimited.
pub(super) fn prepare(stream: &TcpStream) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(LOOK))?;
    stream.set_write_timeout(Some(WRITE_MAX))?;
    SockRef::from(stream).set_tcp_keepalive(&KEEPALIVE)
}

/// Whether a wait ended without a result.
pub(super) fn is_pause(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

impl Forward<'_> {
    /// Passes bytes one way until that ends. Reads no more while the other side does not accept
    /// them.
    fn pass(&self, outward: bool) {
        let (from, to) = if outward {
            (self.client, &self.upstream)
        } else {
            (&self.upstream, self.client)
        };
        let mut piece = vec![0; PIECE];
        let mut received = clock::now();
        loop {
            match (&mut &*from).read(&mut piece) {
                Ok(0) => {
                    self.payload.record_end(&self.talk, self.number, outward);
                    self.ended[usize::from(outward)].store(true, Ordering::Relaxed);
                    // The other side may be gone already.
                    drop(to.shutdown(Shutdown::Write));
                    return;
                }
                Ok(count) => {
                    received = clock::now();
                    self.slot.touch();
                    self.payload
                        .record_bytes(&self.talk, self.number, outward, &piece[..count]);
                    // Bytes that one side does not accept are not read from the other: TCP's own
                    // back pressure slows down a fast camera.
                    if let Err(e) = (&mut &*to).write_all(&piece[..count]) {
                        self.tell_stall(outward, &e);
                        return self.close();
                    }
                }
                Err(e) if is_pause(&e) => {
                    // After the payload's last byte the client has nothing to send; the payload may
                    // still have to answer.
                    let has_other_ended = self.ended[usize::from(!outward)].load(Ordering::Relaxed);
                    if has_other_ended && (outward || clock::since(received) >= ANSWER_PAUSE) {
                        return self.close();
                    }
                }
                Err(_) => return self.close(),
            }
        }
    }

    /// Logs the side that stalled for too long.
    fn tell_stall(&self, outward: bool, error: &io::Error) {
        if is_pause(error) {
            let receiver = if outward { "the payload" } else { "a client" };
            self.payload.remark(&format!(
                "{receiver} accepted no data for {WRITE_MAX:?}: disconnected"
            ));
        }
    }

    /// Ends both ways; a side may be gone already.
    fn close(&self) {
        drop(self.client.shutdown(Shutdown::Both));
        drop(self.upstream.shutdown(Shutdown::Both));
    }
}
