//! A websocket: the shell around a conversation with one page.

use super::clock;
use super::conversation::Conversation;
use super::show::{Guest, News, Said, Show};
use axum::extract::ws::{Message, WebSocket};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, watch};
use tokio::time::{Instant, sleep_until, timeout};

/// The longest message from a page, bytes.
pub(super) const HEARD_MAX: usize = 16 * 1024;
/// A page that takes nothing for so long is gone.
const DEAF: Duration = Duration::from_secs(20);
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

/// Talks with a page until it goes, or the server does.
pub(super) async fn serve(mut socket: WebSocket, mut shown: Shown, guest: Guest, _place: OwnedSemaphorePermit) {
    let mut talk: Option<Conversation> = None;
    let end = loop {
        let show = shown.borrow_and_update().clone();
        let attended = match (show, &mut talk) {
            (None, _) => wait(&mut socket, &mut shown).await,
            (Some(show), Some(talk)) => {
                talk.show(&*show);
                attend(&mut socket, &mut shown, show.news(), talk).await
            }
            (Some(show), talk) => {
                let talk = talk.insert(Conversation::new(&*show, guest));
                attend(&mut socket, &mut shown, show.news(), talk).await
            }
        };
        if let Err(end) = attended {
            break end;
        }
    };
    if matches!(end, End::Closed) {
        // The page may be gone already.
        drop(timeout(GOODBYE, socket.send(Message::Close(None))).await);
    }
}

/// Waits until there is something to show.
async fn wait(socket: &mut WebSocket, shown: &mut Shown) -> Result<(), End> {
    loop {
        tokio::select! {
            changed = shown.changed() => return changed.map_err(|_| End::Closed),
            message = socket.recv() => if !matches!(message, Some(Ok(_))) {
                return Err(End::Gone);
            },
        }
    }
}

/// Talks about one show, until there is another.
async fn attend(socket: &mut WebSocket, shown: &mut Shown, news: &News, talk: &mut Conversation) -> Result<(), End> {
    let mut news = news.listen();
    let (mut heard, mut pinged) = (clock::now(), clock::now());
    loop {
        while let Some(said) = talk.say(clock::now()) {
            say(socket, said).await?;
        }
        let now = clock::now();
        let next = [talk.due(now), Some(pinged + PING)].into_iter().flatten().min().unwrap_or(now).max(now + BREATH);
        let breath = Instant::from_std(now + BREATH);
        tokio::select! {
            message = socket.recv() => {
                heard = clock::now();
                hear(talk, message)?;
            }
            changed = shown.changed() => return changed.map_err(|_| End::Closed),
            rung = async { sleep_until(breath).await; news.changed().await } => rung.map_err(|_| End::Gone)?,
            () = sleep_until(Instant::from_std(next)) => {}
        }
        let now = clock::now();
        if now.duration_since(pinged) >= PING {
            if now.duration_since(heard) >= DEAD {
                return Err(End::Gone);
            }
            pinged = now;
            send(socket, Message::Ping(axum::body::Bytes::new())).await?;
        }
    }
}

fn hear(talk: &mut Conversation, message: Option<Result<Message, axum::Error>>) -> Result<(), End> {
    match message {
        Some(Ok(Message::Text(text))) => talk.hear(&text, clock::now()),
        Some(Ok(Message::Binary(_))) => talk.hear_noise(),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => {}
        Some(Ok(Message::Close(_)) | Err(_)) | None => return Err(End::Gone),
    }
    Ok(())
}

async fn say(socket: &mut WebSocket, said: Said) -> Result<(), End> {
    let message = match said {
        Said::Text(text) => Message::Text(text.into()),
        Said::Past(bytes) | Said::Now(bytes) => Message::Binary(bytes),
    };
    send(socket, message).await
}

/// While a page is slow to take a message, nothing queues up behind it: what comes next is asked for afterwards.
async fn send(socket: &mut WebSocket, message: Message) -> Result<(), End> {
    match timeout(DEAF, socket.send(message)).await {
        Ok(Ok(())) => Ok(()),
        Ok(Err(_)) | Err(_) => Err(End::Gone),
    }
}
