//! Training file settings of TD3, the twin delayed deep deterministic policy gradient (Fujimoto,
//! van Hoof and Meger, ICML 2018).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How updates are made: the twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML 2018), for continuous
/// actions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Td3 {
    /// Steps of every game to an update.
    #[schemars(range(min = 1, max = 65536), extend("default" = 16))]
    pub steps: usize,
    /// Steps of the optimiser to an update, each of one minibatch.
    #[schemars(range(min = 1, max = 100_000), extend("default" = 64))]
    pub minibatches: u32,
    /// Transitions to a step of the optimiser, drawn from the replay buffer.
    #[schemars(range(min = 1, max = 1_000_000), extend("default" = 512))]
    pub minibatch: usize,
    /// The newest transitions that the replay buffer keeps. In memory and in `state.bin` each takes 8 bytes for every number of the
    /// observation, and some 20 more.
    #[schemars(range(min = 1000, max = 10_000_000), extend("default" = 250_000))]
    pub buffer: usize,
    /// Nothing is learnt before the replay buffer has so many transitions; in the first stage actions are drawn uniformly until then.
    #[schemars(range(min = 1, max = 10_000_000), extend("default" = 20_000))]
    pub warm_up: usize,
    /// How far one step of the optimisers goes.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.0003))]
    pub learning_rate: f32,
    /// What a reward one step later is worth.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.995))]
    pub discount: f32,
    /// What rewards are multiplied with before anything is learnt from them: values should be about 1 to 10.
    #[schemars(range(min = 0.000_001, max = 1_000_000), extend("default" = 1))]
    pub reward_scale: f32,
    /// How far the target networks go towards the learnt ones with each step of the policy's optimiser (Polyak averaging).
    #[schemars(range(min = 0, max = 1), extend("default" = 0.005))]
    pub target_rate: f32,
    /// Standard deviation of the noise that is added to actions as they are played.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.1))]
    pub exploration: f32,
    /// Standard deviation of the noise that is added to the target policy's actions.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.2))]
    pub smoothing: f32,
    /// That noise is limited to this.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.5))]
    pub smoothing_max: f32,
    /// The policy learns with every so many steps of the critics' optimisers.
    #[schemars(range(min = 1, max = 1000), extend("default" = 2))]
    pub delay: u32,
}

impl Default for Td3 {
    fn default() -> Td3 {
        Td3 {
            steps: 16,
            minibatches: 64,
            minibatch: 512,
            buffer: 250_000,
            warm_up: 20_000,
            learning_rate: 3e-4,
            discount: 0.995,
            reward_scale: 1.0,
            target_rate: 0.005,
            exploration: 0.1,
            smoothing: 0.2,
            smoothing_max: 0.5,
            delay: 2,
        }
    }
}
