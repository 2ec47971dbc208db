//! Proximal policy optimisation (Schulman and others, arXiv 1707.06347).

mod advantage;
pub mod choice;

pub use advantage::Steps;

use crate::Learnt;
use crate::nn::{Adam, AdamSettings, Perceptron, SHARD, Trace};
use crate::training::Ppo;
use choice::log_probabilities;
use primitives::stream::Stream;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A policy and its critic with their optimisers: the whole learning state.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActorCritic {
    /// Maps an observation to the logit of each action.
    pub actor: Perceptron,
    /// Maps a state, or the observation, to the value of the rest of the episode, in units of
    /// [`ActorCritic::scale`].
    pub critic: Perceptron,
    /// The unit of values: the standard deviation of returns.
    pub scale: Scale,
    actor_optimiser: Adam,
    critic_optimiser: Adam,
}

/// The observed scale of returns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scale {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Scale {
    /// The standard deviation; 1 before any returns.
    pub fn deviation(&self) -> f32 {
        if self.count < 2.0 {
            1.0
        } else {
            (self.squares / self.count).sqrt().max(1e-3) as f32
        }
    }

    /// Adds returns. Older returns count less.
    fn see(&mut self, returns: &[f32]) {
        const MEMORY: f64 = 1e6;
        let forget = (MEMORY / (self.count + returns.len() as f64)).min(1.0);
        (self.count, self.squares) = (self.count * forget, self.squares * forget);
        for number in returns.iter().copied().map(f64::from) {
            self.count += 1.0;
            let off = number - self.mean;
            self.mean += off / self.count;
            self.squares += off * (number - self.mean);
        }
    }
}

/// Samples; each list has one entry per sample.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The policy's observations, samples × values.
    pub observations: Vec<f32>,
    /// The critic's inputs, samples × values.
    pub states: Vec<f32>,
    /// The chosen actions.
    pub actions: Vec<u16>,
    /// The log probabilities of the actions when they were chosen.
    pub log_probabilities: Vec<f32>,
    /// The advantages.
    pub advantages: Vec<f32>,
    /// The returns to learn.
    pub returns: Vec<f32>,
    /// The learning objective.
    pub lesson: Lesson,
    /// Whether the boat followed the action. From other samples only the critic learns, because it
    /// must know the value of being tagged.
    pub counts: Vec<bool>,
}

/// A policy's learning objective.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lesson {
    /// Repeat actions that turned out better than expected, within limits (PPO).
    Reinforcement,
    /// Repeat the sampled actions regardless of their results: behaviour cloning with a
    /// cross-entropy loss.
    Imitation,
}

impl ActorCritic {
    /// A new policy with these numbers of inputs and actions, and a critic with `state` inputs.
    pub fn new(
        observation: usize,
        state: usize,
        hidden: &[usize],
        actions: usize,
        seed: u64,
    ) -> ActorCritic {
        let sizes = |from: usize, to: usize| [&[from], hidden, &[to]].concat();
        let actor = Perceptron::new(
            &sizes(observation, actions),
            0.01,
            &mut Stream::new(seed, "actor"),
        );
        let critic = Perceptron::new(&sizes(state, 1), 1.0, &mut Stream::new(seed, "critic"));
        ActorCritic {
            actor_optimiser: Adam::new(actor.parameters().len(), AdamSettings::default()),
            critic_optimiser: Adam::new(critic.parameters().len(), AdamSettings::default()),
            actor,
            critic,
            scale: Scale {
                count: 0.0,
                mean: 0.0,
                squares: 0.0,
            },
        }
    }

