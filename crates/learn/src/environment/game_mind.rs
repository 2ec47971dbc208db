//! The mind of a boat in an environment: a pilot or a strategy.

use agent::{Mind, Pilot, Proposal};
use messages::helm::HelmReport;
use messages::{Order, Picture, Word};
use scenario::strategy::Proposer;

pub(super) enum GameMind {
    /// Acts on actions from outside, from a teacher or from a model.
    Pilot(Box<Pilot>),
    Strategy(Box<dyn Mind>),
}

impl GameMind {
    pub(super) fn pilot_mut(&mut self) -> Option<&mut Pilot> {
        match self {
            GameMind::Pilot(pilot) => Some(pilot),
            GameMind::Strategy(_) => None,
        }
    }

    fn mind(&self) -> &dyn Mind {
        match self {
            GameMind::Pilot(pilot) => &**pilot,
            GameMind::Strategy(mind) => &**mind,
        }
    }

    fn mind_mut(&mut self) -> &mut dyn Mind {
        match self {
            GameMind::Pilot(pilot) => &mut **pilot,
            GameMind::Strategy(mind) => &mut **mind,
        }
    }
}

impl Mind for GameMind {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.mind_mut().decide(picture)
    }

    fn shares(&self) -> bool {
        self.mind().shares()
    }

    fn proposer(&self) -> Option<Proposer> {
        self.mind().proposer()
    }

    fn send(&self, messages: &mut Vec<Word>) {
        self.mind().send(messages);
    }

    fn receive(&mut self, messages: &[Word]) {
        self.mind_mut().receive(messages);
    }

    fn propose(&mut self, proposal: Proposal) {
        self.mind_mut().propose(proposal);
    }

    fn show(&mut self, shown: bool) {
        self.mind_mut().show(shown);
    }

    fn report(&self) -> Option<HelmReport> {
        self.mind().report()
    }
}
