//! Double DQN (van Hasselt, Guez and Silver, AAAI 2016): a network estimates the value of each
//! discrete action, and a target network evaluates the action that the current network would choose
//! next.

use super::{Minibatch, Replay, Slope};
use crate::nn::{Adam, AdamSettings, Perceptron, SHARD, Trace};
use crate::ppo::choice::likeliest;
use crate::training::Dqn;
use primitives::stream::Stream;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A network with its target and its optimiser: the learning state without the replay buffer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DqnLearner {
    /// Maps an observation to the value of the rest of the episode after each action, in scaled
    /// rewards.
    pub network: Perceptron,
    /// The target network.
    pub target: Perceptron,
    optimiser: Adam,
    /// Number of optimiser steps.
    steps: u64,
}

impl DqnLearner {
    /// A new network of this shape.
    pub fn new(observation: usize, hidden: &[usize], actions: usize, seed: u64) -> DqnLearner {
        let sizes = [&[observation], hidden, &[actions]].concat();
        // Hyperbolic tangents, unlike in the paper, because a `Perceptron` has no other activation
        // function.
        let network = Perceptron::new(&sizes, 0.01, &mut Stream::new(seed, "actor"));
        let settings = AdamSettings {
            epsilon: 1e-8,
            norm_max: Some(10.0),
            ..AdamSettings::default()
        };
        let optimiser = Adam::new(network.parameters().len(), settings);
        DqnLearner {
            target: network.clone(),
            network,
            optimiser,
            steps: 0,
        }
    }

    /// Takes one optimiser step on transitions drawn from a buffer, in the calling thread pool.
    /// Returns the loss.
    pub fn update(&mut self, replay: &Replay<u16>, settings: &Dqn, stream: &mut Stream) -> f32 {
        self.step(&replay.draw(settings.minibatch, stream), settings)
    }

    /// Takes one optimiser step on these transitions. Returns the loss.
    pub fn step(&mut self, minibatch: &Minibatch<u16>, settings: &Dqn) -> f32 {
        let (gradient, loss) = self.gradient(minibatch, settings);
        self.optimiser.step(
            self.network.parameters_mut(),
            &gradient,
            settings.learning_rate,
        );
        self.steps += 1;
        if self.steps.is_multiple_of(u64::from(settings.target_every)) {
            self.target.clone_from(&self.network);
        }
        loss
    }

    /// The gradient with respect to the network's parameters, and the loss: the mean Huber loss (δ
    /// = 1) of the temporal-difference errors.
    pub fn gradient(&self, minibatch: &Minibatch<u16>, settings: &Dqn) -> (Vec<f32>, f32) {
        let size = self.network.sizes()[0];
        let slopes: Vec<Slope> = minibatch
            .observations
            .par_chunks(SHARD * size)
            .zip(minibatch.next_observations.par_chunks(SHARD * size))
            .enumerate()
            .map(|(i, (rows, next_rows))| {
                self.shard(minibatch, i * SHARD, (rows, next_rows), settings)
            })
            .collect();
        let slope = Slope::sum(slopes);
        (slope.gradient, slope.loss)
    }

    /// The contribution of one shard to the gradient, starting at transition `first`.
    fn shard(
        &self,
        minibatch: &Minibatch<u16>,
        first: usize,
        (rows, next_rows): (&[f32], &[f32]),
        settings: &Dqn,
    ) -> Slope {
        let sizes = self.network.sizes();
        let actions = sizes[sizes.len() - 1];
        let per_row = 1.0 / minibatch.count() as f32;
        let mut trace = Trace::default();
        let mut then = Trace::default();
        self.network.forward(next_rows, &mut trace);
        self.target.forward(next_rows, &mut then);
        let next = trace
            .output()
            .chunks_exact(actions)
            .zip(then.output().chunks_exact(actions));
        let expected: Vec<f32> = next.map(|(newer, older)| older[likeliest(newer)]).collect();
        self.network.forward(rows, &mut trace);
        let mut by_values = vec![0.0; trace.output().len()];
        let mut loss = 0.0;
        for (row, expected) in expected.into_iter().enumerate() {
            let i = first + row;
            let later = if minibatch.over[i] {
                0.0
            } else {
                settings.discount * expected
            };
            let place = row * actions + usize::from(minibatch.actions[i]);
            let off =
                trace.output()[place] - (settings.reward_scale * minibatch.rewards[i] + later);
            loss += huber(off) * per_row;
            by_values[place] = off.clamp(-1.0, 1.0) * per_row;
        }
        let mut gradient = vec![0.0; self.network.parameters().len()];
        self.network
            .backward(&trace, &mut by_values, &mut gradient, None);
        Slope { gradient, loss }
    }
}

/// The Huber loss: half the square up to 1, linear beyond.
fn huber(off: f32) -> f32 {
    let size = off.abs();
    if size <= 1.0 {
        0.5 * off * off
    } else {
        size - 0.5
    }
}

/// The most valuable action or, with probability `epsilon`, a random action.
pub fn explored(values: &[f32], epsilon: f32, stream: &mut Stream) -> usize {
    if stream.unit() < f64::from(epsilon) {
        stream.below(values.len() as u64) as usize
    } else {
        likeliest(values)
    }
}