    /// Learns from samples, in the calling thread pool; `stream` shuffles them.
    ///
    /// # Panics
    /// If the length of a list does not match.
    pub fn update(
        &mut self,
        batch: &Batch,
        settings: &Ppo,
        rate: f32,
        stream: &mut Stream,
    ) -> Learnt {
        let count = batch.actions.len();
        let observation = self.actor.sizes()[0];
        let state = self.critic.sizes()[0];
        assert!(
            batch.observations.len() == count * observation && batch.states.len() == count * state
        );
        assert!(
            [&batch.log_probabilities, &batch.advantages, &batch.returns]
                .iter()
                .all(|list| list.len() == count)
        );
        assert_eq!(batch.counts.len(), count);
        self.scale.see(&batch.returns);
        let mut order: Vec<u32> = (0..count as u32).collect();
        let mut sums = Sums::default();
        let mut seen = 0.0;
        let mut values = 0.0;
        'epochs: for _ in 0..settings.epochs {
            stream.shuffle(&mut order);
            for minibatch in order.chunks(settings.minibatch) {
                let part = self.step(batch, minibatch, settings, rate * settings.learning_rate);
                let samples = minibatch
                    .iter()
                    .filter(|i| batch.counts[**i as usize])
                    .count()
                    .max(1) as f32;
                let is_far = part.divergence / samples > settings.divergence_max;
                sums.add(&part);
                seen += samples;
                values += minibatch.len() as f32;
                if is_far {
                    break 'epochs;
                }
            }
        }
        let mean = |sum: f32| Some(sum / f32::max(seen, 1.0));
        Learnt {
            policy_loss: mean(sums.policy),
            value_loss: Some(sums.value / f32::max(values, 1.0)),
            entropy: mean(sums.entropy),
            divergence: mean(sums.divergence),
            clipped: mean(sums.clipped),
            explained_variance: explained_variance(&batch.advantages, &batch.returns),
            epochs: Some(values / (count.max(1) as f32)),
        }
    }

    /// One step of both optimisers.
    fn step(
        &mut self,
        batch: &Batch,
        minibatch: &[u32],
        settings: &Ppo,
        learning_rate: f32,
    ) -> Sums {
        let counted = || {
            minibatch
                .iter()
                .map(|i| *i as usize)
                .filter(|i| batch.counts[*i])
        };
        let samples = (counted().count(), minibatch.len());
        let advantages = Normal::of(counted().map(|i| batch.advantages[i]));
        let of_shard = |shard: &[u32]| self.shard(batch, shard, samples, advantages, settings);
        // Shards of a fixed size, summed in order, give the same bits on any number of threads.
        let shards: Vec<Shard> = minibatch.par_chunks(SHARD).map(of_shard).collect();
        let mut shards = shards.into_iter();
        let Some(mut all) = shards.next() else {
            return Sums::default();
        };
        for shard in shards {
            all.sums.add(&shard.sums);
            all.actor
                .iter_mut()
                .zip(&shard.actor)
                .for_each(|(sum, number)| *sum += number);
            all.critic
                .iter_mut()
                .zip(&shard.critic)
                .for_each(|(sum, number)| *sum += number);
        }
        self.actor_optimiser
            .step(self.actor.parameters_mut(), &all.actor, learning_rate);
        self.critic_optimiser
            .step(self.critic.parameters_mut(), &all.critic, learning_rate);
        all.sums
    }

    /// A shard's contribution to the gradients of the mean loss.
    fn shard(
        &self,
        batch: &Batch,
        shard: &[u32],
        (counted, samples): (usize, usize),
        advantages: Normal,
        settings: &Ppo,
    ) -> Shard {
        let rows = |from: &[f32], size: usize| -> Vec<f32> {
            shard
                .iter()
                .flat_map(|i| &from[*i as usize * size..(*i as usize + 1) * size])
                .copied()
                .collect()
        };
        let per_counted = 1.0 / counted.max(1) as f32;
        let per_sample = 1.0 / samples as f32;
        let mut sums = Sums::default();
        let mut trace = Trace::default();
        self.actor.forward(
            &rows(&batch.observations, self.actor.sizes()[0]),
            &mut trace,
        );
        let actions = trace.output().len() / shard.len();
        let mut by_logits = vec![0.0; trace.output().len()];
        let mut logs = vec![0.0; actions];
        let of_rows = shard
            .iter()
            .zip(trace.output().chunks_exact(actions))
            .zip(by_logits.chunks_exact_mut(actions));
        for ((i, logits), by) in of_rows {
            let i = *i as usize;
            // A tagged boat's actions have no effect; policies that learned from them left the
            // field. The critic does learn from these samples: without them it misjudged being
            // tagged, and policies that won 16 of 20 games against Pav01 won none after half a
            // million more samples.
            if !batch.counts[i] {
                continue;
            }
            log_probabilities(logits, &mut logs);
            let advantage = advantages.normalised(batch.advantages[i]);
            let action = usize::from(batch.actions[i]);
            let was = batch.log_probabilities[i];
            match batch.lesson {
                Lesson::Reinforcement => {
                    policy_gradient(&logs, action, (was, advantage), settings, by, &mut sums)
                }
                // Without imitation, a million samples did not reach the level of a hundred
                // thousand with it.
                Lesson::Imitation => imitation_gradient(&logs, action, by, &mut sums),
            }
            by.iter_mut().for_each(|number| *number *= per_counted);
        }
        let mut actor = vec![0.0; self.actor.parameters().len()];
        self.actor
            .backward(&trace, &mut by_logits, &mut actor, None);
        self.critic
            .forward(&rows(&batch.states, self.critic.sizes()[0]), &mut trace);
        let deviation = self.scale.deviation();
        // In standard deviations of returns, so that Adam learns rewards of any scale at the same
        // rate.
        let off = |(i, value): (&u32, &f32)| value - batch.returns[*i as usize] / deviation;
        let mut by_values: Vec<f32> = shard.iter().zip(trace.output()).map(off).collect();
        sums.value = by_values.iter().map(|off| 0.5 * off * off).sum();
        by_values.iter_mut().for_each(|off| *off *= per_sample);
        let mut critic = vec![0.0; self.critic.parameters().len()];
        self.critic
            .backward(&trace, &mut by_values, &mut critic, None);
        Shard {
            actor,
            critic,
            sums,
        }
    }
}

