//! A trained policy on board: at each of its decisions, it receives an observation and chooses a
//! course and a speed.

use crate::observation::Observer;
use crate::situation::Situation;
use onnx::Network;
use primitives::SimTime;
use primitives::stream::Noise;
use scenario::action::{self, Action, ActionSpace, SetPoint};
use scenario::policy::PolicyModel;
use thiserror::Error;

/// Why a policy proposes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub(crate) enum PolicyFault {
    /// The model was trained for a different team size.
    #[error(
        "the model has {expected} inputs, but a boat in this game has {found} values: it was trained for a different team \
        size"
    )]
    Size {
        /// Number of inputs of the model.
        expected: usize,
        /// Number of values in the observation.
        found: usize,
    },
    /// The network returned a non-finite value.
    #[error("the model returned a non-finite value")]
    NotFinite,
}

/// The time of the next decision; `None` means at once.
#[derive(Clone, Default)]
pub(crate) struct Due(Option<SimTime>);

impl Due {
    pub(crate) fn is_due(&self, now: SimTime) -> bool {
        self.0.is_none_or(|due| now >= due)
    }

    /// Records that a decision is made now.
    pub(crate) fn advance(&mut self, now: SimTime, period: SimTime) {
        // Count from decision to decision, not from picture to picture, so that lost pictures do
        // not shift the schedule.
        let next = self.0.unwrap_or(now) + period;
        // After a long gap, missed decisions are not made up for.
        self.0 = Some(if next > now { next } else { now + period });
    }
}

/// A policy that decides for one boat.
#[derive(Clone)]
pub(crate) struct BoardPolicy {
    pub(crate) model: PolicyModel,
    network: Network,
    /// Created at the first decision.
    observer: Option<Observer>,
    due: Due,
    /// The last choice.
    pub(crate) chosen: Result<Chosen, PolicyFault>,
    /// Number of decisions so far.
    decisions: u64,
    is_sampled: bool,
}

/// A policy's choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Chosen {
    /// A course and a speed.
    SetPoint(SetPoint),
    /// The index of one of the strategy's options.
    Option(usize),
}

impl BoardPolicy {
    /// A policy that takes the most likely action, or samples it if `is_sampled`.
    pub(crate) fn new(model: PolicyModel, is_sampled: bool) -> BoardPolicy {
        let network = model.network();
        BoardPolicy {
            model,
            network,
            observer: None,
            due: Due::default(),
            chosen: Ok(Chosen::SetPoint(SetPoint::default())),
            decisions: 0,
            is_sampled,
        }
    }

    pub(crate) fn is_due(&self, now: SimTime) -> bool {
        self.due.is_due(now)
    }

    /// Decides if a decision is due.
    pub(crate) fn choose_if_due(&mut self, situation: &Situation) {
        if self.is_due(situation.now) {
            let period = SimTime::from_s(self.model.spec.period_s);
            self.due.advance(situation.now, period);
            self.chosen = self.choose(situation);
        }
    }

    fn choose(&mut self, situation: &Situation) -> Result<Chosen, PolicyFault> {
        let spec = self.model.spec;
        // Created late, because the observation size depends on the teams in the situation.
        let observer = self
            .observer
            .get_or_insert_with(|| Observer::new(spec.observation, situation));
        let observation = observer.observe(situation);
        if observation.len() != self.model.input_size() {
            let expected = self.model.input_size();
            let found = observation.len();
            return Err(PolicyFault::Size { expected, found });
        }
        self.network.evaluate(observation);
        let output = self.network.output(self.model.output());
        let likeliest = action_of(&self.model, output)?;
        let action = if self.is_sampled {
            // Use a separate stream for each boat, so that teammates with the same network draw
            // different actions.
            let me = situation.model.me;
            let noise = Noise::new(situation.model.seed, &format!("policy/{}", me.index()));
            Action::drawn(output, noise.unit(self.decisions))
        } else {
            likeliest
        };
        self.decisions += 1;
        Ok(Chosen::of(spec.action, action, situation))
    }

    /// The policy's probability for each discrete action; empty for continuous actions.
    pub(crate) fn probabilities(&self) -> Vec<f32> {
        if !self.model.has_logits() {
            return vec![];
        }
        action::probabilities(self.network.output(self.model.output()))
    }

    /// The last observation.
    pub(crate) fn observed(&self) -> &[f32] {
        self.observer
            .as_ref()
            .map_or(&[], |observer| &observer.frames)
    }
}

impl Chosen {
    /// Converts an action of this space to a choice in a situation.
    pub(crate) fn of(space: ActionSpace, action: Action, situation: &Situation) -> Chosen {
        match (space, action) {
            (ActionSpace::Options, Action::Discrete(option)) => Chosen::Option(option),
            _ => {
                let heading_rad = situation.own.nav.psi_rad;
                let speed_max_m_s = situation.model.speed_max_m_s;
                Chosen::SetPoint(space.set_point(action, heading_rad, speed_max_m_s))
            }
        }
    }
}

/// Converts a network output to an action; for discrete actions, the most likely one.
fn action_of(model: &PolicyModel, output: &[f32]) -> Result<Action, PolicyFault> {
    // Check every output: a network may overflow on inputs outside its training range, and the most
    // likely action of NaN outputs would be the first.
    if !output.iter().all(|number| number.is_finite()) {
        return Err(PolicyFault::NotFinite);
    }
    Ok(match (model.actions(), output) {
        // The index of the action.
        (Some(count), [index]) if count > 1 => Action::Discrete(*index as usize),
        (Some(_), logits) => Action::likeliest(logits),
        (None, numbers) => {
            Action::Continuous([0, 1].map(|i| numbers.get(i).copied().unwrap_or_default()))
        }
    })
}
