//! Settings of double DQN in training files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Newest transitions in the replay buffer. Each takes 8 bytes per value of the observation plus
    /// about 10, in memory and in `state.bin`.
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
    /// Factor on rewards; values should be about 1 to 10.
    #[schemars(range(min = 0.000_001, max = 1_000_000), extend("default" = 1))]
    pub reward_scale: f32,
    /// Optimiser steps between updates of the target network.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 500))]
    pub target_every: u32,
    /// Initial share of uniformly random actions.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub epsilon: f32,
    /// Final share of uniformly random actions.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.05))]
    pub epsilon_end: f32,
    /// Samples over which the share falls linearly.
    #[schemars(range(min = 1, max = 1_000_000_000_000_u64), extend("default" = 300_000))]
    pub epsilon_samples: u64,
}

impl Dqn {
    /// The share of uniformly random actions after this many samples.
    #[must_use]
    pub fn epsilon_after(&self, samples: u64) -> f32 {
        let done = (samples as f64 / self.epsilon_samples as f64).min(1.0) as f32;
        self.epsilon + (self.epsilon_end - self.epsilon) * done
    }
}
