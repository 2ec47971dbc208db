//! What a page can show: a running game, or a recording.

use super::message::Mode;
use super::request::PageRequest;
use axum::body::Bytes;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// How often a page is sent values that change all the time.
pub(super) const SEND_INTERVAL: Duration = Duration::from_millis(200);
/// How often a page is sent the report of a helm.
pub(super) const HELM_INTERVAL: Duration = Duration::from_millis(500);
/// How often a page is sent the modes of all boats.
pub(super) const MODES_INTERVAL: Duration = Duration::from_secs(1);
/// How often a page is sent the estimated position of a boat.
pub(super) const ESTIMATE_INTERVAL: Duration = Duration::from_millis(100);
/// The past that a page gets for trails: frames so far apart (simulated time), s.
pub(super) const TRAIL_STEP_S: f64 = 0.5;
/// How far it goes back (simulated time), s.
pub(super) const TRAIL_S: f64 = 60.0;

/// Something that pages show.
pub trait View: Send + Sync {
    /// Opens a viewer for one page.
    fn open_viewer(&self, access: Access) -> Box<dyn Viewer>;
    /// Notifies viewers that there may be something new.
    fn news(&self) -> &Changes;
}

/// What a page may do; each may do what those before it may.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// Watch.
    Watch,
    /// Control the game: pause it, stop its boats, steer those that people steer.
    Control,
    /// Operate real boats: arm them, give them tasks.
    Operate,
}

/// One page's view. It gets the time as an argument, and never blocks.
pub trait Viewer: Send {
    /// Whether this is a game or a recording.
    fn mode(&self) -> Mode;

    /// The page asks something that it may ask.
    ///
    /// # Errors
    /// Why it is not done.
    fn ask(&mut self, ask: &PageRequest, now: Instant) -> Result<(), String>;

    /// The next message, if there is one now; what can wait only within the budget.
    fn next_message(&mut self, now: Instant, budget: Budget) -> Option<Outgoing>;

    /// When the next message is due, if nothing changes.
    fn due(&self, now: Instant) -> Option<Instant>;
}

/// What may be sent to a page now, of messages that newer ones replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Budget {
    /// Nothing.
    None,
    /// Frames.
    Frames,
    /// Frames, and the repeated messages about the selected boat.
    All,
}

/// A message to a page, encoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outgoing {
    /// JSON.
    Text(String),
    /// A frame of the past, with its first byte.
    Past(Bytes),
    /// A frame to be shown now, with its first byte. The page acknowledges it when it is drawn.
    Now(Bytes),
}

impl Outgoing {
    /// A frame of the past, from its CDR.
    #[must_use]
    pub fn past(cdr: &[u8]) -> Outgoing {
        Outgoing::Past(marked(2, cdr))
    }

    /// A frame to be shown now, from its CDR.
    #[must_use]
    pub fn now(cdr: &[u8]) -> Outgoing {
        Outgoing::Now(marked(1, cdr))
    }
}

/// A frame with its leading byte, which says what it is for.
pub(super) fn marked(byte: u8, cdr: &[u8]) -> Bytes {
    let mut bytes = Vec::with_capacity(1 + cdr.len());
    bytes.push(byte);
    bytes.extend_from_slice(cdr);
    bytes.into()
}

/// Notifies viewers that there may be something new: whatever is sent, from any thread.
pub type Changes = watch::Sender<()>;
