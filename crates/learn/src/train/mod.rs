//! Training: plays with a policy and learns from the samples, stage by stage.

mod evaluation;
mod league;
mod learner;
mod off_policy;
mod rollout;
mod state;

pub use evaluation::{Played, evaluate};
pub use learner::Learner;
pub use off_policy::OffPolicy;
pub use state::{Best, Evaluated, StateError};

use crate::Learnt;
use crate::environment::{Finished, Player, Setup, SetupError, VectorEnvironment, Watches, wrong};
use crate::nn::{Perceptron, SHARD, Trace};
use crate::ppo::{ActorCritic, Lesson};
use crate::training::{CriticInput, Ppo, Stage, Training};
use league::PastSelf;
use primitives::stream::Stream;
use rayon::prelude::*;
use rollout::Rollout;
use scenario::policy::{PolicySpec, options_metadata};
use state::{PlayedUpdate, State};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// Metadata keys for a model's origin.
const SAMPLES: &str = "squall.samples";
/// First seed of evaluation games, higher than any training seed.
const EVALUATION_SEED: u64 = 1 << 62;
/// Seed spacing between a training run's environments, as a power of two.
const SEEDS_BITS: u32 = 24;
/// All games restart after this many times their length, so that training can resume there.
const LENGTHS: i64 = 4;

/// A training run in progress.
pub struct Trainer {
    training: Training,
    setups: Vec<Setup>,
    /// The setup against each opponent of the evaluation, with the stem of the opponent's file.
    judges: Vec<(String, Setup)>,
    threads: usize,
    pool: rayon::ThreadPool,
    environment: VectorEnvironment,
    /// Watches of episodes, by episode number.
    watches: Option<Watches>,
    /// By stage: updates between restarts of all games.
    updates_per_epoch: Vec<u64>,
    state: State,
    /// Whether the games are still at their last restart and must be replayed to match the state.
    is_behind: bool,
}

/// Statistics of an update.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Samples learned from so far.
    pub samples: u64,
    /// Index of the stage.
    pub stage: usize,
    /// Optimiser statistics.
    pub learnt: Learnt,
    /// Mean reward per step.
    pub reward: f32,
    /// The episodes that ended, each with its opponent's name; numbered as in [`Trainer::watch`].
    pub finished: Vec<(Finished, String)>,
    /// The evaluation of the current policy, if one was due.
    pub evaluated: Option<Evaluated>,
    /// Whether the current policy is the best so far.
    pub is_best: bool,
    /// Whether all games restart: the state is then smallest, and a run that resumes from it has no
    /// updates to replay.
    pub games_restart: bool,
}

struct Update {
    /// Samples whose action the boat followed.
    counted: u64,
    /// All samples.
    transitions: u64,
    /// Mean reward per step.
    reward: f32,
    finished: Vec<Finished>,
    learnt: Learnt,
}

impl Trainer {
    /// Starts a training run on `threads` threads.
    ///
    /// # Errors
    /// [`SetupError`] if a file cannot be used or a setup cannot be played.
    pub fn new(training: Training, threads: usize) -> Result<Trainer, SetupError> {
        Trainer::with(training, threads, None)
    }

    /// Resumes a training run from [`Trainer::state`]. The results are the same as without an
    /// interruption.
    ///
    /// # Errors
    /// [`StateError`] if the state belongs to a different training run or version, or a file cannot
    /// be used.
    pub fn resume(training: Training, threads: usize, state: &[u8]) -> Result<Trainer, StateError> {
        let state = State::read(state, &training)?;
        Ok(Trainer::with(training, threads, Some(state))?)
    }

