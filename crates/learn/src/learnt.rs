//! Statistics of an update, for every algorithm.

/// Averages over the samples of an update. `None` if the algorithm has no such value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Learnt {
    /// The policy's loss. For TD3, the negative mean value of its actions according to the critic,
    /// in scaled rewards.
    pub policy_loss: Option<f32>,
    /// The critic's loss: for PPO, half the mean squared error of values in standard deviations of
    /// returns; for TD3, the same in scaled rewards; for double DQN, the mean Huber loss in scaled
    /// rewards.
    pub value_loss: Option<f32>,
    /// Entropy of the policy, nats.
    pub entropy: Option<f32>,
    /// KL divergence of the new policy from the old one, nats.
    pub divergence: Option<f32>,
    /// Fraction of clipped samples.
    pub clipped: Option<f32>,
    /// Fraction of the returns' variance that the critic explained before the update: 1 for a
    /// perfect critic, at most 0 for a useless one.
    pub explained_variance: Option<f32>,
    /// Epochs; with a replay buffer, samples drawn per sample stored.
    pub epochs: Option<f32>,
}

impl Learnt {
    /// All values with their names in tables and charts.
    pub fn named(&self) -> [(&'static str, Option<f32>); 7] {
        [
            ("policy_loss", self.policy_loss),
            ("value_loss", self.value_loss),
            ("entropy", self.entropy),
            ("divergence", self.divergence),
            ("clipped", self.clipped),
            ("epochs", self.epochs),
            ("explained_variance", self.explained_variance),
        ]
    }
}
