//! Learning: games as environments, and trainers of policies.

pub mod environment;
pub mod nn;
pub mod off_policy;
pub mod ppo;
pub mod rewards;
pub mod train;
pub mod training;