    fn with(
        training: Training,
        threads: usize,
        state: Option<State>,
    ) -> Result<Trainer, SetupError> {
        let setups: Vec<Setup> = training
            .stage
            .iter()
            .map(|stage| Setup::of_stage(&training, stage))
            .collect::<Result<_, _>>()?;
        let first = &setups[0];
        let last = &setups[setups.len() - 1];
        let judges = judges(&training, last)?;
        let size = first.observation_size();
        if let Some(other) = setups
            .iter()
            .map(Setup::observation_size)
            .find(|other| *other != size)
        {
            return Err(wrong(
                "the observation size of a stage",
                other,
                &format!("{size}, as in the first stage"),
            ));
        }
        if let Some(other) = setups
            .iter()
            .find(|other| other.options() != first.options())
        {
            let list = |setup: &Setup| setup.options().unwrap_or_default().join(", ");
            let allowed = format!("those of the first stage: {}", list(first));
            return Err(wrong("the options of a stage", list(other), &allowed));
        }
        let state = state.unwrap_or_else(|| {
            let mut state = State::new(Learner::new(
                &training,
                first,
                last.actions().unwrap_or_default(),
            ));
            state.league.begin(first.opponents.len());
            state
        });
        let updates_per_epoch = setups
            .iter()
            .map(|setup| updates_per_epoch(&training, setup))
            .collect();
        let environment = environment(&training, &setups, &state, threads, None)?;
        let pool = pool(threads);
        let (watches, is_behind) = (None, !state.played.is_empty());
        Ok(Trainer {
            training,
            setups,
            judges,
            threads,
            pool,
            environment,
            watches,
            updates_per_epoch,
            state,
            is_behind,
        })
    }

    /// Adds watches for all episodes from now on, except those of evaluations. Numbers count up
    /// through a training run as if games were played to the end; if games end early, a number may
    /// recur with a different seed. Watches do not affect learning.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a game cannot begin.
    ///
    /// # Panics
    /// If the trainer has been updated since it was started or resumed, because its games would
    /// restart.
    pub fn watch(&mut self, watches: Watches) -> Result<(), SetupError> {
        assert!(
            self.state.updates_of_epoch == 0 || self.is_behind,
            "watches must be added before the first update"
        );
        self.watches = Some(watches);
        self.environment = environment(
            &self.training,
            &self.setups,
            &self.state,
            self.threads,
            self.watches.as_ref(),
        )?;
        Ok(())
    }

    /// The training.
    pub fn training(&self) -> &Training {
        &self.training
    }

    /// The current learner.
    pub fn learner(&self) -> &Learner {
        &self.state.learner
    }

    /// The number of samples learned so far, and the number in all stages.
    pub fn samples(&self) -> (u64, u64) {
        (
            self.state.samples,
            self.training.stage.iter().map(|stage| stage.samples).sum(),
        )
    }

    /// The best policy so far.
    pub fn best(&self) -> Option<&Best> {
        self.state.best.as_ref()
    }

    /// Whether all stages are complete.
    pub fn is_over(&self) -> bool {
        self.state.stage >= self.training.stage.len()
    }

    /// The state from which a training run can be resumed.
    pub fn state(&self) -> Vec<u8> {
        self.state.write(&self.training)
    }

    /// The current policy as an ONNX file.
    ///
    /// # Errors
    /// If a weight is not finite, because the training has diverged.
    pub fn model(&self) -> Result<Vec<u8>, onnx::NetworkError> {
        let mut metadata = BTreeMap::from(self.spec().metadata());
        let Training { name, seed, .. } = &self.training;
        metadata.extend([
            ("squall.training".to_owned(), name.clone()),
            ("squall.seed".to_owned(), seed.to_string()),
            (SAMPLES.to_owned(), self.state.samples.to_string()),
            ("squall.version".to_owned(), primitives::VERSION.to_owned()),
        ]);
        metadata.extend(
            self.setups
                .last()
                .and_then(Setup::options)
                .map(options_metadata),
        );
        self.state.learner.onnx(metadata)
    }

    /// The policy's spaces and period.
    pub fn spec(&self) -> PolicySpec {
        let Training {
            observation,
            action,
            period_s,
            ..
        } = self.training;
        PolicySpec {
            observation,
            action,
            period_s,
        }
    }

