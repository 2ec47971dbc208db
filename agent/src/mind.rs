//! A mind: what decides for one boat.

use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use primitives::SimTime;
use scenario::strategy::Proposer;

/// What decides for one boat.
///
/// The same pictures, words and proposals, from the first on, must give the same orders on every machine: a mind reads no
/// clock and takes randomness only from its own [`primitives::stream::Stream`].
pub trait Mind: Send {
    /// Decides on the newest picture.
    fn decide(&mut self, picture: &Picture) -> Order;

    /// Whether the boat ever sends messages to its team: then it receives those of its mates too.
    fn shares(&self) -> bool {
        false
    }

    /// Who may propose courses and speeds to it, if anybody.
    fn proposer(&self) -> Option<Proposer> {
        None
    }

    /// Adds the messages to the team after a decision.
    fn send(&self, _messages: &mut Vec<Word>) {}

    /// Takes in what mates sent after the decision before.
    fn receive(&mut self, _messages: &[Word]) {}

    /// Takes in what a policy proposes.
    fn propose(&mut self, _proposal: Proposal) {}

    /// Whether somebody looks inside: from the next decision on the utilities of all functions are kept for
    /// [`Mind::report`].
    fn show(&mut self, _shown: bool) {}

    /// The state of its helm, if it has one.
    fn report(&self) -> Option<HelmReport> {
        None
    }
}

/// A course and a speed that a policy proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proposal {
    /// The time of the picture that it answers.
    pub at: SimTime,
    /// Desired course, rad clockwise from north.
    pub course_rad: f64,
    /// Desired speed, m/s.
    pub speed_m_s: f64,
}
