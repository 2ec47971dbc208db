//! Double DQN (van Hasselt, Guez and Silver, AAAI 2016): a network that says what each discrete action is worth, and one that it was,
//! which says it of the action that the newer one would choose next.

use super::{Minibatch, Replay, Slope};
use crate::nn::{Adam, AdamSettings, Perceptron, SHARD, Trace};
use crate::ppo::choice::likeliest;
use crate::training::Dqn;
use primitives::stream::Stream;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A network with its target and its optimiser: all that learning goes on from, but for the replay buffer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DqnLearner {
    /// From an observation to what the rest of the episode is worth after each action, in the units of scaled rewards.
    pub network: Perceptron,
    /// What the network was.
    pub target: Perceptron,
    optimiser: Adam,
    /// Steps of the optimiser.
    steps: u64,
}

impl DqnLearner {
    /// A new network over this many actions that is shown this many numbers.
    #[must_use]
    pub fn new(observation: usize, hidden: &[usize], actions: usize, seed: u64) -> DqnLearner {
        let sizes = [&[observation], hidden, &[actions]].concat();
        // With the hyperbolic tangent between layers, as all networks here and unlike the
        // paper's: boats evaluate no other.
        let network = Perceptron::new(&sizes, 0.01, &mut Stream::new(seed, "actor"));
        let settings = AdamSettings { epsilon: 1e-8, norm_max: Some(10.0), ..AdamSettings::default() };
        let optimiser = Adam::new(network.parameters().len(), settings);
        DqnLearner { target: network.clone(), network, optimiser, steps: 0 }
    }

    /// One step of the optimiser from transitions that are drawn from a buffer, on the threads of the pool that it is called in. Gives
    /// the loss.
    pub fn update(&mut self, replay: &Replay<u16>, settings: &Dqn, stream: &mut Stream) -> f32 {
        self.step(&replay.draw(settings.minibatch, stream), settings)
    }

    /// One step of the optimiser from given transitions. Gives the loss.
    pub fn step(&mut self, minibatch: &Minibatch<u16>, settings: &Dqn) -> f32 {
        let (gradient, loss) = self.gradient(minibatch, settings);
        self.optimiser.step(self.network.parameters_mut(), &gradient, settings.learning_rate);
        self.steps += 1;
        if self.steps.is_multiple_of(u64::from(settings.target_every)) {
            self.target.clone_from(&self.network);
        }
        loss
    }

    /// The gradient of the loss by the network's parameters, and the loss: the mean of Huber's function, with the limit 1, of what was
    /// not expected.
    #[must_use]
    pub fn gradient(&self, minibatch: &Minibatch<u16>, settings: &Dqn) -> (Vec<f32>, f32) {
        let size = self.network.sizes()[0];
        let slopes: Vec<Slope> = minibatch
            .observations
            .par_chunks(SHARD * size)
            .zip(minibatch.next_observations.par_chunks(SHARD * size))
            .enumerate()
            .map(|(i, (rows, next_rows))| self.shard(minibatch, i * SHARD, (rows, next_rows), settings))
            .collect();
        let slope = Slope::sum(slopes);
        (slope.gradient, slope.loss)
    }

    /// What the transitions of a shard, from the first one on, add to the gradient.
    fn shard(
        &self,
        minibatch: &Minibatch<u16>,
        first: usize,
        (rows, next_rows): (&[f32], &[f32]),
        settings: &Dqn,
    ) -> Slope {
        let sizes = self.network.sizes();
        let (actions, per_row) = (sizes[sizes.len() - 1], 1.0 / minibatch.len() as f32);
        let (mut trace, mut then) = (Trace::default(), Trace::default());
        self.network.forward(next_rows, &mut trace);
        self.target.forward(next_rows, &mut then);
        let next = trace.output().chunks_exact(actions).zip(then.output().chunks_exact(actions));
        let expected: Vec<f32> = next.map(|(newer, older)| older[likeliest(newer)]).collect();
        self.network.forward(rows, &mut trace);
        let mut by_values = vec![0.0; trace.output().len()];
        let mut loss = 0.0;
        for (row, expected) in expected.into_iter().enumerate() {
            let i = first + row;
            let later = if minibatch.over[i] { 0.0 } else { settings.discount * expected };
            let place = row * actions + usize::from(minibatch.actions[i]);
            let off = trace.output()[place] - (settings.reward_scale * minibatch.rewards[i] + later);
            loss += huber(off) * per_row;
            by_values[place] = off.clamp(-1.0, 1.0) * per_row;
        }
        let mut gradient = vec![0.0; self.network.parameters().len()];
        self.network.backward(&trace, &mut by_values, &mut gradient, None);
        Slope { gradient, loss }
    }
}

/// Half the square up to 1, and a straight line beyond.
fn huber(off: f32) -> f32 {
    let size = off.abs();
    if size <= 1.0 { 0.5 * off * off } else { size - 0.5 }
}

/// The action that is worth most or, in a share of all draws, any one.
pub fn explored(values: &[f32], epsilon: f32, stream: &mut Stream) -> usize {
    if stream.unit() < f64::from(epsilon) { stream.below(values.len() as u64) as usize } else { likeliest(values) }
}
