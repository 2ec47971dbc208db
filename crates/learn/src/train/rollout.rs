//! A rollout: steps of all games with the current policy, as samples.

use super::outputs;
use crate::environment::{Finished, SetupError, VectorEnvironment};
use crate::ppo::{ActorCritic, Batch, Lesson, Steps, choice};
use crate::training::Ppo;
use agent::Action;
use primitives::stream::Stream;

/// Played steps; each list is steps × rows.
#[derive(Default)]
pub(super) struct Rollout {
    steps: Steps,
    observations: Vec<f32>,
    states: Vec<f32>,
    actions: Vec<u16>,
    log_probabilities: Vec<f32>,
    counts: Vec<bool>,
    /// Whether a policy controls the row's boat.
    sailed: Vec<bool>,
    pub(super) finished: Vec<Finished>,
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
            steps: Steps {
                rows,
                ..Steps::default()
            },
            ..Rollout::default()
        };
        let expected = |states: &[f32]| {
            let deviation = learner.scale.deviation();
            let values = pool.install(|| outputs(&learner.critic, states));
            values
                .into_iter()
                .map(|value| value * deviation)
                .collect::<Vec<f32>>()
        };
        let mut values = expected(environment.states());
        for _ in 0..steps {
            rollout
                .observations
                .extend_from_slice(environment.observations());
            rollout.states.extend_from_slice(environment.states());
            rollout.counts.extend_from_slice(environment.counts());
            let boats = (0..rows / per_game).flat_map(|game| environment.boats(game));
            rollout.sailed.extend(boats.map(Option::is_some));
            rollout.steps.values.extend_from_slice(&values);
            let actions = if environment.setup().is_driven() {
                vec![Action::Discrete(0); rows]
            } else {
                rollout.choose(environment.observations(), pool, learner, stream)
            };
            environment.step(&actions)?;
            if environment.setup().teacher.is_some() {
                rollout.take_taught(environment);
            }
            rollout
                .steps
                .rewards
                .extend_from_slice(environment.rewards());
            values = expected(environment.states());
            let mut next = values.clone();
            let mut over = vec![false; rows];
            let mut ended = vec![false; rows];
            for one in environment.finished() {
                let of_game = one.game * per_game..(one.game + 1) * per_game;
                let size = environment.setup().state_size();
                let last = &environment.final_states()[of_game.start * size..of_game.end * size];
                next[of_game.clone()].copy_from_slice(&expected(last));
                over[of_game.clone()].fill(!one.cut_off);
                ended[of_game].fill(true);
            }
            rollout.steps.next_values.extend(next);
            rollout.steps.over.extend(over);
            rollout.steps.ended.extend(ended);
            rollout.finished.extend_from_slice(environment.finished());
        }
        Ok(rollout)
    }

    /// Records the teacher's actions in the last step, in place of the policy's. Nothing is learned
    /// from steps without a corresponding action.
    fn take_taught(&mut self, environment: &VectorEnvironment) {
        let (rows, per_game) = environment.rows();
        let first = self.counts.len() - rows;
        self.actions.truncate(first);
        for row in 0..rows {
            let taught = environment
                .taught(row / per_game)
                .get(row % per_game)
                .copied()
                .flatten();
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
        let count = logits.len() / self.steps.rows;
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

    /// The indices of the steps of boats that a policy controls.
    fn sailed(&self) -> impl Iterator<Item = usize> {
        (0..self.actions.len()).filter(|i| self.sailed[*i])
    }

    /// The rewards of boats that a policy controls.
    pub(super) fn rewards(&self) -> impl Iterator<Item = f32> {
        self.sailed().map(|i| self.steps.rewards[i])
    }

    /// The steps of boats that a policy controls.
    pub(super) fn batch(&self, settings: &Ppo, lesson: Lesson) -> Batch {
        let advantages = self.steps.advantages(settings.discount, settings.lambda);
        let of = |numbers: &[f32]| self.sailed().map(|i| numbers[i]).collect();
        let rows_of = |numbers: &[f32]| -> Vec<f32> {
            let size = numbers.len() / self.actions.len();
            self.sailed()
                .flat_map(|i| &numbers[i * size..(i + 1) * size])
                .copied()
                .collect()
        };
        Batch {
            observations: rows_of(&self.observations),
            states: rows_of(&self.states),
            actions: self.sailed().map(|i| self.actions[i]).collect(),
            log_probabilities: of(&self.log_probabilities),
            returns: self
                .sailed()
                .map(|i| advantages[i] + self.steps.values[i])
                .collect(),
            advantages: of(&advantages),
            lesson,
            counts: self.sailed().map(|i| self.counts[i]).collect(),
        }
    }
}
