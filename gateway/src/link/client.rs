//! The connecting side of a link, which reconnects when the connection is lost.

use super::address::{HostPort, LinkAddress, Side};
use super::backoff::Backoff;
use super::clock::{self, TICK};
use super::connection::Connection;
use super::interface::LinkEvent;
use super::port::Port;
use super::threads::Threads;
use super::udp_server;
use serial2::SerialPort;
use socket2::{Domain, Protocol, Socket, TcpKeepalive, Type};
use std::io::{self, ErrorKind};
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// Maximum duration of a connection attempt. An attempt without an answer counts as waiting time,
/// so a boat that becomes reachable is connected within about a second.
const CONNECT: Duration = Duration::from_secs(1);

/// Interval at which an attempt is polled.
// A blocking connect cannot be interrupted: a gateway told to exit would wait for an unresponsive
// address.
const POLL: Duration = Duration::from_millis(5);

/// Maximum unacknowledged bytes of a TCP connection, and the time after which it counts as dead if
/// they remain unacknowledged.
// A half-open connection accepts bytes until the buffer is full. These bytes become old commands,
// so the buffer is as small as systems allow.
const SEND_BUFFER: usize = 4096;
const UNACKNOWLEDGED: Duration = Duration::from_secs(2);

/// Connects, serves and waits, repeatedly, until the link is closed.
pub(super) fn run(threads: &Arc<Threads>, address: &LinkAddress) {
    let mut backoff = Backoff::new(threads.settings.retry_first, threads.settings.retry_max);
    loop {
        let begun_at = clock::now();
        let connection = connect(threads, address)
            .and_then(|(port, name)| Connection::open(threads, port, name));
        let wait = match connection {
            Ok(connection) => {
                backoff.note_connection(connection.serve());
                backoff.wait()
            }
            Err(_) if threads.is_stopped() => return,
            Err(e) => {
                let wait = backoff.wait();
                let took = clock::since(begun_at);
                // An attempt without an answer has already used up its wait.
                let retry_in = if took < wait / 2 {
                    wait
                } else {
                    wait.saturating_sub(took)
                };
                threads.emit(LinkEvent::Failed {
                    reason: format!("{address}: {}", in_words(&e)),
                    retry_in,
                });
                retry_in
            }
        };
        if threads.stops_within(wait) {
            return;
        }
    }
}

/// A connection error, with advice on what to check.
fn in_words(error: &io::Error) -> String {
    match error.kind() {
        ErrorKind::ConnectionRefused => {
            "connection refused: nothing is listening there; check the address and port, and that the boat is switched on"
                .to_owned()
        }
        _ => error.to_string(),
    }
}

fn connect(threads: &Threads, address: &LinkAddress) -> io::Result<(Port, String)> {
    match address {
        LinkAddress::Tcp(Side::Connects, at) => connect_tcp(threads, at),
        LinkAddress::Udp(Side::Connects, at) => connect_udp(at),
        LinkAddress::UdpListen(at) => await_udp(threads, at),
        LinkAddress::Serial { path, baud } => open_serial(path, *baud),
        _ => Err(io::Error::new(
            ErrorKind::Unsupported,
            "nothing to connect to",
        )),
    }
}

fn connect_tcp(threads: &Threads, at: &HostPort) -> io::Result<(Port, String)> {
    let mut last = io::Error::new(ErrorKind::NotFound, "the host has no address");
    for address in (at.host.as_str(), at.port).to_socket_addrs()? {
        match connect_to(threads, address) {
            Ok(stream) => return Ok((Port::Tcp(stream), address.to_string())),
            Err(e) => last = e,
        }
    }
    Err(last)
}

