//! A game played again from what it was once given.

use crate::contest::Contest;
use crate::spawn::NoStart;
use game::event::EventCursor;
use game::input::Input;
use game::message::Frame;
use game::{Outcome, Scenario};

/// A game that is played again.
pub struct Resimulation {
    contest: Contest,
    shown: EventCursor,
}

impl Resimulation {
    /// The game of this scenario and its seed, before it begins.
    ///
    /// # Errors
    /// [`NoStart`] as when it was played.
    pub fn new(scenario: &Scenario) -> Result<Resimulation, NoStart> {
        Ok(Resimulation { contest: Contest::new(scenario, scenario.seed)?, shown: EventCursor::default() })
    }

    /// Gives it what it was given, and shows what comes of it: the truth, with the events since it was last shown.
    pub fn frame_after(&mut self, inputs: impl IntoIterator<Item = Input>) -> Frame {
        inputs.into_iter().for_each(|input| self.contest.give(input));
        self.contest.frame(&mut self.shown)
    }

    /// How it stands.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        self.contest.outcome()
    }
}