    /// Plays and learns once.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a new game cannot begin; [`SetupError::Diverged`] if the policy
    /// has non-finite weights.
    ///
    /// # Panics
    /// If all stages are complete.
    pub fn update(&mut self) -> Result<Progress, SetupError> {
        if std::mem::take(&mut self.is_behind) {
            play_again(&mut self.environment, &self.state.played)?;
        }
        let stage = self.state.stage;
        let mut stream = Stream::new(
            self.training.seed.wrapping_add(self.state.updates),
            "update",
        );
        let of_stage = &self.training.stage[stage];
        let weights = self.state.league.weights(of_stage, &self.training.league);
        self.environment.games.set_weights(weights.iter().copied());
        if self.state.played.is_empty() {
            self.state.past_at_restart = self.state.league.past().to_vec();
        }
        let (done, all) = self.samples();
        let done = (done, done as f32 / all.max(1) as f32);
        let Trainer {
            environment,
            pool,
            state,
            training,
            ..
        } = self;
        let update = match &mut state.learner {
            Learner::Ppo(learner) => update_by_ppo(
                learner,
                environment,
                pool,
                &training.ppo,
                done.1,
                &mut stream,
            )?,
            Learner::Td3(of) => of.update(environment, pool, stage == 0, &mut stream)?,
            Learner::Dqn(of) => of.update(environment, pool, done.0, &mut stream)?,
        };
        let Update {
            counted,
            reward,
            finished,
            learnt,
            ..
        } = update;
        let actions = environment.actions.replace(vec![]).unwrap_or_default();
        state.played.push(PlayedUpdate {
            weights,
            actions,
            kept: None,
        });
        state.updates += 1;
        state.updates_of_epoch += 1;
        state.samples += counted;
        state.samples_of_stage += counted;
        state.league.see(&finished);
        let first = first_number(training, state.epoch);
        let numbered = |one: Finished| Finished {
            number: one.number.wrapping_add(first),
            ..one
        };
        let name = |one: Finished| {
            (
                numbered(one),
                self.opponent_name(stage, one.standing.side.opponent),
            )
        };
        let finished = finished.into_iter().map(name).collect();
        let (evaluated, is_best) = self.after_update()?;
        let games_restart = self.begin_anew(evaluated.as_ref())?;
        let samples = self.state.samples;
        Ok(Progress {
            samples,
            stage,
            learnt,
            reward,
            finished,
            evaluated,
            is_best,
            games_restart,
        })
    }

    fn opponent_name(&self, stage: usize, opponent: usize) -> String {
        match self.environment.setup().opponents.get(opponent) {
            Some((_, Player::Policy)) => "itself".to_owned(),
            Some((_, Player::Strategy(strategy))) => strategy.name.clone(),
            Some((_, Player::Model(model))) => model.name.clone(),
            None => format!("opponent {opponent} of stage {stage}"),
        }
    }

