//! A trained policy on board: at each of its decisions it is given an observation, and chooses a course and a speed.

use crate::observation::Observer;
use crate::situation::Situation;
use onnx::Network;
use primitives::SimTime;
use scenario::action::{self, Action, ActionSpace, SetPoint};
use scenario::policy::PolicyModel;
use thiserror::Error;

/// Why a policy proposes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub(crate) enum PolicyFault {
    /// The model was made for teams of another size.
    #[error("the model takes {expected} numbers, and a boat of this game has {found}: it is for teams of another size")]
    Size {
        /// How many numbers the model takes.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The network gave a number that is none.
    #[error("the model gave a number that is NaN or infinite")]
    NotFinite,
}

/// A policy that decides for one boat.
pub(crate) struct BoardPolicy {
    model: PolicyModel,
    network: Network,
    /// Made at the first decision.
    observer: Option<Observer>,
    /// When it decides next; none: at once.
    due: Option<SimTime>,
    chosen: Result<Chosen, PolicyFault>,
}

/// What a policy chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Chosen {
    /// A course and a speed.
    SetPoint(SetPoint),
    /// One of the options of the strategy.
    Option(usize),
}

impl BoardPolicy {
    pub(crate) fn new(model: PolicyModel) -> BoardPolicy {
        let network = model.network();
        BoardPolicy { model, network, observer: None, due: None, chosen: Ok(Chosen::SetPoint(SetPoint::default())) }
    }

    /// Whether it decides at this time.
    pub(crate) fn is_due(&self, now: SimTime) -> bool {
        self.due.is_none_or(|due| now >= due)
    }

    /// Decides if it is time to.
    pub(crate) fn choose_if_due(&mut self, situation: &Situation) {
        if !self.is_due(situation.now) {
            return;
        }
        let period = SimTime::from_s(self.model.spec.period_s);
        // From decision to decision, not from picture to picture: lost ones move nothing.
        let next = self.due.map_or(situation.now, |due| due) + period;
        // After a long gap the decisions that fell into it are not made up for.
        self.due = Some(if next > situation.now { next } else { situation.now + period });
        self.chosen = self.choose(situation);
    }

    /// What it chose last.
    pub(crate) fn chosen(&self) -> Result<Chosen, PolicyFault> {
        self.chosen
    }

    fn choose(&mut self, situation: &Situation) -> Result<Chosen, PolicyFault> {
        let spec = self.model.spec;
        // Not before: how many numbers there are depends on the teams, which are known from the
        // situation.
        let observer = self.observer.get_or_insert_with(|| Observer::new(spec.observation, situation));
        let observation = observer.observe(situation);
        if observation.len() != self.model.input_size() {
            let (expected, found) = (self.model.input_size(), observation.len());
            return Err(PolicyFault::Size { expected, found });
        }
        self.network.evaluate(observation);
        let action = action_of(&self.model, self.network.output(self.model.output()))?;
        Ok(Chosen::of(spec.action, action, situation))
    }

    /// The model, and how sure it was of each discrete action; empty where actions are continuous.
    pub(crate) fn probabilities(&self) -> Vec<f32> {
        let output = self.network.output(self.model.output());
        if self.model.actions() != Some(output.len()) {
            return vec![];
        }
        action::probabilities(output)
    }

    /// The numbers that it was given last.
    pub(crate) fn observed(&self) -> &[f32] {
        self.observer.as_ref().map_or(&[], Observer::observed)
    }

    /// The model.
    pub(crate) fn model(&self) -> &PolicyModel {
        &self.model
    }
}

impl Chosen {
    /// What an action of this space asks for in a situation.
    pub(crate) fn of(space: ActionSpace, action: Action, situation: &Situation) -> Chosen {
        match (space, action) {
            (ActionSpace::Options, Action::Discrete(option)) => Chosen::Option(option),
            _ => {
                let (heading_rad, speed_max_m_s) = (situation.own.nav.psi_rad, situation.model.speed_max_m_s);
                Chosen::SetPoint(space.set_point(action, heading_rad, speed_max_m_s))
            }
        }
    }
}

/// The action that a network's output makes: the likeliest of the discrete ones.
fn action_of(model: &PolicyModel, output: &[f32]) -> Result<Action, PolicyFault> {
    // Checked on each output: a network may overflow on numbers that it was never trained on,
    // and of NaN the likeliest action would be the first.
    if !output.iter().all(|number| number.is_finite()) {
        return Err(PolicyFault::NotFinite);
    }
    Ok(match (model.actions(), output) {
        // The number of the action itself.
        (Some(count), [index]) if count > 1 => Action::Discrete(*index as usize),
        (Some(_), logits) => Action::likeliest(logits),
        (None, numbers) => Action::Continuous([0, 1].map(|i| numbers.get(i).copied().unwrap_or_default())),
    })
}
