//! Watches: observers of an environment's games, such as recorders.

use sim::Contest;
use std::sync::Arc;

/// When a watch is called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// A decision has opened, with no input yet.
    Decision,
    /// The episode has ended with the last decision: the game is over or was cut off.
    End,
}

/// Receives one game from its start, decision by decision. It is dropped without [`Moment::End`] if
/// the game is abandoned.
pub type Watch = Box<dyn FnMut(&mut Contest, Moment) + Send>;

/// Creates the watch of the game with this number, if the game is to be watched. Numbers count up
/// first across the games, then across their episodes.
pub type Watches = Arc<dyn Fn(u64) -> Option<Watch> + Send + Sync>;