    /// Evaluates the policy and adds it to the league if due.
    fn after_update(&mut self) -> Result<(Option<Evaluated>, bool), SetupError> {
        let Training {
            league, evaluation, ..
        } = &self.training;
        let plays_past = self.training.stage[self.state.stage].past_selves > 0.0;
        let diverged = |error: onnx::NetworkError| SetupError::Diverged(error.to_string());
        if plays_past && self.state.samples >= self.state.league.newest() + league.every_samples {
            let model = self.model().map_err(diverged)?;
            let kept = self
                .state
                .league
                .keep(self.state.samples, model, league.most);
            kept.into_iter().for_each(|model| {
                self.environment
                    .games
                    .add_opponent(Player::Model(Box::new(model)))
            });
            let played = self.state.played.last_mut();
            played
                .into_iter()
                .for_each(|played| played.kept = self.state.league.past().last().cloned());
        }
        let last = self.state.evaluations.last().map_or(0, |last| last.samples);
        let is_last = self.state.samples_of_stage >= self.training.stage[self.state.stage].samples;
        if !is_last && self.state.samples < last + evaluation.every_samples {
            return Ok((None, false));
        }
        let mut played = vec![];
        for (name, setup) in &self.judges {
            let actor = self.state.learner.actor();
            let games = evaluation.games.next_multiple_of(2) as usize;
            played.push((
                name.clone(),
                evaluate(actor, setup.clone(), games, self.threads, EVALUATION_SEED)?,
            ));
        }
        let evaluated = Evaluated {
            samples: self.state.samples,
            stage: self.state.stage,
            played,
        };
        let won = evaluated.won();
        // Decided by evaluation games with the same seeds each time, since returns from self-play
        // are not informative.
        let is_best = self.state.best.as_ref().is_none_or(|best| won >= best.won);
        if is_best {
            self.state.best = Some(Best {
                samples: self.state.samples,
                won,
                onnx: self.model().map_err(diverged)?,
            });
        }
        self.state.evaluations.push(evaluated.clone());
        Ok((Some(evaluated), is_best))
    }

    /// Starts the next stage or restarts all games if due; the state of the games then no longer
    /// matters.
    fn begin_anew(&mut self, evaluated: Option<&Evaluated>) -> Result<bool, SetupError> {
        let state = &mut self.state;
        let stage: &Stage = &self.training.stage[state.stage];
        let is_won = stage
            .until_won
            .zip(evaluated)
            .is_some_and(|(least, evaluated)| evaluated.won() >= least);
        let is_over = state.samples_of_stage >= stage.samples || is_won;
        if !is_over && state.updates_of_epoch < self.updates_per_epoch[state.stage] {
            return Ok(false);
        }
        // At any other time, a state would need every helm in every game; instead it contains the
        // actions since the last restart. After a restart, it contains only the learner and the
        // opponents.
        (state.epoch, state.updates_of_epoch) = (state.epoch + 1, 0);
        (state.past_at_restart, state.played) = (vec![], vec![]);
        if is_over {
            (state.stage, state.samples_of_stage) = (state.stage + 1, 0);
            state.learner.begin_stage();
        }
        match self.setups.get(state.stage) {
            Some(setup) if is_over => state.league.begin(setup.opponents.len()),
            Some(_) => state.league.compact(),
            None => return Ok(true),
        }
        self.environment = environment(
            &self.training,
            &self.setups,
            &self.state,
            self.threads,
            self.watches.as_ref(),
        )?;
        Ok(true)
    }
}

/// Plays and learns once by PPO. `done` is the fraction of all samples so far.
fn update_by_ppo(
    learner: &mut ActorCritic,
    environment: &mut VectorEnvironment,
    pool: &rayon::ThreadPool,
    ppo: &Ppo,
    done: f32,
    stream: &mut Stream,
) -> Result<Update, SetupError> {
    let rollout = Rollout::play(environment, pool, learner, ppo.steps, stream)?;
    let is_taught = environment.setup().teacher.is_some();
    let batch = rollout.batch(
        ppo,
        if is_taught {
            Lesson::Imitation
        } else {
            Lesson::Reinforcement
        },
    );
    let rate = 1.0 - (1.0 - ppo.learning_rate_end) * done.min(1.0);
    let learnt = pool.install(|| learner.update(&batch, ppo, rate, stream));
    let counted = batch.counts.iter().filter(|counts| **counts).count() as u64;
    let transitions = batch.actions.len() as u64;
    let reward = rollout.rewards().sum::<f32>() / transitions.max(1) as f32;
    Ok(Update {
        counted,
        transitions,
        reward,
        finished: rollout.finished,
        learnt,
    })
}