/// Connects without blocking; `connect_timeout` could not be interrupted when the link is closed.
fn connect_to(threads: &Threads, address: SocketAddr) -> io::Result<TcpStream> {
    let socket = Socket::new(
        Domain::for_address(address),
        Type::STREAM,
        Some(Protocol::TCP),
    )?;
    socket.set_nonblocking(true)?;
    let start = clock::now();
    match socket.connect(&address.into()) {
        Err(e) if e.raw_os_error() == Some(rustix::io::Errno::INPROGRESS.raw_os_error()) => {}
        done => done?,
    }
    while socket.peer_addr().is_err() {
        if let Some(e) = socket.take_error()? {
            return Err(e);
        }
        if clock::since(start) >= CONNECT {
            return Err(io::Error::new(
                ErrorKind::TimedOut,
                format!("no answer for {CONNECT:?}"),
            ));
        }
        if threads.stops_within(POLL) {
            return Err(ErrorKind::Interrupted.into());
        }
    }
    if let Some(e) = socket.take_error()? {
        return Err(e);
    }
    // The socket connected to itself: nothing listens on this ephemeral port, and the system
    // assigned it to us.
    if socket.local_addr()?.as_socket() == Some(address) {
        return Err(ErrorKind::ConnectionRefused.into());
    }
    socket.set_nonblocking(false)?;
    tune(socket)
}

/// Sets the options for a TCP connection that carries commands: no delay, and early detection of a
/// dead peer.
pub(super) fn tune(socket: Socket) -> io::Result<TcpStream> {
    // Each sentence is sent as a packet: Nagle's algorithm would delay the second one until the
    // first is acknowledged.
    socket.set_tcp_nodelay(true)?;
    socket.set_tcp_keepalive(
        &TcpKeepalive::new()
            .with_time(UNACKNOWLEDGED)
            .with_interval(Duration::from_secs(1))
            .with_retries(2),
    )?;
    // Keepalive only works on idle connections. With unacknowledged bytes, Linux retransmits for a
    // quarter of an hour unless this limit is set.
    socket.set_tcp_user_timeout(Some(UNACKNOWLEDGED))?;
    // Linux doubles this value for its own bookkeeping.
    socket.set_send_buffer_size(SEND_BUFFER)?;
    socket.set_read_timeout(Some(TICK))?;
    socket.set_write_timeout(Some(TICK))?;
    Ok(socket.into())
}

fn connect_udp(at: &HostPort) -> io::Result<(Port, String)> {
    let mut addresses = (at.host.as_str(), at.port).to_socket_addrs()?;
    let Some(address) = addresses.next() else {
        return Err(io::Error::new(
            ErrorKind::NotFound,
            "the host has no address",
        ));
    };
    // The socket has its peer's address family: on some systems an IPv6 socket cannot reach IPv4
    // addresses.
    let (socket, _) = udp_server::bind((if address.is_ipv4() { "0.0.0.0" } else { "::" }, 0))?;
    socket.connect(address)?;
    Ok((Port::Udp(socket), address.to_string()))
}

/// Waits for the first datagram, and connects to its sender.
// A single peer rather than a server: there is one boat, and the guard needs a socket on which a
// plain write reaches that boat. A restarted boat sends from a different port; it is found once
// silence has ended the connection.
fn await_udp(threads: &Threads, at: &HostPort) -> io::Result<(Port, String)> {
    let (socket, _) = udp_server::bind((&at.host, at.port))?;
    let start = clock::now();
    while clock::since(start) < CONNECT && !threads.is_stopped() {
        // Only peek: the connection must still read this datagram.
        match socket.peek_from(&mut [0]) {
            Ok((_, from)) => {
                socket.connect(from)?;
                return Ok((Port::Udp(socket), from.to_string()));
            }
            Err(e)
                if matches!(
                    e.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) => {}
            Err(e) => return Err(e),
        }
    }
    Err(io::Error::new(
        ErrorKind::TimedOut,
        format!("received nothing for {CONNECT:?}"),
    ))
}

fn open_serial(path: &Path, baud: u32) -> io::Result<(Port, String)> {
    // Setting the speed alone selects raw 8N1 without flow control.
    let mut line = SerialPort::open(path, baud)?;
    line.set_read_timeout(TICK)?;
    line.set_write_timeout(TICK)?;
    // Discard bytes that arrived before the line was opened.
    line.discard_input_buffer()?;
    Ok((Port::Serial { line, baud }, path.display().to_string()))
}