/// A shard's contribution.
struct Shard {
    actor: Vec<f32>,
    critic: Vec<f32>,
    sums: Sums,
}

/// Sums over samples.
#[derive(Clone, Copy, Default)]
struct Sums {
    policy: f32,
    value: f32,
    entropy: f32,
    divergence: f32,
    clipped: f32,
}

impl Sums {
    fn add(&mut self, other: &Sums) {
        self.policy += other.policy;
        self.value += other.value;
        self.entropy += other.entropy;
        self.divergence += other.divergence;
        self.clipped += other.clipped;
    }
}

/// Mean and standard deviation of a minibatch's advantages.
#[derive(Clone, Copy)]
struct Normal {
    mean: f32,
    deviation: f32,
}

impl Normal {
    fn of(numbers: impl Iterator<Item = f32> + Clone) -> Normal {
        let count = numbers.clone().count().max(1) as f64;
        let mean = numbers.clone().map(f64::from).sum::<f64>() / count;
        let square = numbers
            .map(|number| (f64::from(number) - mean) * (f64::from(number) - mean))
            .sum::<f64>()
            / count;
        Normal {
            mean: mean as f32,
            deviation: square.sqrt() as f32,
        }
    }

    fn normalised(self, number: f32) -> f32 {
        (number - self.mean) / (self.deviation + 1e-8)
    }
}

/// The fraction of the returns' variance that the critic explained; `None` if the returns are
/// equal.
fn explained_variance(advantages: &[f32], returns: &[f32]) -> Option<f32> {
    // An advantage is a return minus the critic's value.
    let [rest, all] = [advantages, returns].map(|list| Normal::of(list.iter().copied()).deviation);
    (all > 0.0).then(|| 1.0 - (rest / all) * (rest / all))
}

/// The gradient of a sample's loss with respect to its logits: clipped objective and entropy bonus.
fn policy_gradient(
    logs: &[f32],
    action: usize,
    (was, advantage): (f32, f32),
    settings: &Ppo,
    by: &mut [f32],
    sums: &mut Sums,
) {
    let change = logs[action] - was;
    let ratio = libm::expf(change);
    let limited = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip);
    let free = ratio * advantage;
    let held = limited * advantage;
    let entropy = -logs.iter().map(|log| libm::expf(*log) * log).sum::<f32>();
    // If the clipped term is smaller, the gradient is zero.
    let by_log = if free <= held {
        -ratio * advantage
    } else {
        0.0
    };
    for (i, (by, log)) in by.iter_mut().zip(logs).enumerate() {
        let probability = libm::expf(*log);
        let is_chosen = if i == action { 1.0 } else { 0.0 };
        // d log p(action) / d logit, and d entropy / d logit = -p (log p + entropy).
        *by = by_log * (is_chosen - probability) + settings.entropy * probability * (log + entropy);
    }
    sums.policy -= free.min(held);
    sums.entropy += entropy;
    // A non-negative estimator (Schulman, 2020).
    sums.divergence += (ratio - 1.0) - change;
    sums.clipped += f32::from(u8::from((ratio - 1.0).abs() > settings.clip));
}

