//! Settings of TD3 in training files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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
    /// Newest transitions in the replay buffer. Each takes 8 bytes per value of the observation plus
    /// about 20, in memory and in `state.bin`.
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
    /// Factor on rewards; values should be about 1 to 10.
    #[schemars(range(min = 0.000_001, max = 1_000_000), extend("default" = 1))]
    pub reward_scale: f32,
    /// Share of the learnt weights that target networks adopt per step of the policy's optimiser
    /// (Polyak averaging).
    #[schemars(range(min = 0, max = 1), extend("default" = 0.005))]
    pub target_rate: f32,
    /// Standard deviation of exploration noise on actions.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.1))]
    pub exploration: f32,
    /// Standard deviation of noise on the target policy's actions.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.2))]
    pub smoothing: f32,
    /// Limit of that noise.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.5))]
    pub smoothing_max: f32,
    /// Steps of the critics' optimisers per step of the policy's.
    #[schemars(range(min = 1, max = 1000), extend("default" = 2))]
    pub delay: u32,
}
