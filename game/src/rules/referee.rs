//! The referee: looks at all boats once a tick and says what happened.

use super::{Rules, Standing};
use crate::event::Event;
use crate::field::Field;
use crate::frame::Ned;
use crate::id::TeamId;
use crate::near::Pair;
use crate::time::SimTime;

/// Who judges a game: constant while it is played. What changes is the [`Standing`].
#[derive(Clone, Debug)]
pub struct Referee {
    rules: Rules,
    field: Field,
    team_of: Vec<TeamId>,
}

/// What the rules impose on one boat; the world (or a gateway) enforces it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directive {
    /// It does as its mind says, at no more than this share of its top speed.
    Free {
        /// Between 0 and 1.
        speed_factor: f64,
    },
}
