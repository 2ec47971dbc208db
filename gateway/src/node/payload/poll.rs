//! Polls a sonde while no client is connected, so that its values are recorded anyway.

use super::forward::{connect, is_pause};
use super::passed_payload::Payload;
use super::shared_line::SharedLine;
use super::tap::Tap;
use super::turn::PollTurn;
use super::way::Way;
use crate::link::HostPort;
use crate::payload::Exo2Port;
use crate::payload::exo2::{Command, Sonde};
use bus::clock;
use std::io::{self, ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Minimum time between polls.
const EVERY: Duration = Duration::from_secs(1);
/// Maximum time for an answer by HTTP.
const ANSWER_MAX: Duration = Duration::from_secs(5);
/// Maximum bytes of an answer.
const ANSWER_LENGTH_MAX: usize = 64 * 1024;
/// After this many queries without an answer its parameters are queried again: they may have
/// changed.
const UNANSWERED_MAX: u32 = 5;

/// The next query to the sonde.
struct Questions<'a> {
    payload: &'a Payload,
    /// The state of the sonde when its parameters were queried, and when it was last polled.
    begun: Sonde,
    last: Sonde,
    unanswered: u32,
}

/// Polls the sonde whenever it has no client, until everything ends.
pub(super) fn run(payload: &Payload, way: &Way, exo2: Exo2Port) {
    while let Some(turn) = payload.turn.poll() {
        let mut questions = Questions::new(payload);
        let asked = match (way, exo2) {
            (Way::Tcp(at), Exo2Port::Http) => by_http(payload, at, &mut questions, &turn),
            (Way::Tcp(at), Exo2Port::Lines) => by_lines(payload, at, &mut questions, &turn),
            (Way::Shared(line), _) => over_line(line, &mut questions, &turn),
        };
        if let Err(e) = asked {
            payload.remark(&format!("cannot query the sonde at {}: {e}", payload.port.address));
        }
        // A client that connects gets the sonde at once: people come before the recording.
        turn.is_wanted_within(EVERY);
    }
}

impl Questions<'_> {
    fn new(payload: &Payload) -> Questions<'_> {
        let sonde = payload.taps.sonde().unwrap_or_default();
        Questions { payload, begun: sonde.clone(), last: sonde, unanswered: 0 }
    }

    /// Queries its parameters until it has reported them, then their values.
    fn next(&mut self) -> Command {
        let sonde = self.payload.taps.sonde().unwrap_or_default();
        self.unanswered = if sonde == self.last { self.unanswered + 1 } else { 0 };
        if self.unanswered > UNANSWERED_MAX {
            self.payload.remark(&format!("the sonde does not answer `{}`", self.command(&sonde).word()));
            (self.begun, self.unanswered) = (sonde.clone(), 0);
        }
        self.last = sonde;
        self.command(&self.last)
    }

    fn command(&self, sonde: &Sonde) -> Command {
        // Numbers mean nothing without the codes of their parameters, so these are queried first.
        if sonde.told == self.begun.told { Command::Parameters } else { Command::Values }
    }
}

/// Over one connection, line by line.
fn by_lines(payload: &Payload, at: &HostPort, questions: &mut Questions<'_>, turn: &PollTurn<'_>) -> io::Result<()> {
    let stream = connect(at)?;
    let connection = payload.taps.open();
    while !turn.is_wanted_within(Duration::ZERO) {
        match send_question(&stream, &connection, &line(questions.next()), turn, EVERY)? {
            Answer::Ended => return Err(ErrorKind::ConnectionAborted.into()),
            // Limits the rate at which an endless answer is read.
            Answer::TooLong => drop(turn.is_wanted_within(EVERY)),
            Answer::Open => {}
        }
    }
    Ok(())
}

/// Over a line whose answers also reach its clients.
fn over_line(line_to: &SharedLine, questions: &mut Questions<'_>, turn: &PollTurn<'_>) -> io::Result<()> {
    // The link has already reported its loss.
    while line_to.is_up() && line_to.send(0, line(questions.next()).as_bytes()) {
        if turn.is_wanted_within(EVERY) {
            break;
        }
    }
    Ok(())
}

/// By HTTP, with a connection for each query.
fn by_http(payload: &Payload, at: &HostPort, questions: &mut Questions<'_>, turn: &PollTurn<'_>) -> io::Result<()> {
    loop {
        // HTTP/1.0: the answer ends with the connection, and has no chunks.
        let request = match questions.next() {
            Command::Values => format!("GET /data HTTP/1.0\r\nHost: {at}\r\n\r\n"),
            other => {
                let word = other.word();
                let head = format!("POST /data HTTP/1.0\r\nHost: {at}\r\nContent-Type: text/plain");
                format!("{head}\r\nContent-Length: {}\r\n\r\n{word}", word.len())
            }
        };
        match send_question(&connect(at)?, &payload.taps.open(), &request, turn, ANSWER_MAX)? {
            Answer::Ended => {}
            _ if turn.is_wanted_within(EVERY) => return Ok(()),
            _ => return Err(io::Error::new(ErrorKind::TimedOut, format!("no complete answer for {ANSWER_MAX:?}"))),
        }
        if turn.is_wanted_within(EVERY) {
            return Ok(());
        }
    }
}

/// The progress of an answer.
enum Answer {
    /// The other side has closed the connection.
    Ended,
    TooLong,
    /// More bytes may follow.
    Open,
}

/// Sends a query, and reads the answer until this limit, unless a client wants its turn.
fn send_question(
    mut stream: &TcpStream,
    (number, tap): &(u32, Tap),
    question: &str,
    turn: &PollTurn<'_>,
    limit: Duration,
) -> io::Result<Answer> {
    tap.record_bytes(*number, true, question.as_bytes());
    stream.write_all(question.as_bytes())?;
    let (asked, mut length, mut piece) = (clock::now(), 0, [0; 4096]);
    while clock::since(asked) < limit && !turn.is_wanted_within(Duration::ZERO) {
        match stream.read(&mut piece) {
            Ok(0) => {
                tap.end(*number, false);
                return Ok(Answer::Ended);
            }
            Ok(count) => {
                tap.record_bytes(*number, false, &piece[..count]);
                length += count;
            }
            Err(e) if is_pause(&e) => {}
            Err(e) => return Err(e),
        }
        if length > ANSWER_LENGTH_MAX {
            return Ok(Answer::TooLong);
        }
    }
    Ok(Answer::Open)
}

/// A command in the sonde's format.
fn line(command: Command) -> String {
    format!("{}\r", command.word())
}
