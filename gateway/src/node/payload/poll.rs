//! Polls a sonde while no client is connected, so that its values are recorded anyway.

use super::Way;
use super::forward::{connect, is_pause};
use super::passed_payload::{Payload, Talk};
use super::shared_line::SharedLine;
use super::turn::PollTurn;
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

/// The gateway's conversation with the sonde, while it has the turn.
struct Questions<'a> {
    payload: &'a Payload,
    turn: &'a PollTurn<'a>,
    /// The state of the sonde when its parameters were queried, and when it was last polled.
    begun: Sonde,
    last: Sonde,
    unanswered: u32,
}

/// Polls the sonde whenever it has no client, until everything ends.
pub(super) fn run(payload: &Payload, way: &Way, exo2: Exo2Port) {
    while let Some(turn) = payload.turn.poll() {
        let sonde = payload.sonde().unwrap_or_default();
        let mut questions = Questions {
            payload,
            turn: &turn,
            begun: sonde.clone(),
            last: sonde,
            unanswered: 0,
        };
        let asked = match (way, exo2) {
            (Way::Tcp(at), Exo2Port::Http) => questions.by_http(at),
            (Way::Tcp(at), Exo2Port::Lines) => questions.by_lines(at),
            (Way::Shared(line), _) => {
                questions.over_line(line);
                Ok(())
            }
        };
        if let Err(e) = asked {
            payload.remark(&format!(
                "cannot query the sonde at {}: {e}",
                payload.port.address
            ));
        }
        // A client that connects gets the sonde at once: people come before the recording.
        turn.is_wanted_within(EVERY);
    }
}

impl Questions<'_> {
    /// Queries its parameters until it has reported them, then their values.
    fn next(&mut self) -> Command {
        let sonde = self.payload.sonde().unwrap_or_default();
        self.unanswered = if sonde == self.last {
            self.unanswered + 1
        } else {
            0
        };
        if self.unanswered > UNANSWERED_MAX {
            self.payload.remark(&format!(
                "the sonde does not answer `{}`",
                self.command(&sonde).word()
            ));
            (self.begun, self.unanswered) = (sonde.clone(), 0);
        }
        self.last = sonde;
        self.command(&self.last)
    }

    fn command(&self, sonde: &Sonde) -> Command {
        // Numbers mean nothing without the codes of their parameters, so these are queried first.
        if sonde.told == self.begun.told {
            Command::Parameters
        } else {
            Command::Values
        }
    }

    /// The next command in the sonde's format.
    fn next_line(&mut self) -> String {
        format!("{}\r", self.next().word())
    }

    /// Over one connection, line by line.
    fn by_lines(&mut self, at: &HostPort) -> io::Result<()> {
        let stream = connect(at)?;
        let connection = self.payload.open();
        while !self.turn.is_wanted_within(Duration::ZERO) {
            let line = self.next_line();
            match self.send(&stream, &connection, &line, EVERY)? {
                Answer::Ended => return Err(ErrorKind::ConnectionAborted.into()),
                // Limits the rate at which an endless answer is read.
                Answer::TooLong => drop(self.turn.is_wanted_within(EVERY)),
                Answer::Open => {}
            }
        }
        Ok(())
    }

    /// Over a line whose answers also reach its clients.
    fn over_line(&mut self, line: &SharedLine) {
        // The link has already reported its loss.
        while line.is_up() && line.send(0, self.next_line().as_bytes()) {
            if self.turn.is_wanted_within(EVERY) {
                break;
            }
        }
    }

    /// By HTTP, with a connection for each query.
    fn by_http(&mut self, at: &HostPort) -> io::Result<()> {
        loop {
            // HTTP/1.0: the answer ends with the connection, and has no chunks.
            let request = match self.next() {
                Command::Values => format!("GET /data HTTP/1.0\r\nHost: {at}\r\n\r\n"),
                other => {
                    let word = other.word();
                    let head =
                        format!("POST /data HTTP/1.0\r\nHost: {at}\r\nContent-Type: text/plain");
                    format!("{head}\r\nContent-Length: {}\r\n\r\n{word}", word.len())
                }
            };
            match self.send(&connect(at)?, &self.payload.open(), &request, ANSWER_MAX)? {
                Answer::Ended => {}
                _ if self.turn.is_wanted_within(EVERY) => return Ok(()),
                _ => {
                    return Err(io::Error::new(
                        ErrorKind::TimedOut,
                        format!("no complete answer for {ANSWER_MAX:?}"),
                    ));
                }
            }
            if self.turn.is_wanted_within(EVERY) {
                return Ok(());
            }
        }
    }

    /// Sends a query, and reads the answer until this limit, unless a client wants its turn.
    fn send(
        &self,
        mut stream: &TcpStream,
        (number, talk): &(u32, Talk),
        question: &str,
        limit: Duration,
    ) -> io::Result<Answer> {
        self.payload
            .record_bytes(talk, *number, true, question.as_bytes());
        stream.write_all(question.as_bytes())?;
        let asked = clock::now();
        let mut length = 0;
        let mut piece = [0; 4096];
        while clock::since(asked) < limit && !self.turn.is_wanted_within(Duration::ZERO) {
            match stream.read(&mut piece) {
                Ok(0) => {
                    self.payload.record_end(talk, *number, false);
                    return Ok(Answer::Ended);
                }
                Ok(count) => {
                    self.payload
                        .record_bytes(talk, *number, false, &piece[..count]);
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
}

/// The progress of an answer.
enum Answer {
    /// The other side has closed the connection.
    Ended,
    TooLong,
    /// More bytes may follow.
    Open,
}
