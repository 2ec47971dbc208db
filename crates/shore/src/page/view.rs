//! Views of a page: a running game or a recording.

use super::message::Mode;
use super::request::PageRequest;
use axum::body::Bytes;
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Interval between messages with continuously changing values.
pub(super) const SEND_INTERVAL: Duration = Duration::from_millis(200);
/// Interval between helm reports to a page.
pub(super) const HELM_INTERVAL: Duration = Duration::from_millis(100);
/// Interval between updates of all boats' modes.
pub(super) const MODES_INTERVAL: Duration = Duration::from_secs(1);
/// Interval between estimated positions of a boat.
pub(super) const ESTIMATE_INTERVAL: Duration = Duration::from_millis(100);
/// Time between past frames for trails, simulated s.
pub(super) const TRAIL_STEP_S: f64 = 0.5;
/// Length of trails, simulated s.
pub(super) const TRAIL_S: f64 = 60.0;

/// A view that pages show.
pub trait View: Send + Sync {
    /// Opens a viewer for one page.
    fn open_viewer(&self, access: Access) -> Box<dyn Viewer>;
    /// Notifies viewers of possible changes.
    fn news(&self) -> &Changes;
}

/// The access of a page. Each level includes the previous ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// Watch only.
    Watch,
    /// Control the game: pause it, stop its boats, and steer boats that people may steer.
    Control,
    /// Operate real boats: arm them and give them tasks.
    Operate,
}

/// One page's view. Receives the time as an argument and never blocks.
pub trait Viewer: Send {
    /// Whether this is a game or a recording.
    fn mode(&self) -> Mode;

    /// Handles a request that the page's access permits.
    ///
    /// # Errors
    /// The reason if the request is refused.
    fn ask(&mut self, ask: &PageRequest, now: Instant) -> Result<(), String>;

    /// The next message, if any; replaceable messages only if the budget allows them.
    fn next_message(&mut self, now: Instant, budget: Budget) -> Option<Outgoing>;

    /// When the next message is due if nothing else happens.
    fn due(&self, now: Instant) -> Option<Instant>;
}

/// The replaceable messages that may be sent to a page now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Budget {
    /// Nothing.
    None,
    /// Frames.
    Frames,
    /// Frames and the repeated messages about the selected boat.
    All,
}

/// A message to a page, encoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outgoing {
    /// JSON.
    Text(String),
    /// A past frame with its leading byte.
    Past(Bytes),
    /// A current frame with its leading byte. The page acknowledges it once drawn.
    Now(Bytes),
}

impl Outgoing {
    /// Adds the byte that marks a past frame to its CDR.
    pub fn past(cdr: &[u8]) -> Outgoing {
        Outgoing::Past(marked(2, cdr))
    }

    /// Adds the byte that marks a current frame to its CDR.
    pub fn now(cdr: &[u8]) -> Outgoing {
        Outgoing::Now(marked(1, cdr))
    }
}

/// A frame with its leading byte, which states its purpose.
fn marked(byte: u8, cdr: &[u8]) -> Bytes {
    let mut bytes = Vec::with_capacity(1 + cdr.len());
    bytes.push(byte);
    bytes.extend_from_slice(cdr);
    bytes.into()
}

/// Notifies viewers of possible changes, from any thread.
pub type Changes = watch::Sender<()>;
