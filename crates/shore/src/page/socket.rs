//! A WebSocket: the I/O shell around the session of one page.

use super::report::Shown;
use super::routes::Room;
use super::session::PageSession;
use super::view::{Access, Changes, Outgoing};
use axum::extract::ws::{CloseFrame, Message, WebSocket, close_code};
use bus::{Slot, clock};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use std::pin::pin;
use std::time::Duration;
use tokio::time::{Instant, sleep_until, timeout};

/// Maximum size of a message from a page, bytes.
pub(super) const RECEIVED_MAX: usize = 16 * 1024;
/// Timeout for the close message.
const CLOSE_LIMIT: Duration = Duration::from_millis(100);
/// Interval between pings.
const PING: Duration = Duration::from_secs(15);
/// Silence after which a page is disconnected.
const DEAD: Duration = Duration::from_secs(45);
/// Minimum interval between messages: a game at full speed changes more often than a page can draw.
const MIN_INTERVAL: Duration = Duration::from_millis(4);

enum End {
    Gone,
    /// The server is closing.
    Closed,
    /// A different page needs the slot.
    Displaced,
}

/// The two halves of a socket, so that a page is read even while it is slow to accept data.
struct Socket {
    sink: SplitSink<WebSocket, Message>,
    incoming: Incoming,
}

/// The receiving half.
struct Incoming {
    stream: SplitStream<WebSocket>,
    slot: Slot,
    /// When the last message arrived.
    last_received: std::time::Instant,
}

/// Communicates with a page until it disconnects, the server closes, or a different page needs the
/// slot.
pub(super) async fn serve(
    socket: WebSocket,
    shown: Shown,
    access: Access,
    (slot, displaced): Room,
) {
    let (sink, stream) = socket.split();
    let mut socket = Socket {
        sink,
        incoming: Incoming {
            stream,
            slot,
            last_received: clock::now(),
        },
    };
    let end = tokio::select! {
        end = socket.talk(shown, access) => end,
        Ok(()) = displaced => End::Displaced,
    };
    let goodbye = match end {
        End::Gone => return,
        End::Closed => None,
        End::Displaced => Some(CloseFrame {
            code: close_code::AGAIN,
            reason: "another page needs the slot".into(),
        }),
    };
    // The page may have left already.
    drop(timeout(CLOSE_LIMIT, socket.sink.send(Message::Close(goodbye))).await);
}

impl Socket {
    /// Shows one view after another.
    async fn talk(&mut self, mut shown: Shown, access: Access) -> End {
        let mut session: Option<PageSession> = None;
        loop {
            let show = shown.receiver.borrow_and_update().clone();
            let ended = match show {
                None => self.wait(&mut shown).await,
                Some(show) => {
                    let viewer = show.open_viewer(access);
                    let session = match session.take() {
                        Some(before) => session.insert(before.show(viewer)),
                        None => session.insert(PageSession::new(viewer, access)),
                    };
                    self.run(&mut shown, show.news(), session).await
                }
            };
            if let Err(end) = ended {
                return end;
            }
        }
    }

    /// Waits for a view to show.
    async fn wait(&mut self, shown: &mut Shown) -> Result<(), End> {
        loop {
            tokio::select! {
                changed = shown.receiver.changed() => return changed.map_err(|_| End::Closed),
                message = self.incoming.stream.next() => if !matches!(message, Some(Ok(_))) {
                    return Err(End::Gone);
                },
            }
        }
    }

    /// Shows one view until it is replaced.
    async fn run(
        &mut self,
        shown: &mut Shown,
        news: &Changes,
        session: &mut PageSession,
    ) -> Result<(), End> {
        let mut news = news.subscribe();
        self.incoming.last_received = clock::now();
        let mut pinged = self.incoming.last_received;
        loop {
            while let Some(outgoing) = session.next_message(clock::now()) {
                self.send(message(outgoing), session).await?;
                if let Some(number) = session.ping() {
                    self.send(ping(number), session).await?;
                }
            }
            let now = clock::now();
            let next = [session.due(now), Some(pinged + PING)]
                .into_iter()
                .flatten()
                .min()
                .unwrap_or(now)
                .max(now + MIN_INTERVAL);
            let next_send = Instant::from_std(now + MIN_INTERVAL);
            tokio::select! {
                received = self.incoming.receive(session) => received?,
                changed = shown.receiver.changed() => return changed.map_err(|_| End::Closed),
                changed = async { sleep_until(next_send).await; news.changed().await } => changed.map_err(|_| End::Gone)?,
                () = sleep_until(Instant::from_std(next)) => {}
            }
            let now = clock::now();
            if now.duration_since(pinged) >= PING {
                if now.duration_since(self.incoming.last_received) >= DEAD {
                    return Err(End::Gone);
                }
                pinged = now;
                // A page may answer only the last of several pings.
                self.send(ping(session.last_ping()), session).await?;
            }
        }
    }

    /// Sends a message. While a page is slow to accept it, no other messages queue up; the next one
    /// is created afterwards. Messages from the page are still received, because one may be an
    /// E-stop. A connection that accepts no bytes times out.
    async fn send(&mut self, message: Message, session: &mut PageSession) -> Result<(), End> {
        // Send it completely, because a partial message cannot be withdrawn.
        let mut sending = pin!(self.sink.send(message));
        loop {
            tokio::select! {
                sent = &mut sending => return sent.map_err(|_| End::Gone),
                received = self.incoming.receive(session) => received?,
            }
        }
    }
}

impl Incoming {
    /// Waits for a message from the page and handles it.
    async fn receive(&mut self, session: &mut PageSession) -> Result<(), End> {
        let message = self.stream.next().await;
        self.last_received = clock::now();
        match message {
            Some(Ok(Message::Text(text))) => {
                // A page that shows a view acknowledges frames, so it is not idle.
                self.slot.touch();
                session.receive(&text, clock::now());
            }
            Some(Ok(Message::Binary(_))) => session.receive_binary(),
            Some(Ok(Message::Pong(number))) => {
                if let Ok(number) = number[..].try_into() {
                    session.receive_pong(u64::from_be_bytes(number));
                }
            }
            Some(Ok(Message::Ping(_))) => {}
            Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(End::Gone),
        }
        Ok(())
    }
}

fn message(outgoing: Outgoing) -> Message {
    match outgoing {
        Outgoing::Text(text) => Message::Text(text.into()),
        Outgoing::Past(bytes) | Outgoing::Now(bytes) => Message::Binary(bytes),
    }
}

/// Browsers return the same bytes automatically, in order of arrival.
fn ping(number: u64) -> Message {
    Message::Ping(number.to_be_bytes().to_vec().into())
}
