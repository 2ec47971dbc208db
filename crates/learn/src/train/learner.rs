//! The learner of a training run: a policy with the whole learning state of its algorithm.

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

/// A policy with the whole learning state of its algorithm.
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
    pub(super) fn new(training: &Training, setup: &Setup, actions: usize) -> Learner {
        let hidden = &training.network.hidden;
        let seed = training.seed;
        let observation = setup.observation_size();
        match training.algorithm() {
            Algorithm::Ppo(_) => Learner::Ppo(Box::new(ActorCritic::new(
                observation,
                setup.state_size(),
                hidden,
                actions,
                seed,
            ))),
            Algorithm::Td3(settings) => {
                let learner = Td3Learner::new(observation, hidden, seed);
                let replay = Replay::new(observation, settings.buffer);
                Learner::Td3(Box::new(OffPolicy {
                    learner,
                    settings,
                    replay,
                }))
            }
            Algorithm::Dqn(settings) => {
                let learner = DqnLearner::new(observation, hidden, actions, seed);
                let replay = Replay::new(observation, settings.buffer);
                Learner::Dqn(Box::new(OffPolicy {
                    learner,
                    settings,
                    replay,
                }))
            }
        }
    }

    /// The network that chooses actions.
    pub fn actor(&self) -> &Perceptron {
        match self {
            Learner::Ppo(learner) => &learner.actor,
            Learner::Td3(of) => &of.learner.actor,
            Learner::Dqn(of) => &of.learner.network,
        }
    }

    pub(super) fn onnx(&self, metadata: BTreeMap<String, String>) -> Result<Vec<u8>, NetworkError> {
        match self {
            Learner::Ppo(learner) => learner.actor.onnx("logits", false, metadata),
            Learner::Td3(of) => of.learner.actor.onnx("action", true, metadata),
            Learner::Dqn(of) => of.learner.network.onnx("values", false, metadata),
        }
    }

    /// Discards transitions of the previous stage, whose games, rewards and helms differ.
    pub(super) fn begin_stage(&mut self) {
        match self {
            Learner::Ppo(_) => {}
            Learner::Td3(of) => of.replay.clear(),
            Learner::Dqn(of) => of.replay.clear(),
        }
    }
}

/// Converts a policy's output to an action without exploration: the most likely or most valuable
/// discrete action, or the continuous action.
pub(super) fn greedy(is_discrete: bool, output: &[f32]) -> Action {
    if is_discrete {
        Action::likeliest(output)
    } else {
        Action::Continuous(action(output))
    }
}
