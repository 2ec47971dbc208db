//! What an update was like, whatever algorithm made it.

use crate::ppo::Statistics;

/// What an update was like, in the mean over its samples. What an algorithm does not have is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Learnt {
    /// The loss of the policy: of TD3 less what its critic expects of its actions, in scaled rewards.
    pub policy_loss: Option<f32>,
    /// How much what is expected was off: half its mean square, in units of the standard deviation of returns with PPO, and in scaled
    /// rewards with TD3; the mean of Huber's function in scaled rewards with double DQN.
    pub value_loss: Option<f32>,
    /// Entropy of the policy, nats.
    pub entropy: Option<f32>,
    /// How different the policy has become, nats.
    pub divergence: Option<f32>,
    /// The share of samples that were clipped.
    pub clipped: Option<f32>,
    /// How many times the samples were gone through; with a replay buffer, how many were drawn from it for each that went into it.
    pub epochs: Option<f32>,
}

impl Learnt {
    /// All of it with the names that it has in tables and curves.
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
