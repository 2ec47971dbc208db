//! An update of an off-policy algorithm: games played with exploration fill the replay buffer, then
//! the optimisers take steps on samples drawn from it.
//!
//! Entries in the 2023 games used TD3 and double DQN. Both are implemented so that the entrants'
//! published results can be reproduced.

use super::{Update, outputs};
use crate::Learnt;
use crate::environment::{SetupError, VectorEnvironment};
use crate::off_policy::dqn::{self, DqnLearner};
use crate::off_policy::td3::{self, NUMBERS, Numbers, Td3Learner};
use crate::off_policy::{Replay, Transition};
use crate::training::{Dqn, Td3};
use agent::Action;
use primitives::stream::Stream;
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};

/// A learner with its settings and replay buffer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OffPolicy<L, S, A> {
    /// The networks and their optimisers.
    pub learner: L,
    /// Settings of the algorithm.
    pub settings: S,
    /// The replay buffer.
    pub replay: Replay<A>,
}

impl OffPolicy<Td3Learner, Td3, Numbers> {
    /// Plays and learns once. If `is_new`, actions are uniformly random until the buffer is large
    /// enough for learning.
    pub(super) fn update(
        &mut self,
        environment: &mut VectorEnvironment,
        pool: &ThreadPool,
        is_new: bool,
        stream: &mut Stream,
    ) -> Result<Update, SetupError> {
        let OffPolicy {
            learner,
            settings,
            replay,
        } = self;
        let actor = &learner.actor;
        let choose = |observations: &[f32], counts: &[bool], known: usize| -> Vec<Numbers> {
            if is_new && known < settings.warm_up {
                return counts.iter().map(|_| td3::drawn(stream)).collect();
            }
            let outputs = pool.install(|| outputs(actor, observations));
            let explored = |(output, counts): (&[f32], &bool)| {
                // The action of a boat that does not follow it has no effect. Draw it at random, so
                // that the critics learn this about every action.
                if *counts {
                    td3::explored(td3::action(output), settings.exploration, stream)
                } else {
                    td3::drawn(stream)
                }
            };
            outputs
                .chunks_exact(NUMBERS)
                .zip(counts)
                .map(explored)
                .collect()
        };
        let mut update = play(
            environment,
            settings.steps,
            replay,
            choose,
            Action::Continuous,
        )?;
        if replay.count() < settings.warm_up {
            return Ok(update);
        }
        let mut critic = 0.0;
        let mut actor = 0.0;
        let mut actor_steps = 0.0;
        for _ in 0..settings.minibatches {
            let losses = pool.install(|| learner.update(replay, settings, stream));
            critic += losses.critic;
            actor += losses.actor.unwrap_or_default();
            actor_steps += f32::from(u8::from(losses.actor.is_some()));
        }
        let drawn = settings.minibatches as f32 * settings.minibatch as f32;
        update.learnt = Learnt {
            policy_loss: (actor_steps > 0.0).then(|| actor / actor_steps),
            value_loss: Some(critic / settings.minibatches as f32),
            epochs: Some(drawn / update.transitions.max(1) as f32),
            ..Learnt::default()
        };
        Ok(update)
    }
}

impl OffPolicy<DqnLearner, Dqn, u16> {
    /// Plays and learns once. `samples` is the number of samples so far.
    pub(super) fn update(
        &mut self,
        environment: &mut VectorEnvironment,
        pool: &ThreadPool,
        samples: u64,
        stream: &mut Stream,
    ) -> Result<Update, SetupError> {
        let OffPolicy {
            learner,
            settings,
            replay,
        } = self;
        let network = &learner.network;
        let epsilon = settings.epsilon_after(samples);
        let choose = |observations: &[f32], counts: &[bool], _: usize| -> Vec<u16> {
            let outputs = pool.install(|| outputs(network, observations));
            let explored = |(values, counts): (&[f32], &bool)| {
                // The action of a boat that does not follow it has no effect. Draw it at random, so
                // that the network learns this about every action.
                dqn::explored(values, if *counts { epsilon } else { 1.0 }, stream) as u16
            };
            outputs
                .chunks_exact(outputs.len() / counts.len())
                .zip(counts)
                .map(explored)
                .collect()
        };
        let discrete = |action: u16| Action::Discrete(usize::from(action));
        let mut update = play(environment, settings.steps, replay, choose, discrete)?;
        if replay.count() < settings.warm_up {
            return Ok(update);
        }
        let mut loss = 0.0;
        for _ in 0..settings.minibatches {
            loss += pool.install(|| learner.update(replay, settings, stream));
        }
        let drawn = settings.minibatches as f32 * settings.minibatch as f32;
        update.learnt = Learnt {
            value_loss: Some(loss / settings.minibatches as f32),
            epochs: Some(drawn / update.transitions.max(1) as f32),
            ..Learnt::default()
        };
        Ok(update)
    }
}

/// Plays this many steps of all games, and stores those of boats that a policy controls. `choose`
/// receives the observations, which of their actions count, and the number of stored transitions.
fn play<A: Copy + Default>(
    environment: &mut VectorEnvironment,
    steps: usize,
    replay: &mut Replay<A>,
    mut choose: impl FnMut(&[f32], &[bool], usize) -> Vec<A>,
    action: impl Fn(A) -> Action,
) -> Result<Update, SetupError> {
    let (rows, per_game) = environment.rows();
    let size = environment.setup().observation_size();
    let mut update = Update {
        counted: 0,
        transitions: 0,
        reward: 0.0,
        finished: vec![],
        learnt: Learnt::default(),
    };
    for _ in 0..steps {
        let before = environment.observations().to_vec();
        let counts = environment.counts().to_vec();
        let boats = (0..rows / per_game).flat_map(|game| environment.boats(game));
        let has_boat: Vec<bool> = boats.map(Option::is_some).collect();
        let chosen = choose(&before, &counts, replay.count());
        environment.step(&chosen.iter().copied().map(&action).collect::<Vec<Action>>())?;
        let mut ended: Vec<Option<bool>> = vec![None; rows / per_game];
        environment
            .finished()
            .iter()
            .for_each(|one| ended[one.game] = Some(!one.cut_off));
        for row in (0..rows).filter(|row| has_boat[*row]) {
            let numbers = row * size..(row + 1) * size;
            let ended = ended[row / per_game];
            let shown = if ended.is_some() {
                environment.final_observations()
            } else {
                environment.observations()
            };
            replay.push(Transition {
                observation: &before[numbers.clone()],
                action: chosen[row],
                reward: environment.rewards()[row],
                next_observation: &shown[numbers],
                over: ended == Some(true),
                counts: counts[row],
            });
            update.transitions += 1;
            update.counted += u64::from(counts[row]);
            update.reward += environment.rewards()[row];
        }
        update.finished.extend_from_slice(environment.finished());
    }
    update.reward /= update.transitions.max(1) as f32;
    Ok(update)
}
