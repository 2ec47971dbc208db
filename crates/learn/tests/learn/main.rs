//! Environments, networks, learning algorithms, training runs, and the shipped policies.
#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

mod environment;
mod fixture;
mod model;
mod off_policy;
mod off_policy_training;
mod parity;
mod ppo;
mod primitives;
mod seeds;
mod shipped;
mod train;
mod watch;
