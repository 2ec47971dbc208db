//! A rollout: steps of all games with the current policy as samples.

use super::outputs;
use crate::environment::{Finished, SetupError, VectorEnvironment};
use crate::ppo::{ActorCritic, Steps, advantages, choice};
use crate::training::Ppo;
use agent::Action;
use primitives::stream::Stream;

/// Played steps; each list is steps × rows.
pub(super) struct Rollout {
    rows: usize,
    observations: Vec<f32>,
    states: Vec<f32>,
    actions: Vec<u16>,
    log_probabilities: Vec<f32>,
    values: Vec<f32>,
    next_values: Vec<f32>,
    rewards: Vec<f32>,
    counts: Vec<bool>,
    /// Whether a policy controls the row's boat.
    sailed: Vec<bool>,
    over: Vec<bool>,
    ended: Vec<bool>,
    pub(super) finished: Vec<Finished>,
}

/// The steps of boats that a policy controls.
pub(super) struct Samples {
    pub(super) observations: Vec<f32>,
    pub(super) states: Vec<f32>,
    pub(super) actions: Vec<u16>,
    pub(super) log_probabilities: Vec<f32>,
    pub(super) advantages: Vec<f32>,
    pub(super) returns: Vec<f32>,
    pub(super) rewards: Vec<f32>,
    pub(super) counts: Vec<bool>,
}

impl Rollout {
    /// Plays this many steps of every game.
    pub(super) fn play(
        environment: &mut VectorEnvironment,
        pool: &rayon::ThreadPool,
        learner: &ActorCritic,
        steps: usize,
        stream: &mut Stream,
    ) -> Result<Rollout, SetupError> {
        let (rows, per_game) = environment.rows();
        let mut rollout = Rollout {
            rows,
            observations: vec![],
            states: vec![],
            actions: vec![],
            log_probabilities: vec![],
            values: vec![],
            next_values: vec![],
            rewards: vec![],
            counts: vec![],
            sailed: vec![],
            over: vec![],
            ended: vec![],
            finished: vec![],
        };
        let expected = |states: &[f32]| {
            let deviation = learner.scale.deviation();
            let values = pool.install(|| outputs(&learner.critic, states));
            values.into_iter().map(|value| value * deviation).collect::<Vec<f32>>()
        };
        let mut values = expected(environment.states());
        for _ in 0..steps {
            rollout.observations.extend_from_slice(environment.observations());
            rollout.states.extend_from_slice(environment.states());
            rollout.counts.extend_from_slice(environment.counts());
            let boats = (0..rows / per_game).map(|game| environment.boats(game));
            rollout.sailed.extend(boats.flat_map(|boats| (0..per_game).map(move |row| row < boats)));
            rollout.values.extend_from_slice(&values);
            let actions = if environment.setup().teacher.is_some() {
                vec![Action::Discrete(0); rows]
            } else {
                rollout.choose(environment.observations(), pool, learner, stream)
            };
            environment.step(&actions)?;
            if environment.setup().teacher.is_some() {
                rollout.take_taught(environment);
            }
            rollout.rewards.extend_from_slice(environment.rewards());
            values = expected(environment.states());
            let mut next = values.clone();
            let (mut over, mut ended) = (vec![false; rows], vec![false; rows]);
            for one in environment.finished() {
                let of_game = one.game * per_game..(one.game + 1) * per_game;
                let size = environment.setup().state_size();
                let last = &environment.final_states()[of_game.start * size..of_game.end * size];
                next[of_game.clone()].copy_from_slice(&expected(last));
                over[of_game.clone()].fill(!one.cut_off);
                ended[of_game].fill(true);
            }
            rollout.next_values.extend(next);
            rollout.over.extend(over);
            rollout.ended.extend(ended);
            rollout.finished.extend_from_slice(environment.finished());
        }
        Ok(rollout)
    }

    /// Records the teacher's actions in the last step. Steps without a corresponding action are not
    /// learnt.
    fn take_taught(&mut self, environment: &VectorEnvironment) {
        let (rows, per_game) = environment.rows();
        let first = self.counts.len() - rows;
        for row in 0..rows {
            let taught = environment.taught(row / per_game).get(row % per_game).copied().flatten();
            let Some(Action::Discrete(action)) = taught else {
                self.counts[first + row] = false;
                self.actions.push(0);
                continue;
            };
            self.actions.push(action as u16);
        }
        self.log_probabilities.resize(self.actions.len(), 0.0);
    }

    fn choose(
        &mut self,
        observations: &[f32],
        pool: &rayon::ThreadPool,
        learner: &ActorCritic,
        stream: &mut Stream,
    ) -> Vec<Action> {
        let logits = pool.install(|| outputs(&learner.actor, observations));
        let count = logits.len() / self.rows;
        let mut logs = vec![0.0; count];
        let draw = |logits: &[f32]| {
            choice::log_probabilities(logits, &mut logs);
            let action = choice::drawn(&logs, stream.unit());
            self.actions.push(action as u16);
            self.log_probabilities.push(logs[action]);
            Action::Discrete(action)
        };
        logits.chunks_exact(count).map(draw).collect()
    }

    /// The steps of boats that a policy controls.
    pub(super) fn samples(&self, settings: &Ppo) -> Samples {
        let steps = Steps {
            rows: self.rows,
            rewards: &self.rewards,
            values: &self.values,
            next_values: &self.next_values,
            over: &self.over,
            ended: &self.ended,
        };
        let advantages = advantages(steps, settings.discount, settings.lambda);
        let sailed: Vec<usize> = (0..self.actions.len()).filter(|i| self.sailed[*i]).collect();
        let of = |numbers: &[f32]| sailed.iter().map(|i| numbers[*i]).collect();
        let rows_of = |numbers: &[f32]| -> Vec<f32> {
            let size = numbers.len() / self.actions.len();
            sailed.iter().flat_map(|i| &numbers[i * size..(i + 1) * size]).copied().collect()
        };
        Samples {
            observations: rows_of(&self.observations),
            states: rows_of(&self.states),
            actions: sailed.iter().map(|i| self.actions[*i]).collect(),
            log_probabilities: of(&self.log_probabilities),
            returns: sailed.iter().map(|i| advantages[*i] + self.values[*i]).collect(),
            advantages: of(&advantages),
            rewards: of(&self.rewards),
            counts: sailed.iter().map(|i| self.counts[*i]).collect(),
        }
    }
}