/// The gradient of a sample's cross-entropy with respect to its logits.
fn imitation_gradient(logs: &[f32], action: usize, by: &mut [f32], sums: &mut Sums) {
    for (i, (by, log)) in by.iter_mut().zip(logs).enumerate() {
        let probability = libm::expf(*log);
        *by = probability - if i == action { 1.0 } else { 0.0 };
        sums.entropy -= probability * log;
    }
    sums.policy -= logs[action];
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The loss of a sample, in double precision.
    fn loss(logits: &[f64], action: usize, was: f64, advantage: f64, settings: &Ppo) -> f64 {
        let sum: f64 = logits.iter().map(|logit| libm::exp(*logit)).sum();
        let logs: Vec<f64> = logits.iter().map(|logit| logit - libm::log(sum)).collect();
        let ratio = libm::exp(logs[action] - was);
        let clip = f64::from(settings.clip);
        let gain = (ratio * advantage).min(ratio.clamp(1.0 - clip, 1.0 + clip) * advantage);
        let entropy: f64 = -logs.iter().map(|log| libm::exp(*log) * log).sum::<f64>();
        -gain - f64::from(settings.entropy) * entropy
    }

    /// Compares a gradient with finite differences of its loss.
    fn assert_slopes<const N: usize>(
        by: [f32; N],
        logits: [f64; N],
        loss: impl Fn(&[f64; N]) -> f64,
    ) {
        const STEP: f64 = 1e-5;
        const TOLERANCE: f64 = 1e-5;
        for i in 0..N {
            let at = |step: f64| {
                let mut logits = logits;
                logits[i] += step;
                loss(&logits)
            };
            let want = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            assert!(
                (f64::from(by[i]) - want).abs() < TOLERANCE,
                "{i}: got {}, want {want}",
                by[i]
            );
        }
    }

    #[test]
    fn a_critic_explains_all_nothing_or_less_than_nothing() {
        let returns = [1.0, 2.0, 4.0, 5.0];
        // Values equal to the returns, constant, and opposite to the returns.
        for (values, want) in [
            (returns, 1.0),
            ([3.0; 4], 0.0),
            (returns.map(|value| -value), -3.0),
        ] {
            let advantages: Vec<f32> = returns
                .iter()
                .zip(values)
                .map(|(all, value)| all - value)
                .collect();
            let got = explained_variance(&advantages, &returns).expect("unequal returns");
            assert!((got - want).abs() < 1e-5, "{values:?}: {got}, want {want}");
        }
        assert_eq!(explained_variance(&[0.5, 1.0], &[2.0, 2.0]), None);
    }

    #[test]
    fn the_policy_gradient_is_the_slope_of_the_clipped_loss() {
        let file =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/training/first.toml");
        let training =
            scenario::load_file::<crate::training::Training>(&file).expect("a training file");
        let settings = Ppo {
            entropy: 0.05,
            ..training.ppo
        };
        let logits = [0.3_f64, -1.1, 0.8, 0.1, -0.4];
        let mut logs = [0.0; 5];
        log_probabilities(&logits.map(|logit| logit as f32), &mut logs);
        // Ratios within the limits; ratios beyond them that are clipped; and ratios beyond them
        // with a gradient that leads back.
        for (change, advantage) in [
            (0.05, 1.3),
            (0.05, -0.7),
            (0.5, 1.0),
            (-0.5, -1.0),
            (0.5, -1.0),
            (-0.5, 1.0),
        ] {
            let action = 2;
            let was = logs[action] - change;
            let mut by = [0.0; 5];
            let mut sums = Sums::default();
            policy_gradient(
                &logs,
                action,
                (was, advantage),
                &settings,
                &mut by,
                &mut sums,
            );
            assert_slopes(by, logits, |logits| {
                loss(
                    logits,
                    action,
                    f64::from(was),
                    f64::from(advantage),
                    &settings,
                )
            });
        }
    }

    #[test]
    fn the_imitation_gradient_is_the_slope_of_the_cross_entropy() {
        let logits = [0.3_f64, -1.1, 0.8, 0.1];
        let mut logs = [0.0; 4];
        log_probabilities(&logits.map(|logit| logit as f32), &mut logs);
        let mut by = [0.0; 4];
        let mut sums = Sums::default();
        imitation_gradient(&logs, 1, &mut by, &mut sums);
        let entropy = |logits: &[f64; 4]| {
            libm::log(logits.iter().map(|logit| libm::exp(*logit)).sum()) - logits[1]
        };
        assert!(
            (f64::from(sums.policy) - entropy(&logits)).abs() < 1e-5,
            "{}",
            sums.policy
        );
        assert_slopes(by, logits, entropy);
    }

    #[test]
    fn the_scale_is_the_standard_deviation_of_returns() {
        let mut scale = Scale {
            count: 0.0,
            mean: 0.0,
            squares: 0.0,
        };
        assert_eq!(scale.deviation(), 1.0);
        scale.see(&[1.0, 2.0, 3.0]);
        scale.see(&[4.0]);
        assert!(
            (scale.deviation() - 1.118_034).abs() < 1e-5,
            "{}",
            scale.deviation()
        );
    }
}
