//! A browser's side of the protocol.

use bus::clock::now;
use serde_json::Value;
use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;
use tungstenite::client::IntoClientRequest;
use tungstenite::http::{HeaderName, HeaderValue};
use tungstenite::{Error, Message, WebSocket};

/// Limit of every wait.
const LIMIT: Duration = Duration::from_secs(30);
/// Time without messages that counts as silence.
const QUIET: Duration = Duration::from_secs(1);

pub(crate) struct Client {
    socket: WebSocket<TcpStream>,
}

impl Client {
    /// Opens a WebSocket at this path with these headers, or returns the status of the response.
    pub(crate) fn connect(
        address: SocketAddr,
        path: &str,
        headers: &[(&str, &str)],
    ) -> Result<Client, u16> {
        let mut request = format!("ws://{address}{path}")
            .into_client_request()
            .expect("a valid request");
        for (name, value) in headers {
            let name: HeaderName = name.parse().expect("a header");
            request
                .headers_mut()
                .insert(name, HeaderValue::from_str(value).expect("a value"));
        }
        let stream = TcpStream::connect(address).expect("the server listens");
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => {
                socket
                    .get_ref()
                    .set_read_timeout(Some(Duration::from_millis(20)))
                    .expect("the timeout is valid");
                Ok(Client { socket })
            }
            Err(tungstenite::HandshakeError::Failure(Error::Http(response))) => {
                Err(response.status().as_u16())
            }
            Err(other) => panic!("{other}"),
        }
    }

    pub(crate) fn send(&mut self, json: &str) {
        self.socket
            .send(Message::text(json))
            .expect("the server accepts it");
    }

    pub(crate) fn send_raw(&mut self, message: Message) -> Result<(), Error> {
        self.socket.send(message)
    }

    pub(crate) fn ack(&mut self) {
        self.send(r#"{"do":"ack"}"#);
    }

    /// The next message within `limit`, if any, or an error if the server has closed.
    fn next_within(&mut self, limit: Duration) -> Result<Option<Message>, Error> {
        let end = now() + limit;
        while now() < end {
            match self.socket.read() {
                Ok(Message::Ping(_) | Message::Pong(_)) => {}
                Ok(message) => return Ok(Some(message)),
                Err(Error::Io(e))
                    if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                Err(e) => return Err(e),
            }
        }
        Ok(None)
    }

    /// The next message, which must arrive.
    pub(crate) fn next(&mut self) -> Message {
        self.next_within(LIMIT)
            .expect("the connection is open")
            .expect("a message arrives in time")
    }

    /// The next message, which must be a text message.
    pub(crate) fn text(&mut self) -> Value {
        match self.next() {
            Message::Text(text) => serde_json::from_str(&text).expect("texts are JSON"),
            other => panic!("expected text, got {other:?}"),
        }
    }

    /// The next text message of this kind that satisfies `is_good`. Skips all others and
    /// acknowledges frames.
    pub(crate) fn until(&mut self, kind: &str, is_good: impl Fn(&Value) -> bool) -> Value {
        let end = now() + LIMIT;
        let mut last = Value::Null;
        while now() < end {
            match self.next() {
                Message::Text(text) => {
                    let value: Value = serde_json::from_str(&text).expect("texts are JSON");
                    if value["kind"] == kind && is_good(&value) {
                        return value;
                    }
                    last = if value["kind"] == kind { value } else { last };
                }
                Message::Binary(bytes) if bytes.first() == Some(&1) => self.ack(),
                _ => {}
            }
        }
        panic!("no such {kind} in time; last: {last}");
    }

    /// The next refusal, whose reason must contain `why`.
    pub(crate) fn is_refused(&mut self, why: &str) -> Value {
        let refused = self.until("refused", |_| true);
        assert!(
            refused["reason"]
                .as_str()
                .is_some_and(|reason| reason.contains(why)),
            "{why}: {refused}"
        );
        refused
    }

    /// The next frame with its leading byte. Skips text messages.
    pub(crate) fn frame(&mut self) -> Vec<u8> {
        loop {
            if let Message::Binary(bytes) = self.next() {
                return bytes.to_vec();
            }
        }
    }

    /// All messages until the connection is quiet.
    pub(crate) fn rest(&mut self) -> Vec<Message> {
        std::iter::from_fn(|| self.next_within(QUIET).ok().flatten()).collect()
    }

    /// The close code, if the server closes in time and sends one.
    pub(crate) fn close_code(&mut self) -> Option<u16> {
        loop {
            match self.next_within(LIMIT) {
                Ok(Some(Message::Close(said))) => return said.map(|said| said.code.into()),
                Ok(Some(_)) => {}
                Ok(None) | Err(_) => return None,
            }
        }
    }

    /// Whether the server closes in time.
    pub(crate) fn is_hung_up_on(&mut self) -> bool {
        loop {
            match self.next_within(LIMIT) {
                Err(_) => return true,
                Ok(None) => return false,
                Ok(Some(_)) => {}
            }
        }
    }
}

/// Requests a file as a browser does. Returns the status and the whole response.
pub(crate) fn get(address: SocketAddr, path: &str, host: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(address).expect("the server listens");
    stream
        .set_read_timeout(Some(LIMIT))
        .expect("a socket has time-outs");
    let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
    stream
        .write_all(request.as_bytes())
        .expect("the server listens");
    let mut answer = String::new();
    stream
        .read_to_string(&mut answer)
        .expect("the response is text");
    let status = answer
        .split(' ')
        .nth(1)
        .and_then(|status| status.parse().ok())
        .expect("a status");
    (status, answer)
}
