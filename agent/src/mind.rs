//! A mind: the decision-maker of one boat.

use crate::situation::TeamView;
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::SimTime;
use scenario::strategy::Proposer;
use std::any::Any;
use std::sync::Arc;

/// The decision-maker of one boat.
///
/// Given identical pictures, messages and proposals from the start, it must return identical orders
/// on every machine. A mind reads no clock and takes randomness only from its own
/// [`primitives::stream::Stream`]. A mind whose decisions are made by other programs is only for
/// games paced by a clock.
pub trait Mind: Any + Send {
    /// Decides on the newest picture.
    fn decide(&mut self, picture: &Picture) -> Order;

    /// Like [`Mind::decide`], and with the same result. `view` is the team's view of the picture,
    /// if known, for a mind that would otherwise compute it.
    fn decide_in_team(&mut self, picture: &Picture, _view: Option<&Arc<TeamView>>) -> Order {
        self.decide(picture)
    }

    /// The current view of the mind's team, if it uses one.
    fn team_view(&self) -> Option<TeamView> {
        None
    }

    /// Whether the boat ever sends messages to its team; only then does it receive its teammates'
    /// messages.
    fn shares(&self) -> bool {
        false
    }

    /// Who may propose courses and speeds, if anyone.
    fn proposer(&self) -> Option<Proposer> {
        None
    }

    /// Adds the messages for the team after a decision.
    fn send(&self, _messages: &mut Vec<Word>) {}

    /// Receives the messages that teammates sent after the previous decision.
    fn receive(&mut self, _messages: &[Word]) {}

    /// Receives a policy's proposal.
    fn propose(&mut self, _proposal: Proposal) {}

    /// Turns inspection on or off. When on, [`Mind::report`] includes the utilities of all
    /// functions from the next decision on.
    fn show(&mut self, _shown: bool) {}

    /// A mind in the same state that continues independently; `None` if the mind cannot be copied.
    fn fork(&self) -> Option<Box<dyn Mind>> {
        None
    }

    /// The first fault of the program that decides for this mind, and the number of decisions with
    /// a fault.
    fn faults(&self) -> Option<(String, u64)> {
        None
    }

    /// The state of the mind's helm, if any.
    fn report(&self) -> Option<HelmReport> {
        None
    }
}

/// A course and a speed that a policy proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The time of the picture that the proposal answers.
    pub at: SimTime,
    /// Desired course, rad clockwise from north.
    pub course_rad: f64,
    /// Desired speed, m/s.
    pub speed_m_s: f64,
}
