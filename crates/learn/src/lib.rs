//! Reinforcement learning of policies.
//!
//! [`environment`] offers games as environments, alone or in parallel batches. [`train`] performs
//! the training runs that [`training`] files define, with PPO ([`ppo`]), TD3 or double DQN
//! ([`off_policy`]). [`rewards`] files define the rewards. Everything is bit-for-bit reproducible
//! on any number of threads.

pub mod environment;
mod learnt;
pub mod nn;
pub mod off_policy;
pub mod ppo;
pub mod rewards;
pub mod train;
pub mod training;

pub use learnt::Learnt;
