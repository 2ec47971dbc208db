//! Watches: observers of an environment's games, such as a recorder.

use sim::Contest;
use std::sync::Arc;

/// The moment at which a watch is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// A decision is open; no input has been given in it yet.
    Decision,
    /// The episode has ended at the last decision: the game is over or was cut off.
    End,
}

/// Receives one game from its start on, decision by decision. Dropped without an end if the game is
/// abandoned.
pub type Watch = Box<dyn FnMut(&mut Contest, Moment) + Send>;

/// Creates the watch for the game with a number, if it is to be watched. Numbers count up game by
/// game and episode by episode.
pub type Watches = Arc<dyn Fn(u64) -> Option<Watch> + Send + Sync>;
