//! What a page can look at.

use super::ask::Ask;
use super::tell::Mode;
use axum::body::Bytes;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// How often a page is told of things that change all the time.
pub(super) const TELL_AGAIN: Duration = Duration::from_millis(200);
/// How often a page is told what a helm thinks.
pub(super) const HELM_AGAIN: Duration = Duration::from_millis(500);
/// How often a page is told where a boat's own sensors put it.
pub(super) const ESTIMATE_AGAIN: Duration = Duration::from_millis(100);
/// The past that a page gets for trails: frames so far apart (simulated time), s.
pub(super) const TRAIL_STEP_S: f64 = 0.5;
/// How far it goes back (simulated time), s.
pub(super) const TRAIL_S: f64 = 60.0;

/// Something to look at: a game, or a recording of one.
pub trait Show: Send + Sync {
    /// A page begins to look.
    fn admit(&self, guest: Guest) -> Box<dyn Viewer>;
    /// Where it says that there may be something new for those who look.
    fn news(&self) -> &News;
}

/// A page that wants to look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guest {
    /// Whether it may act.
    pub rights: bool,
}

/// One page's look at a show. It is told the time, and never waits.
pub trait Viewer: Send {
    /// Whether this is a game or a recording.
    fn mode(&self) -> Mode;

    /// The page asks something that it may ask.
    ///
    /// # Errors
    /// Why it is not done.
    fn ask(&mut self, ask: &Ask, now: Instant) -> Result<(), String>;

    /// The next thing to say, if there is one now; what can wait only where there is room for it.
    fn say(&mut self, now: Instant, room: Room) -> Option<Said>;

    /// When there will be something to say though nothing is news.
    fn due(&self, now: Instant) -> Option<Instant>;
}

/// What a page can take now, of that which comes again newer if it is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Room {
    /// Nothing.
    None,
    /// Frames.
    Frames,
    /// Frames, and what is told again and again of the boat that is selected.
    All,
}

/// Something said to a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// JSON.
    Text(String),
    /// A frame of the past, with its first byte.
    Past(Bytes),
    /// A frame to be shown now, with its first byte. The page says when it is drawn.
    Now(Bytes),
}

impl Said {
    /// A frame of the past, from its CDR.
    #[must_use]
    pub fn past(cdr: &[u8]) -> Said {
        Said::Past(marked(2, cdr))
    }

    /// A frame to be shown now, from its CDR.
    #[must_use]
    pub fn now(cdr: &[u8]) -> Said {
        Said::Now(marked(1, cdr))
    }
}

/// A frame with the byte before it that says what it is for.
pub(super) fn marked(byte: u8, cdr: &[u8]) -> Bytes {
    let mut bytes = Vec::with_capacity(1 + cdr.len());
    bytes.push(byte);
    bytes.extend_from_slice(cdr);
    bytes.into()
}

/// A bell that a show rings when there may be something new for those who look at it.
#[derive(Clone, Debug)]
pub struct News(watch::Sender<()>);

impl Default for News {
    fn default() -> News {
        News(watch::Sender::new(()))
    }
}

impl News {
    /// Rings, from any thread; never waits.
    pub fn ring(&self) {
        self.0.send_replace(());
    }

    pub(super) fn listen(&self) -> watch::Receiver<()> {
        self.0.subscribe()
    }
}
