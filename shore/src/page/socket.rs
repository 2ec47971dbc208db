//! A websocket: the shell around a conversation with one page.

use super::clock;
use super::conversation::Conversation;
use super::show::{Guest, News, Said, Show};
use axum::extract::ws::{Message, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{Instant, sleep_until, timeout};

/// The longest message from a page, bytes.
pub(super) const HEARD_MAX: usize = 16 * 1024;
/// How long a good-bye may take.
const GOODBYE: Duration = Duration::from_millis(100);
/// How often a page is asked for a sign of life.
const PING: Duration = Duration::from_secs(15);
/// A page that gives none for so long is gone.
const DEAD: Duration = Duration::from_secs(45);
/// A game that goes as fast as can be has news more often than a page can draw: it is told no more often than this.
const BREATH: Duration = Duration::from_millis(4);

/// What is shown now, if anything is yet. Its end is that of the server.
pub(super) type Shown = watch::Receiver<Option<Arc<dyn Show>>>;

/// What ends the talk with a page.
enum End {
    /// The page is gone.
    Gone,
    /// The server closes.
    Closed,
}

/// The two ends of a socket: a page is heard while it is slow to take what it is told.
struct Wire {
    sink: SplitSink<WebSocket, Message>,
    stream: SplitStream<WebSocket>,
    /// When the page was heard last.
    heard: std::time::Instant,
}

/// Talks with a page until it goes, or the server does.
pub(super) async fn serve(socket: WebSocket, mut shown: Shown, guest: Guest, _place: OwnedSemaphorePermit) {
    let (sink, stream) = socket.split();
    let mut wire = Wire { sink, stream, heard: clock::now() };
    let mut talk: Option<Conversation> = None;
    let end = loop {
        let show = shown.borrow_and_update().clone();
        let attended = match (show, &mut talk) {
            (None, _) => wire.wait(&mut shown).await,
            (Some(show), Some(talk)) => {
                talk.show(&*show);
                wire.attend(&mut shown, show.news(), talk).await
            }
            (Some(show), talk) => {
                let talk = talk.insert(Conversation::new(&*show, guest));
                wire.attend(&mut shown, show.news(), talk).await
            }
        };
        if let Err(end) = attended {
            break end;
        }
    };
    if matches!(end, End::Closed) {
        // The page may be gone already.
        drop(timeout(GOODBYE, wire.sink.send(Message::Close(None))).await);
    }
}

impl Wire {
    /// Waits until there is something to show.
    async fn wait(&mut self, shown: &mut Shown) -> Result<(), End> {
        loop {
            tokio::select! {
                changed = shown.changed() => return changed.map_err(|_| End::Closed),
                message = self.stream.next() => if !matches!(message, Some(Ok(_))) {
                    return Err(End::Gone);
                },
            }
        }
    }

    /// Talks about one show, until there is another.
    async fn attend(&mut self, shown: &mut Shown, news: &News, talk: &mut Conversation) -> Result<(), End> {
        let mut news = news.listen();
        self.heard = clock::now();
        let mut pinged = self.heard;
        loop {
            while let Some(said) = talk.say(clock::now()) {
                self.send(message(said), talk).await?;
                if let Some(mark) = talk.mark() {
                    self.send(ping(mark), talk).await?;
                }
            }
            let now = clock::now();
            let next =
                [talk.due(now), Some(pinged + PING)].into_iter().flatten().min().unwrap_or(now).max(now + BREATH);
            let breath = Instant::from_std(now + BREATH);
            tokio::select! {
                message = self.stream.next() => {
                    self.heard = clock::now();
                    hear(talk, message)?;
                }
                changed = shown.changed() => return changed.map_err(|_| End::Closed),
                rung = async { sleep_until(breath).await; news.changed().await } => rung.map_err(|_| End::Gone)?,
                () = sleep_until(Instant::from_std(next)) => {}
            }
            let now = clock::now();
            if now.duration_since(pinged) >= PING {
                if now.duration_since(self.heard) >= DEAD {
                    return Err(End::Gone);
                }
                pinged = now;
                // Of several pings a page may answer the last only.
                self.send(ping(talk.last_mark()), talk).await?;
            }
        }
    }

    /// While a page is slow to take a message, nothing queues up behind it: what comes next is asked for afterwards. What
    /// the page asks meanwhile is heard: it may be an emergency. A line that takes nothing at all is cut by itself.
    async fn send(&mut self, message: Message, talk: &mut Conversation) -> Result<(), End> {
        // It is sent whole: what is half sent cannot be taken back.
        let mut sending = pin!(self.sink.send(message));
        loop {
            tokio::select! {
                sent = &mut sending => return sent.map_err(|_| End::Gone),
                message = self.stream.next() => {
                    self.heard = clock::now();
                    hear(talk, message)?;
                }
            }
        }
    }
}

fn hear(talk: &mut Conversation, message: Option<Result<Message, axum::Error>>) -> Result<(), End> {
    match message {
        Some(Ok(Message::Text(text))) => talk.hear(&text, clock::now()),
        Some(Ok(Message::Binary(_))) => talk.hear_noise(),
        Some(Ok(Message::Pong(mark))) => {
            if let Ok(mark) = mark[..].try_into() {
                talk.hear_mark(u64::from_be_bytes(mark));
            }
        }
        Some(Ok(Message::Ping(_))) => {}
        Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(End::Gone),
    }
    Ok(())
}

fn message(said: Said) -> Message {
    match said {
        Said::Text(text) => Message::Text(text.into()),
        Said::Past(bytes) | Said::Now(bytes) => Message::Binary(bytes),
    }
}

/// Browsers answer it with the same bytes by themselves, in the order in which things arrive.
fn ping(mark: u64) -> Message {
    Message::Ping(mark.to_be_bytes().to_vec().into())
}
