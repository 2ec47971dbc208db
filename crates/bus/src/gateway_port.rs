//! Queries to a gateway at its own control port, with or without a game: lines of JSON over TCP.
//! Each line is a request or an answer in the network's format (see `token`).

use crate::{BusError, Token, clock, token};
use messages::external::{GatewayCommand, OperatorReply};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

/// The key of requests at control ports, in proofs.
pub const GATEWAY_PORT_KEY: &str = "gateway control port";
/// Maximum length of an answer, bytes.
pub(crate) const ANSWER_BYTES_MAX: u64 = 1 << 20;
/// Number of attempts: a port under attack may drop a connection before reading from it.
const ATTEMPTS: usize = 3;

/// Queries the gateway whose control port is `at`, within `limit`.
///
/// # Errors
/// [`BusError`] if it cannot be reached or does not respond, or if it requires a token that this
/// node lacks.
pub fn ask_gateway(
    at: SocketAddr,
    token: Option<&Token>,
    command: &GatewayCommand,
    limit: Duration,
) -> Result<OperatorReply, BusError> {
    let deadline = clock::now() + limit;
    // Commands that need the token are sent only once, even if the reply is lost: a second release
    // could end a different stop.
    let repeats = if command.needs_token() {
        0
    } else {
        ATTEMPTS - 1
    };
    for _ in 0..repeats {
        match ask_once(at, token, command, deadline) {
            Err(BusError::Use { .. }) => {}
            result => return result,
        }
    }
    ask_once(at, token, command, deadline)
}

fn ask_once(
    at: SocketAddr,
    token: Option<&Token>,
    command: &GatewayCommand,
    deadline: Instant,
) -> Result<OperatorReply, BusError> {
    let failed = |e: std::io::Error| BusError::Use {
        doing: "query the gateway at",
        key: at.to_string(),
        reason: e.to_string(),
    };
    // A timeout of zero would be an error.
    let left = || {
        deadline
            .saturating_duration_since(clock::now())
            .max(Duration::from_millis(1))
    };
    let stream = TcpStream::connect_timeout(&at, left()).map_err(failed)?;
    // Nagle's algorithm would delay the second line until the first is acknowledged, by up to 40 ms
    // on Linux.
    stream.set_nodelay(true).map_err(failed)?;
    let mut reader = BufReader::new(&stream);
    let mut exchange = |mut payload: Vec<u8>| -> std::io::Result<Option<Vec<u8>>> {
        payload.push(b'\n');
        stream.set_write_timeout(Some(left()))?;
        (&stream).write_all(&payload)?;
        stream.set_read_timeout(Some(left()))?;
        let mut line = Vec::new();
        reader
            .by_ref()
            .take(ANSWER_BYTES_MAX)
            .read_until(b'\n', &mut line)?;
        if line.is_empty() {
            Err(std::io::ErrorKind::ConnectionAborted.into())
        } else {
            Ok(Some(line))
        }
    };
    let reply = token::request(token, GATEWAY_PORT_KEY, command, |payload| {
        exchange(payload).map_err(failed)
    })?;
    reply.ok_or(BusError::Silent)
}
