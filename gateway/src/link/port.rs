//! A port of the operating system: reads and writes bytes without long waits.

use super::clock;
use super::pty::Pty;
use serial2::SerialPort;
use socket2::SockRef;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream, UdpSocket};
use std::os::fd::{AsFd, BorrowedFd};
use std::sync::Arc;
use std::time::Duration;

/// Time without accepting bytes after which a peer is lost.
pub(super) const STALL: Duration = Duration::from_secs(2);

/// How long a graceful close waits for the peer.
// A radio round trip, well within the time limit of a closing link.
const LINGER: Duration = Duration::from_millis(80);

/// A socket, a serial line or a pseudo-terminal. Two threads may read and write at the same time.
pub(super) enum Port {
    Tcp(TcpStream),
    /// A connected socket.
    Udp(UdpSocket),
    /// Shared by all peers of the server, which reads it.
    UdpTo(Arc<UdpSocket>, SocketAddr),
    Serial {
        line: SerialPort,
        baud: u32,
    },
    Pty(Arc<Pty>),
}

/// The result of a read.
pub(super) enum Received {
    Bytes(usize),
    Nothing,
    End,
}

/// The result of a write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrote {
    All,
    /// The start of the bytes was discarded because nobody read it, which is not an error.
    Dropped,
}

impl Port {
    /// The port's descriptor; `None` if peers share the port.
    pub(super) fn descriptor(&self) -> Option<BorrowedFd<'_>> {
        match self {
            Port::Tcp(stream) => Some(stream.as_fd()),
            Port::Udp(socket) => Some(socket.as_fd()),
            Port::Serial { line, .. } => Some(line.as_fd()),
            // The guard needs a descriptor on which a plain write reaches the boat. These ports are
            // for emulated boats, which need no guard.
            Port::UdpTo(..) | Port::Pty(_) => None,
        }
    }

    /// Waits at most one tick for bytes.
    pub(super) fn read(&self, buffer: &mut [u8]) -> io::Result<Received> {
        let read = match self {
            Port::Tcp(stream) => (&mut &*stream).read(buffer),
            Port::Udp(socket) => socket.recv(buffer),
            Port::UdpTo(..) => Err(ErrorKind::Unsupported.into()),
            Port::Serial { line, .. } => line.read(buffer),
            Port::Pty(pty) => pty.read(buffer),
        };
        match read {
            // Empty datagrams are valid.
            Ok(0) if matches!(self, Port::Udp(_)) => Ok(Received::Nothing),
            Ok(0) => Ok(Received::End),
            Ok(count) => Ok(Received::Bytes(count)),
            Err(e) if is_pause(&e) => Ok(Received::Nothing),
            Err(e) => Err(e),
        }
    }

    /// Writes all bytes, in one call if the system accepts that. Gives up when `is_given_up`
    /// returns true, or after [`STALL`].
    pub(super) fn write(&self, bytes: &[u8], is_given_up: impl Fn() -> bool) -> io::Result<Wrote> {
        if let Port::Pty(pty) = self {
            pty.begin()?;
        }
        let flushes = self.flushes();
        let mut rest = bytes;
        let mut progress_at = clock::now();
        while !rest.is_empty() {
            if is_given_up() {
                return Err(io::Error::other("given up"));
            }
            match self.write_some(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => {
                    rest = &rest[count..];
                    progress_at = clock::now();
                }
                Err(e) if !is_pause(&e) => return Err(e),
                // The beginning was discarded, so the rest would be an incomplete sentence.
                Err(_) if self.flushes() != flushes => return Ok(Wrote::Dropped),
                Err(_) if clock::since(progress_at) >= STALL => {
                    return Err(io::Error::new(
                        ErrorKind::TimedOut,
                        format!("no data accepted for {STALL:?}"),
                    ));
                }
                Err(_) => {}
            }
        }
        Ok(Wrote::All)
    }

    fn write_some(&self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Port::Tcp(stream) => (&mut &*stream).write(bytes),
            Port::Udp(socket) => socket.send(bytes),
            Port::UdpTo(socket, to) => socket.send_to(bytes, *to),
            Port::Serial { line, .. } => line.write(bytes),
            Port::Pty(pty) => pty.write(bytes),
        }
    }

    /// Discards old unread bytes where possible.
    pub(super) fn flush_if_stale(&self) -> io::Result<()> {
        if let Port::Pty(pty) = self {
            pty.flush_if_stale()
        } else {
            Ok(())
        }
    }

    fn flushes(&self) -> u64 {
        if let Port::Pty(pty) = self {
            pty.flushes()
        } else {
            0
        }
    }

    /// Whether silence means that the peer is lost. A reader of a terminal may never write.
    pub(super) fn can_fall_silent(&self) -> bool {
        !matches!(self, Port::Pty(_))
    }

    /// Closes gracefully, so that bytes already written still arrive.
    pub(super) fn finish(&self) {
        let Port::Tcp(stream) = self else { return };
        // Closing a socket with unread bytes makes the system send a reset, which may overtake the
        // last bytes written. Read briefly, until the other side has also closed.
        if stream.shutdown(Shutdown::Write).is_err() {
            return;
        }
        let start = clock::now();
        let mut waste = [0; 4096];
        while clock::since(start) < LINGER {
            if matches!(self.read(&mut waste), Ok(Received::End) | Err(_)) {
                return;
            }
        }
    }

    /// Resets the connection, because bytes still held by the system would arrive too late. A
    /// connection that is gone needs no reset.
    pub(super) fn reset(&self) {
        match self {
            // A reset discards everything that the peer has not read.
            Port::Tcp(stream) => drop(SockRef::from(stream).set_linger(Some(Duration::ZERO))),
            // A serial driver keeps sending after the descriptor is closed.
            Port::Serial { line, .. } => drop(line.discard_output_buffer()),
            _ => {}
        }
    }

    /// Discards what a serial line has accepted but not sent. No test covers this, because
    /// pseudo-terminals hold nothing back.
    pub(super) fn discard_unsent(&self) {
        if let Port::Serial { line, .. } = self {
            // On failure, the driver sends these bytes as usual.
            drop(line.discard_output_buffer());
        }
    }

    /// The time to transmit this many bytes, where it is not negligible. A serial driver accepts 4
    /// KiB at once, which at 4800 baud is 8 s of old commands.
    pub(super) fn transit(&self, count: usize) -> Duration {
        // Eight data bits, a start bit and a stop bit.
        if let Port::Serial { baud, .. } = self {
            Duration::from_secs_f64(10.0 * count as f64 / f64::from(*baud))
        } else {
            Duration::ZERO
        }
    }
}

/// Whether a wait ended without a result.
fn is_pause(error: &io::Error) -> bool {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::Interrupted => true,
        // With a system error number, this is TCP's ETIMEDOUT, and the connection is lost. Without
        // one, it is our own timeout.
        ErrorKind::TimedOut => error.raw_os_error().is_none(),
        _ => false,
    }
}
