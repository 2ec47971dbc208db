//! Statistics of an update, for every algorithm.

use crate::ppo::Statistics;

/// Statistics of an update, averaged over its samples. Values that an algorithm lacks are none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Learnt {
    /// The loss of the policy; for TD3 the negative value that its critic expects of its actions,
    /// in scaled rewards.
    pub policy_loss: Option<f32>,
    /// Value loss: half the mean squared error, in units of the standard deviation of returns for
    /// PPO and in scaled rewards for TD3; the mean Huber loss in scaled rewards for double DQN.
    pub value_loss: Option<f32>,
    /// Entropy of the policy, nats.
    pub entropy: Option<f32>,
    /// Divergence of the new policy from the old one, nats.
    pub divergence: Option<f32>,
    /// The share of samples that were clipped.
    pub clipped: Option<f32>,
    /// Number of epochs; with a replay buffer, the number of samples drawn per sample stored.
    pub epochs: Option<f32>,
}

impl Learnt {
    /// All values with their names in tables and curves.
    #[must_use]
    pub fn named(&self) -> [(&'static str, Option<f32>); 6] {
        [
            ("policy_loss", self.policy_loss),
            ("value_loss", self.value_loss),
            ("entropy", self.entropy),
            ("divergence", self.divergence),
            ("clipped", self.clipped),
            ("epochs", self.epochs),
        ]
    }
}

impl From<Statistics> for Learnt {
    fn from(statistics: Statistics) -> Learnt {
        Learnt {
            policy_loss: Some(statistics.policy_loss),
            value_loss: Some(statistics.value_loss),
            entropy: Some(statistics.entropy),
            divergence: Some(statistics.divergence),
            clipped: Some(statistics.clipped),
            epochs: Some(statistics.epochs),
        }
    }
}
