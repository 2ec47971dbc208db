//! TD3, the twin delayed deep deterministic policy gradient (Fujimoto, van Hoof and Meger, ICML
//! 2018): a policy with continuous actions, and two critics that estimate their value.

use super::{Minibatch, Replay, Slope};
use crate::nn::{Adam, AdamSettings, Perceptron, SHARD, Trace};
use crate::training::Td3;
use onnx::tanh;
use primitives::stream::Stream;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Dimension of an action.
pub const NUMBERS: usize = 2;

/// An action; each component is from -1 to 1.
pub type Numbers = [f32; NUMBERS];

/// A policy and its critics, with their targets and optimisers: the learning state without the
/// replay buffer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Td3Learner {
    /// Maps an observation to numbers whose hyperbolic tangents are the action.
    pub actor: Perceptron,
    /// Map an observation and an action to the value of the rest of the episode, in scaled rewards.
    pub critics: [Perceptron; 2],
    /// The target policy, which slowly follows the policy.
    pub target_actor: Perceptron,
    /// The target critics.
    pub target_critics: [Perceptron; 2],
    actor_optimiser: Adam,
    critic_optimisers: [Adam; 2],
    /// Number of steps of the critics' optimisers.
    steps: u64,
}

/// The losses of one optimiser step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Td3Losses {
    /// Half the mean squared error, averaged over both critics.
    pub critic: f32,
    /// The negative mean value of the policy's actions according to the first critic. `None` if the
    /// step did not update the policy.
    pub actor: Option<f32>,
}

impl Td3Learner {
    /// A new policy with this number of inputs.
    pub fn new(observation: usize, hidden: &[usize], seed: u64) -> Td3Learner {
        let sizes = |from: usize, to: usize| [&[from], hidden, &[to]].concat();
        let actor = Perceptron::new(
            &sizes(observation, NUMBERS),
            0.01,
            &mut Stream::new(seed, "actor"),
        );
        let critic = |name| {
            Perceptron::new(
                &sizes(observation + NUMBERS, 1),
                1.0,
                &mut Stream::new(seed, name),
            )
        };
        let critics = ["critic/one", "critic/two"].map(critic);
        let optimiser = |network: &Perceptron| {
            // No gradient clipping, as in the paper.
            let settings = AdamSettings {
                epsilon: 1e-8,
                norm_max: None,
                ..AdamSettings::default()
            };
            Adam::new(network.parameters().len(), settings)
        };
        Td3Learner {
            actor_optimiser: optimiser(&actor),
            critic_optimisers: [0, 1].map(|i| optimiser(&critics[i])),
            target_actor: actor.clone(),
            target_critics: critics.clone(),
            actor,
            critics,
            steps: 0,
        }
    }

    /// Takes one optimiser step on transitions drawn from a buffer, in the calling thread pool.
    pub fn update(
        &mut self,
        replay: &Replay<Numbers>,
        settings: &Td3,
        stream: &mut Stream,
    ) -> Td3Losses {
        let minibatch = replay.draw(settings.minibatch, stream);
        let noise: Vec<Numbers> = (0..minibatch.count())
            .map(|_| [0; NUMBERS].map(|_| smoothing(settings, stream.normal())))
            .collect();
        self.step(&minibatch, &noise, settings)
    }

    /// Takes one optimiser step on these transitions, with this noise on the target policy's
    /// actions.
    ///
    /// # Panics
    /// If the numbers of noise values and transitions differ.
    pub fn step(
        &mut self,
        minibatch: &Minibatch<Numbers>,
        noise: &[Numbers],
        settings: &Td3,
    ) -> Td3Losses {
        assert_eq!(minibatch.count(), noise.len());
        let targets = self.targets(minibatch, noise, settings);
        let mut critic = 0.0;
        for i in 0..2 {
            let slope = self.critic_slope(i, minibatch, &targets);
            critic += 0.5 * slope.loss;
            let parameters = self.critics[i].parameters_mut();
            self.critic_optimisers[i].step(parameters, &slope.gradient, settings.learning_rate);
        }
        self.steps += 1;
        if !self.steps.is_multiple_of(u64::from(settings.delay)) {
            return Td3Losses {
                critic,
                actor: None,
            };
        }
        let (gradient, actor) = self.actor_gradient(minibatch);
        self.actor_optimiser.step(
            self.actor.parameters_mut(),
            &gradient,
            settings.learning_rate,
        );
        approach(&mut self.target_actor, &self.actor, settings.target_rate);
        for (target, critic) in self.target_critics.iter_mut().zip(&self.critics) {
            approach(target, critic, settings.target_rate);
        }
        Td3Losses {
            critic,
            actor: Some(actor),
        }
    }

    /// The target value of each step: its reward plus the discounted value of a noisy action of the
    /// target policy, the smaller of the two target critics' estimates.
    fn targets(
        &self,
        minibatch: &Minibatch<Numbers>,
        noise: &[Numbers],
        settings: &Td3,
    ) -> Vec<f32> {
        let size = self.actor.sizes()[0];
        let of_shard = |(first, rows): (usize, &[f32])| -> Vec<f32> {
            let mut trace = Trace::default();
            self.target_actor.forward(rows, &mut trace);
            let noisy = |(output, noise): (&[f32], &Numbers)| {
                std::array::from_fn(|i| (tanh(output[i]) + noise[i]).clamp(-1.0, 1.0))
            };
            let actions: Vec<Numbers> = trace
                .output()
                .chunks_exact(NUMBERS)
                .zip(&noise[first..])
                .map(noisy)
                .collect();
            let input = with_actions(rows, &actions, size);
            let values = [0, 1].map(|i| {
                self.target_critics[i].forward(&input, &mut trace);
                trace.output().to_vec()
            });
            let target = |row: usize| {
                let expected = values[0][row].min(values[1][row]);
                let later = if minibatch.over[first + row] {
                    0.0
                } else {
                    settings.discount * expected
                };
                settings.reward_scale * minibatch.rewards[first + row] + later
            };
            (0..actions.len()).map(target).collect()
        };
        let shards: Vec<Vec<f32>> = minibatch
            .next_observations
            .par_chunks(SHARD * size)
            .enumerate()
            .map(|(i, rows)| of_shard((i * SHARD, rows)))
            .collect();
        shards.concat()
    }

