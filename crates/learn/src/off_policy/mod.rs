//! Off-policy algorithms: the policy learns from transitions in a replay buffer, which may come
//! from any policy.
//!
//! As in PPO, rows are processed in shards of a fixed size. Gradients are summed in order, so that
//! training gives the same bits on any number of threads.

pub mod dqn;
mod replay;
pub mod td3;

pub use replay::{Minibatch, Replay, Transition};

/// The gradient of a loss and the loss, summed over a shard's rows.
#[derive(Clone, Debug, Default)]
struct Slope {
    gradient: Vec<f32>,
    loss: f32,
}

impl Slope {
    /// Sums all shards in order.
    fn sum(shards: impl IntoIterator<Item = Slope>) -> Slope {
        let mut shards = shards.into_iter();
        let mut all = shards.next().unwrap_or_default();
        for shard in shards {
            all.loss += shard.loss;
            all.gradient
                .iter_mut()
                .zip(&shard.gradient)
                .for_each(|(sum, number)| *sum += number);
        }
        all
    }
}