/// Starts the games of the current stage.
fn environment(
    training: &Training,
    setups: &[Setup],
    state: &State,
    threads: usize,
    watches: Option<&Watches>,
) -> Result<VectorEnvironment, SetupError> {
    // Nothing is played after the last stage.
    let mut setup = setups[state.stage.min(setups.len() - 1)].clone();
    let past: &[PastSelf] = if state.played.is_empty() {
        state.league.past()
    } else {
        &state.past_at_restart
    };
    setup.opponents.extend(
        past.iter()
            .filter_map(PastSelf::model)
            .map(|model| (0.0, Player::Model(Box::new(model)))),
    );
    let stage = &training.stage[state.stage.min(setups.len() - 1)];
    let at_restart = state.played.first().map(|played| played.weights.clone());
    let weights = at_restart.unwrap_or_else(|| state.league.weights(stage, &training.league));
    setup
        .opponents
        .iter_mut()
        .zip(weights)
        .for_each(|((weight, _), drawn)| *weight = drawn);
    let seed = (training.seed << (2 * SEEDS_BITS)).wrapping_add(state.epoch << SEEDS_BITS)
        % EVALUATION_SEED;
    let first = first_number(training, state.epoch);
    let watches = watches
        .cloned()
        .map(|watches| -> Watches { Arc::new(move |number| watches(first + number)) });
    let mut environment =
        VectorEnvironment::new(setup, training.games as usize, threads, seed, watches)?;
    environment.actions = Some(vec![]);
    Ok(environment)
}

/// Replays games from their restart through these updates.
fn play_again(
    environment: &mut VectorEnvironment,
    updates: &[PlayedUpdate],
) -> Result<(), SetupError> {
    for update in updates {
        environment
            .games
            .set_weights(update.weights.iter().copied());
        update
            .actions
            .chunks(environment.rows().0)
            .try_for_each(|actions| environment.step(actions))?;
        let kept = update.kept.iter().filter_map(PastSelf::model);
        kept.for_each(|model| {
            environment
                .games
                .add_opponent(Player::Model(Box::new(model)))
        });
    }
    environment.actions = Some(vec![]);
    Ok(())
}

fn first_number(training: &Training, epoch: u64) -> u64 {
    epoch * LENGTHS as u64 * u64::from(training.games)
}

/// The evaluation games: those of the last stage, against each opponent of the evaluation. They
/// need neither a teacher nor a critic's true state.
fn judges(training: &Training, last: &Setup) -> Result<Vec<(String, Setup)>, SetupError> {
    let base = Setup {
        teacher: None,
        critic: CriticInput::Observation,
        starts: None,
        steps_max: None,
        ..last.clone()
    };
    let judge = |path: &PathBuf| {
        let strategy = scenario::load_file::<scenario::strategy::Strategy>(path)?;
        let name = strategy.name.clone();
        let player = Player::Strategy(Box::new(strategy));
        Ok((
            name,
            Setup {
                opponents: vec![(1.0, player)],
                ..base.clone()
            },
        ))
    };
    training.evaluation.opponents.iter().map(judge).collect()
}

fn updates_per_epoch(training: &Training, setup: &Setup) -> u64 {
    let step = setup.scenario.decision() * i64::from(setup.decisions_per_step);
    let update = step * training.algorithm().steps() as i64;
    let game = setup
        .steps_max
        .map_or(setup.scenario.rules.time_limit, |steps| {
            step * i64::from(steps)
        });
    (LENGTHS * game.0 / update.0.max(1)).max(1) as u64
}

/// A thread pool for work on networks.
fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads can be started")
}

/// The network's output for every row of the input, in the calling thread pool.
fn outputs(network: &Perceptron, input: &[f32]) -> Vec<f32> {
    let sizes = network.sizes();
    let from = sizes[0];
    let to = sizes[sizes.len() - 1];
    let mut out = vec![0.0; input.len() / from * to];
    input
        .par_chunks(SHARD * from)
        .zip(out.par_chunks_mut(SHARD * to))
        .for_each_init(Trace::default, |trace, (rows, out)| {
            network.forward(rows, trace);
            out.copy_from_slice(trace.output());
        });
    out
}