    /// Half a critic's mean squared error, and its gradient with respect to the critic's
    /// parameters.
    fn critic_slope(&self, which: usize, minibatch: &Minibatch<Numbers>, targets: &[f32]) -> Slope {
        let critic = &self.critics[which];
        let size = self.actor.sizes()[0];
        let per_row = 1.0 / minibatch.count() as f32;
        let of_shard = |((rows, actions), targets): ((&[f32], &[Numbers]), &[f32])| {
            let mut trace = Trace::default();
            critic.forward(&with_actions(rows, actions, size), &mut trace);
            let mut by_values: Vec<f32> = trace
                .output()
                .iter()
                .zip(targets)
                .map(|(value, want)| value - want)
                .collect();
            let loss = by_values.iter().map(|off| 0.5 * off * off * per_row).sum();
            by_values.iter_mut().for_each(|off| *off *= per_row);
            let mut gradient = vec![0.0; critic.parameters().len()];
            critic.backward(&trace, &mut by_values, &mut gradient, None);
            Slope { gradient, loss }
        };
        let shards = minibatch
            .observations
            .par_chunks(SHARD * size)
            .zip(minibatch.actions.par_chunks(SHARD))
            .zip(targets.par_chunks(SHARD));
        Slope::sum(shards.map(of_shard).collect::<Vec<Slope>>())
    }

    /// The negative mean value of the policy's actions according to the first critic, over
    /// transitions in which the boat followed its action, and its gradient with respect to the
    /// policy's parameters.
    pub fn actor_gradient(&self, minibatch: &Minibatch<Numbers>) -> (Vec<f32>, f32) {
        let critic = &self.critics[0];
        let size = self.actor.sizes()[0];
        let counted = minibatch
            .observations
            .chunks_exact(size)
            .zip(&minibatch.counts)
            .filter(|(_, counts)| **counts);
        let observations: Vec<f32> = counted.flat_map(|(row, _)| row).copied().collect();
        let per_row = 1.0 / (observations.len() / size).max(1) as f32;
        let of_shard = |rows: &[f32]| {
            let mut chosen = Trace::default();
            let mut valued = Trace::default();
            self.actor.forward(rows, &mut chosen);
            let actions: Vec<Numbers> = chosen.output().chunks_exact(NUMBERS).map(action).collect();
            critic.forward(&with_actions(rows, &actions, size), &mut valued);
            let loss = valued.output().iter().map(|value| -value * per_row).sum();
            let mut by_values = vec![-per_row; actions.len()];
            let mut unused = vec![0.0; critic.parameters().len()];
            let mut by_input = vec![];
            critic.backward(&valued, &mut by_values, &mut unused, Some(&mut by_input));
            let slope = |(by, action): (&[f32], &Numbers)| -> Numbers {
                // The derivative of the hyperbolic tangent.
                std::array::from_fn(|i| by[size + i] * (1.0 - action[i] * action[i]))
            };
            let mut by_output: Vec<f32> = by_input
                .chunks_exact(size + NUMBERS)
                .zip(&actions)
                .flat_map(slope)
                .collect();
            let mut gradient = vec![0.0; self.actor.parameters().len()];
            self.actor
                .backward(&chosen, &mut by_output, &mut gradient, None);
            Slope { gradient, loss }
        };
        let shards: Vec<Slope> = observations
            .par_chunks(SHARD * size)
            .map(of_shard)
            .collect();
        let mut slope = Slope::sum(shards);
        slope.gradient.resize(self.actor.parameters().len(), 0.0);
        (slope.gradient, slope.loss)
    }
}

/// Converts a policy's output to an action.
pub fn action(output: &[f32]) -> Numbers {
    std::array::from_fn(|i| tanh(output[i]))
}

/// Adds exploration noise to an action.
pub fn explored(action: Numbers, deviation: f32, stream: &mut Stream) -> Numbers {
    action.map(|number| (number + deviation * stream.normal() as f32).clamp(-1.0, 1.0))
}

/// A uniformly random action.
pub fn drawn(stream: &mut Stream) -> Numbers {
    [0; NUMBERS].map(|_| stream.between(-1.0, 1.0) as f32)
}

/// Noise for one component of the target policy's action, from a standard normal number.
fn smoothing(settings: &Td3, normal: f64) -> f32 {
    (settings.smoothing * normal as f32).clamp(-settings.smoothing_max, settings.smoothing_max)
}

/// Rows of observations, each followed by its action.
fn with_actions(observations: &[f32], actions: &[Numbers], size: usize) -> Vec<f32> {
    let mut rows = Vec::with_capacity(actions.len() * (size + NUMBERS));
    for (observation, action) in observations.chunks_exact(size).zip(actions) {
        rows.extend_from_slice(observation);
        rows.extend_from_slice(action);
    }
    rows
}

/// Moves a network's parameters towards those of another network by the given fraction.
fn approach(target: &mut Perceptron, network: &Perceptron, share: f32) {
    let numbers = target.parameters_mut().iter_mut().zip(network.parameters());
    numbers.for_each(|(target, number)| *target += share * (number - *target));
}
