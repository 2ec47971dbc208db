//! The learning algorithm of a training run, selected by the table in its file.

use super::{Dqn, Ppo, Td3, Training};

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
    #[must_use]
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
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Algorithm::Ppo(_) => "ppo",
            Algorithm::Td3(_) => "td3",
            Algorithm::Dqn(_) => "dqn",
        }
    }

    /// Whether actions are discrete rather than continuous.
    #[must_use]
    pub fn is_discrete(&self) -> bool {
        !matches!(self, Algorithm::Td3(_))
    }

    /// Steps of every game per update.
    #[must_use]
    pub fn steps(&self) -> usize {
        match self {
            Algorithm::Ppo(ppo) => ppo.steps,
            Algorithm::Td3(td3) => td3.steps,
            Algorithm::Dqn(dqn) => dqn.steps,
        }
    }

    /// Value of a reward one step later.
    #[must_use]
    pub fn discount(&self) -> f32 {
        match self {
            Algorithm::Ppo(ppo) => ppo.discount,
            Algorithm::Td3(td3) => td3.discount,
            Algorithm::Dqn(dqn) => dqn.discount,
        }
    }
}
