//! What learns in a training: the policy of one algorithm, with all that its learning goes on from.

use super::off_policy::OffPolicy;
use crate::environment::Setup;
use crate::nn::Perceptron;
use crate::off_policy::Replay;
use crate::off_policy::dqn::DqnLearner;
use crate::off_policy::td3::{Numbers, Td3Learner, action};
use crate::ppo::ActorCritic;
use crate::training::{Algorithm, Dqn, Td3, Training};
use agent::Action;
use onnx::NetworkError;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The policy of one algorithm, with all that its learning goes on from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Learner {
    /// Proximal policy optimisation.
    Ppo(Box<ActorCritic>),
    /// The twin delayed deep deterministic policy gradient.
    Td3(Box<OffPolicy<Td3Learner, Td3, Numbers>>),
    /// Double deep Q-learning.
    Dqn(Box<OffPolicy<DqnLearner, Dqn, u16>>),
}

impl Learner {
    /// A new one of a training's algorithm for these games, whose policy chooses among this many actions.
    pub(super) fn new(training: &Training, setup: &Setup, actions: usize) -> Learner {
        let (hidden, seed) = (&training.network.hidden, training.seed);
        let observation = setup.observation_size();
        match training.algorithm() {
            Algorithm::Ppo(_) => {
                Learner::Ppo(Box::new(ActorCritic::new(observation, setup.state_size(), hidden, actions, seed)))
            }
            Algorithm::Td3(settings) => {
                let learner = Td3Learner::new(observation, hidden, seed);
                Learner::Td3(Box::new(OffPolicy {
                    learner,
                    replay: Replay::new(observation, settings.buffer),
                    settings,
                }))
            }
            Algorithm::Dqn(settings) => {
                let learner = DqnLearner::new(observation, hidden, actions, seed);
                Learner::Dqn(Box::new(OffPolicy {
                    learner,
                    replay: Replay::new(observation, settings.buffer),
                    settings,
                }))
            }
        }
    }

    /// The network that chooses.
    #[must_use]
    pub fn actor(&self) -> &Perceptron {
        match self {
            Learner::Ppo(learner) => &learner.actor,
            Learner::Td3(of) => &of.learner.actor,
            Learner::Dqn(of) => &of.learner.network,
        }
    }

    /// The policy as an ONNX file.
    pub(super) fn onnx(&self, metadata: BTreeMap<String, String>) -> Result<Vec<u8>, NetworkError> {
        match self {
            Learner::Ppo(learner) => learner.actor.onnx("logits", metadata),
            Learner::Td3(of) => of.learner.actor.onnx_bounded("action", metadata),
            Learner::Dqn(of) => of.learner.network.onnx("values", metadata),
        }
    }

    /// Forgets what does not hold in another stage: transitions of other games, rewards and helms.
    pub(super) fn begin_stage(&mut self) {
        match self {
            Learner::Ppo(_) => {}
            Learner::Td3(of) => of.replay.clear(),
            Learner::Dqn(of) => of.replay.clear(),
        }
    }
}

/// The action that a policy's output makes without exploration: the likeliest, or the one worth most, of discrete actions.
pub(super) fn greedy(is_discrete: bool, output: &[f32]) -> Action {
    if is_discrete { Action::likeliest(output) } else { Action::Continuous(action(output)) }
}
