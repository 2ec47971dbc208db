//! A client of a payload behind a TCP port: it has a connection of its own to the payload, over which its bytes and those for it pass.

use super::limit::{ANSWER_PAUSE, CONNECT_MAX, LOOK, WRITE_MAX};
use super::passed_payload::Payload;
use super::tap::Tap;
use crate::link::HostPort;
use bus::{Slot, clock};
use socket2::{SockRef, TcpKeepalive};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The most bytes that pass at once.
const PIECE: usize = 64 * 1024;
/// After so long without a byte a connection is probed, so often, and given up when nobody answers.
const KEEPALIVE: TcpKeepalive =
    TcpKeepalive::new().with_time(Duration::from_secs(10)).with_interval(Duration::from_secs(5)).with_retries(3);

/// A client, and its connection to the payload.
struct Forward<'a> {
    payload: &'a Payload,
    slot: &'a Slot,
    client: &'a TcpStream,
    upstream: TcpStream,
    number: u32,
    tap: Tap,
    /// Whether the payload, the client has closed its side.
    ended: [AtomicBool; 2],
}

/// Serves a client, until it or the payload is gone.
pub(super) fn serve(payload: &Payload, at: &HostPort, slot: &Slot, client: &TcpStream) {
    let Some(_turn) = payload.turn.client() else { return };
    let connected = connect(at).and_then(|upstream| {
        prepare(client)?;
        Ok(upstream)
    });
    let upstream = match connected {
        Ok(upstream) => upstream,
        Err(e) => return payload.remark(&format!("cannot connect a client to {}: {e}", payload.port.address)),
    };
    let (number, tap) = payload.taps.open();
    let forward = Forward { payload, slot, client, upstream, number, tap, ended: Default::default() };
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
            // Nobody listens on a port of the ephemeral range, and our own socket was given that very port.
            Ok(stream) if stream.local_addr()? == address => last = ErrorKind::ConnectionRefused.into(),
            Ok(stream) => {
                prepare(&stream)?;
                return Ok(stream);
            }
            Err(e) => last = e,
        }
    }
    Err(last)
}

/// Sets the options of a connection on which nobody is waited for without a limit.
pub(super) fn prepare(stream: &TcpStream) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(LOOK))?;
    stream.set_write_timeout(Some(WRITE_MAX))?;
    SockRef::from(stream).set_tcp_keepalive(&KEEPALIVE)
}

/// Whether a wait ended without a result.
pub(super) fn is_pause(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

impl Forward<'_> {
    /// Passes bytes on one way, until that ends. While the other side does not take them, no more are read.
    fn pass(&self, outward: bool) {
        let (from, to) = if outward { (self.client, &self.upstream) } else { (&self.upstream, self.client) };
        let mut piece = vec![0; PIECE];
        let mut received = clock::now();
        loop {
            match (&mut &*from).read(&mut piece) {
                Ok(0) => {
                    self.tap.end(self.number, outward);
                    self.ended[usize::from(outward)].store(true, Ordering::Relaxed);
                    // Who is gone already need not be told.
                    drop(to.shutdown(Shutdown::Write));
                    return;
                }
                Ok(count) => {
                    received = clock::now();
                    self.slot.touch();
                    self.tap.record_bytes(self.number, outward, &piece[..count]);
                    // What one side does not take is not read from the other: TCP's own back
                    // pressure holds a fast camera back.
                    if let Err(e) = (&mut &*to).write_all(&piece[..count]) {
                        self.tell_stall(outward, &e);
                        return self.close();
                    }
                }
                Err(e) if is_pause(&e) => {
                    // After the payload's last byte nothing is for the client to say; the payload may still have to answer.
                    let has_other_ended = self.ended[usize::from(!outward)].load(Ordering::Relaxed);
                    if has_other_ended && (outward || clock::since(received) >= ANSWER_PAUSE) {
                        return self.close();
                    }
                }
                Err(_) => return self.close(),
            }
        }
    }

    /// Logs whoever was waited for too long.
    fn tell_stall(&self, outward: bool, error: &io::Error) {
        if is_pause(error) {
            let receiver = if outward { "the payload" } else { "a client" };
            self.payload.remark(&format!("{receiver} accepted no data for {WRITE_MAX:?}: disconnected"));
        }
    }

    /// Ends both ways; who is gone already need not be told.
    fn close(&self) {
        drop(self.client.shutdown(Shutdown::Both));
        drop(self.upstream.shutdown(Shutdown::Both));
    }
}
