//! Whoever sees the games of an environment as they are played, such as a recorder.

use sim::Contest;
use std::sync::Arc;

/// What a game is shown for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moment {
    /// A decision is open, and nothing has been asked or done in it.
    Decision,
    /// The episode has ended at the decision that was shown last: the game is over, or was cut off.
    End,
}

/// Sees one game from its start on, decision by decision. It is dropped without an end where the game is given up.
pub type Watch = Box<dyn FnMut(&mut Contest, Moment) + Send>;

/// Who sees the game of a number, if anybody does. Numbers count up game by game and episode by episode.
pub type Watches = Arc<dyn Fn(u64) -> Option<Watch> + Send + Sync>;
