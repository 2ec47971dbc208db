//! The learning algorithm of a training run, selected by a table in its file, and its settings.

use super::Training;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An algorithm with its settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Algorithm {
    /// Proximal policy optimisation.
    Ppo(Ppo),
    /// The twin delayed deep deterministic policy gradient.
    Td3(Td3),
    /// Double deep Q-learning.
    Dqn(Dqn),
}

impl Training {
    /// The algorithm of the training.
    pub fn algorithm(&self) -> Algorithm {
        match (self.td3, self.dqn) {
            (Some(td3), _) => Algorithm::Td3(td3),
            (None, Some(dqn)) => Algorithm::Dqn(dqn),
            (None, None) => Algorithm::Ppo(self.ppo),
        }
    }
}

impl Algorithm {
    /// The name of the algorithm's table.
    pub fn name(&self) -> &'static str {
        match self {
            Algorithm::Ppo(_) => "ppo",
            Algorithm::Td3(_) => "td3",
            Algorithm::Dqn(_) => "dqn",
        }
    }

    /// Whether actions are discrete rather than continuous.
    pub fn is_discrete(&self) -> bool {
        !matches!(self, Algorithm::Td3(_))
    }

    /// Steps of every game per update.
    pub fn steps(&self) -> usize {
        match self {
            Algorithm::Ppo(ppo) => ppo.steps,
            Algorithm::Td3(td3) => td3.steps,
            Algorithm::Dqn(dqn) => dqn.steps,
        }
    }

    /// The discount factor per step.
    pub fn discount(&self) -> f32 {
        match self {
            Algorithm::Ppo(ppo) => ppo.discount,
            Algorithm::Td3(td3) => td3.discount,
            Algorithm::Dqn(dqn) => dqn.discount,
        }
    }
}

/// Proximal policy optimisation (Schulman and others, arXiv 1707.06347).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ppo {
    /// Steps of every game per update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub steps: usize,
    /// Initial step size of the optimiser.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// Final step size as a fraction of the initial one; it falls linearly.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.1))]
    pub learning_rate_end: f32,
    /// Limit of the relative change of an action's probability.
    #[schemars(range(min = 0.001, max = 1), extend("default" = 0.2))]
    pub clip: f32,
    /// Passes over the samples.
    #[schemars(range(min = 1, max = 100), extend("default" = 4))]
    pub epochs: u32,
    /// Samples per optimiser step.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 2048))]
    pub minibatch: usize,
    /// Weight of the policy's entropy, per nat.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.01))]
    pub entropy: f32,
    /// Divergence of the policy at which an update ends early, nats.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub divergence_max: f32,
    /// Discount factor per step.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// λ of generalised advantage estimation.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.95))]
    pub lambda: f32,
}

/// Twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML 2018), for
/// continuous actions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Td3 {
    /// Steps of every game per update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 16))]
    pub steps: usize,
    /// Optimiser steps per update, one minibatch each.
    #[schemars(range(min = 1, max = 100_000), extend("default" = 64))]
    pub minibatches: u32,
    /// Transitions per optimiser step, drawn from the replay buffer.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 512))]
    pub minibatch: usize,
    /// Size of the replay buffer, in transitions; the newest are kept. Each takes 8 bytes per value
    /// of the observation plus about 20, in memory and in `state.bin`.
    #[schemars(range(min = 1000, max = 10_000_000), extend("default" = 250_000))]
    pub buffer: usize,
    /// Transitions in the replay buffer before learning starts; until then, actions in the first
    /// stage are uniformly random.
    #[schemars(range(min = 1, max = 10_000_000), extend("default" = 20_000))]
    pub warm_up: usize,
    /// Step size of the optimisers.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// Discount factor per step.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// Factor on rewards; choose it so that the values that critics learn are about 1 to 10.
    #[schemars(range(min = 0.000_001, max = 1_000_000), extend("default" = 1))]
    pub reward_scale: f32,
    /// Fraction of the learned weights that target networks adopt per step of the policy's
    /// optimiser (Polyak averaging).
    #[schemars(range(min = 0, max = 1), extend("default" = 0.005))]
    pub target_rate: f32,
    /// Standard deviation of exploration noise on actions.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.1))]
    pub exploration: f32,
    /// Standard deviation of noise on the target policy's actions.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.2))]
    pub smoothing: f32,
    /// Limit of the smoothing noise.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.5))]
    pub smoothing_max: f32,
    /// Steps of the critics' optimisers per step of the policy's.
    #[schemars(range(min = 1, max = 1000), extend("default" = 2))]
    pub delay: u32,
}

/// Double deep Q-learning (van Hasselt, Guez and Silver, AAAI 2016), for discrete actions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Dqn {
    /// Steps of every game per update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 16))]
    pub steps: usize,
    /// Optimiser steps per update, one minibatch each.
    #[schemars(range(min = 1, max = 100_000), extend("default" = 64))]
    pub minibatches: u32,
    /// Transitions per optimiser step, drawn from the replay buffer.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 512))]
    pub minibatch: usize,
    /// Size of the replay buffer, in transitions; the newest are kept. Each takes 8 bytes per value
    /// of the observation plus about 10, in memory and in `state.bin`.
    #[schemars(range(min = 1000, max = 10_000_000), extend("default" = 250_000))]
    pub buffer: usize,
    /// Transitions in the replay buffer before learning starts.
    #[schemars(range(min = 1, max = 10_000_000), extend("default" = 20_000))]
    pub warm_up: usize,
    /// Step size of the optimiser.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// Discount factor per step.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// Factor on rewards; choose it so that the values that critics learn are about 1 to 10.
    #[schemars(range(min = 0.000_001, max = 1_000_000), extend("default" = 1))]
    pub reward_scale: f32,
    /// Optimiser steps between updates of the target network.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 500))]
    pub target_every: u32,
    /// Initial fraction of uniformly random actions.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub epsilon: f32,
    /// Final fraction of uniformly random actions.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.05))]
    pub epsilon_end: f32,
    /// Samples over which the fraction of random actions falls linearly.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64), extend("default" = 300_000))]
    pub epsilon_samples: u64,
}

impl Dqn {
    /// The fraction of uniformly random actions after this many samples.
    pub fn epsilon_after(&self, samples: u64) -> f32 {
        let done = (samples as f64 / self.epsilon_samples as f64).min(1.0) as f32;
        self.epsilon + (self.epsilon_end - self.epsilon) * done
    }
}
