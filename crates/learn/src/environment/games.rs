//! Many parallel games, stepped together on several threads; results go to the caller's slices.

use super::game::{Ending, Game, Side};
use super::setup::{Player, Setup, SetupError};
use super::starts::Starts;
use super::truth;
use super::watch::Watches;
use agent::Action;
use primitives::VehicleId;
use rayon::prelude::*;
use rules::count::Counts;
use rules::event::Logged;
use sim::Contest;

/// The state of play of a game.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// The seed; together with the setup, it identifies the game.
    pub seed: u64,
    /// The sides.
    pub side: Side,
    /// Points of the learning policy and its enemies.
    pub score: [u32; 2],
    /// Event counts of the learning policy and its enemies.
    pub counts: [Counts; 2],
    /// Policy steps so far.
    pub steps: u32,
}

/// An episode that has ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finished {
    /// Index of the game.
    pub game: usize,
    /// Episode number: numbers count up first across the games, then across their episodes.
    pub number: u64,
    /// The state of play at the end.
    pub standing: Standing,
    /// Whether it ended before the game was over.
    pub cut_off: bool,
}

/// The results of a step, one row per boat that may receive actions. Within each game the learning
/// policy's boats come first, then, if any opponent is a policy, those of its enemies.
#[derive(Debug)]
pub struct Rows<'a> {
    /// The observations, rows × values.
    pub observations: &'a mut [f32],
    /// The last observations of games that ended in this step, rows × values. Other rows are not
    /// written.
    pub final_observations: &'a mut [f32],
    /// The reward of the step, by row.
    pub rewards: &'a mut [f32],
    /// By row, whether the next action takes effect. It does not for a tagged boat, nor for an
    /// enemy that a strategy controls.
    pub counts: &'a mut [bool],
}

/// Parallel games; each restarts when it is over.
///
/// Rows depend only on the setup, the seed and the actions, not on the number of threads.
pub struct Games {
    setup: Setup,
    slots: Vec<Slot>,
    starts: Starts,
    /// `None` for a single thread, because a step takes less time than waking another thread.
    pool: Option<rayon::ThreadPool>,
    rows_per_game: usize,
    observation_size: usize,
    finished: Vec<Finished>,
}

/// Plays games one after the other.
struct Slot {
    game: Game,
    /// The game that ended in the last step and has been replaced.
    last: Option<Game>,
    /// Number of the current game; each new game increases it by the number of slots.
    number: u64,
    /// Seed of the current game; increases in the same way. With repeating starts, it selects one
    /// of them.
    seed: u64,
    ended: Option<Finished>,
    /// The teacher's actions in the last step, by row.
    taught: Vec<Option<Action>>,
    /// The critic's additional input, row by row: current, and at the end of the last game.
    truth: [Vec<f32>; 2],
    /// Whether the boats have been observed: a second observation would be a second decision.
    is_shown: bool,
}

impl Games {
    /// Starts `games` games on `threads` threads, with watches on request. Seeds count up from
    /// `seed`, first across the games, then across their episodes.
    ///
    /// # Errors
    /// [`SetupError`] if the setup cannot be played.
    pub fn new(
        setup: Setup,
        games: usize,
        threads: usize,
        seed: u64,
        watches: Option<Watches>,
    ) -> Result<Games, SetupError> {
        setup.check()?;
        let starts = Starts::new(&setup, seed, watches);
        let slot = |i: usize| {
            let seed = seed.wrapping_add(i as u64);
            let game = starts.game(&setup, i as u64, seed)?;
            let taught = vec![];
            let truth = [vec![], vec![]];
            Ok(Slot {
                game,
                last: None,
                number: i as u64,
                seed,
                ended: None,
                taught,
                truth,
                is_shown: false,
            })
        };
        let slots: Result<Vec<Slot>, SetupError> = (0..games).map(slot).collect();
        Ok(Games {
            slots: slots?,
            starts,
            pool: (threads > 1).then(|| pool(threads)),
            rows_per_game: setup.rows_per_game(),
            observation_size: setup.observation_size(),
            setup,
            finished: Vec::new(),
        })
    }

    /// The setup.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Adds an opponent with a draw weight of 0.
    pub(crate) fn add_opponent(&mut self, player: Player) {
        self.setup.opponents.push((0.0, player));
    }

    /// Sets the opponents' draw weights from each slot's next game on. Missing weights are 0.
    pub(crate) fn set_weights(&mut self, weights: impl IntoIterator<Item = f64>) {
        let mut weights = weights.into_iter();
        self.setup
            .opponents
            .iter_mut()
            .for_each(|(weight, _)| *weight = weights.next().unwrap_or(0.0));
    }

    /// The total number of rows, and the number per game.
    pub fn rows(&self) -> (usize, usize) {
        (self.slots.len() * self.rows_per_game, self.rows_per_game)
    }

    /// The episodes that ended in the last step, in the order of their games.
    pub fn finished(&self) -> &[Finished] {
        &self.finished
    }

    /// The teacher's actions in a game's last step, by row. `None` if the policy has no
    /// corresponding action.
    pub fn taught(&self, game: usize) -> &[Option<Action>] {
        &self.slots[game].taught
    }

    /// The values beyond the observations that a critic receives for a game, row by row: the
    /// current ones, and those at the end of a game that ended in the last step.
    pub fn truth(&self, game: usize) -> (&[f32], &[f32]) {
        let [now, last] = &self.slots[game].truth;
        (now, last)
    }

    /// Removes all watches.
    pub fn end_watches(&mut self) {
        self.starts.end_watches();
        self.slots.iter_mut().for_each(|slot| slot.game.end_watch());
    }

    /// Restarts the threads in a child process, which inherits none, and removes the watches.
    pub fn continue_after_fork(&mut self) {
        self.starts.end_watches();
        // Drop neither the watches nor the old pool: dropping them would wait for threads of the
        // parent process.
        self.slots
            .iter_mut()
            .for_each(|slot| slot.game.forget_watch());
        if let Some(lost) = self.pool.take() {
            self.pool = Some(pool(lost.current_num_threads()));
            std::mem::forget(lost);
        }
    }

    /// The game of a slot's last step, even if it has ended and been replaced, and its events in
    /// that step.
    pub fn last_step(&self, game: usize) -> (&Contest, &[Logged]) {
        let slot = &self.slots[game];
        let game = slot.last.as_ref().unwrap_or(&slot.game);
        (game.contest(), game.events())
    }

    /// The game that a slot is playing.
    pub fn contest(&self, game: usize) -> &Contest {
        self.slots[game].game.contest()
    }

    /// The boat of each row of a game; `None` if no boat receives the row's actions.
    pub fn boats(&self, game: usize) -> &[Option<VehicleId>] {
        self.slots[game].game.rows()
    }

    /// A game's state of play.
    pub fn standing(&self, game: usize) -> Standing {
        self.slots[game].game.standing()
    }

    /// Writes the rows of games that have begun since the last write. Other rows remain unchanged.
    ///
    /// # Panics
    /// If a slice does not have one entry per row.
    pub fn show(&mut self, rows: Rows<'_>) {
        self.for_each_game(rows, |setup, _, _, slot, rows| {
            if !slot.is_shown {
                rows.rewards.fill(0.0);
                slot.show(setup, rows);
            }
        });
    }

    /// Restarts all games with seeds from `seed` on, as in [`Games::new`], or with the next seeds.
    /// [`Games::show`] writes their rows.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a game cannot begin.
    pub fn restart(&mut self, seed: Option<u64>) -> Result<(), SetupError> {
        let count = self.slots.len() as u64;
        if let Some(seed) = seed {
            self.starts = self.starts.from(&self.setup, seed);
            for (i, slot) in (0..).zip(&mut self.slots) {
                (slot.number, slot.seed) = (i, seed.wrapping_add(i));
            }
        } else {
            self.slots.iter_mut().for_each(|slot| slot.count_on(count));
        }
        self.finished.clear();
        let Games {
            slots,
            starts,
            setup,
            pool,
            ..
        } = self;
        let begin = |slot: &mut Slot| slot.begin(setup, starts).map(drop);
        let begun: Vec<Result<(), SetupError>> = match pool {
            Some(pool) => pool.install(|| slots.par_iter_mut().map(begin).collect()),
            None => slots.iter_mut().map(begin).collect(),
        };
        begun.into_iter().collect()
    }

    /// Restarts one game with this seed, or with its next seed. Later seeds continue from there in
    /// steps of the number of games. [`Games::show`] writes its rows.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if it cannot begin; [`SetupError::SeedOfStarts`] if the seed is not
    /// one of the repeating starts.
    pub fn restart_game(&mut self, game: usize, seed: Option<u64>) -> Result<(), SetupError> {
        let count = self.slots.len() as u64;
        let slot = &mut self.slots[game];
        if let Some(seed) = seed {
            self.starts.check(seed)?;
            slot.seed = seed.wrapping_sub(count);
        }
        slot.count_on(count);
        self.finished.clear();
        slot.begin(&self.setup, &self.starts).map(drop)
    }

    /// Plays one step of every game with one action per row. A game that ends restarts in the same
    /// step if `restarts` is true; otherwise it restarts in the next step, whose action and reward
    /// do not count.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a new game cannot begin.
    ///
    /// # Panics
    /// If the number of actions or the length of a slice is not the number of rows.
    pub fn step(
        &mut self,
        actions: &[Action],
        restarts: bool,
        rows: Rows<'_>,
    ) -> Result<(), SetupError> {
        assert_eq!(actions.len(), self.rows().0, "one action per row");
        let count = self.slots.len() as u64;
        let per_game = self.rows_per_game;
        let begun = self.for_each_game(rows, |setup, starts, i, slot, rows| {
            if !slot.is_shown {
                slot.show(setup, rows);
            }
            if !restarts && slot.ended.is_some() {
                slot.count_on(count);
                slot.begin(setup, starts)?;
                rows.rewards.fill(0.0);
                slot.show(setup, rows);
                return Ok(());
            }
            slot.play(setup, i, &actions[i * per_game..(i + 1) * per_game], rows);
            if slot.ended.is_none() {
                return Ok(());
            }
            rows.final_observations.copy_from_slice(rows.observations);
            let [now, last] = &mut slot.truth;
            last.clone_from(now);
            if restarts {
                let ended = slot.ended;
                slot.count_on(count);
                slot.last = Some(slot.begin(setup, starts)?);
                slot.ended = ended;
                slot.show(setup, rows);
            }
            Ok(())
        });
        self.finished.clear();
        self.finished
            .extend(self.slots.iter().filter_map(|slot| slot.ended));
        begun.into_iter().collect()
    }

    fn for_each_game<T: Send>(
        &mut self,
        rows: Rows<'_>,
        work: impl Fn(&Setup, &Starts, usize, &mut Slot, &mut Rows<'_>) -> T + Sync,
    ) -> Vec<T> {
        let Games {
            setup,
            starts,
            slots,
            pool,
            rows_per_game: per_game,
            observation_size,
            ..
        } = self;
        let numbers = *per_game * *observation_size;
        let count = slots.len();
        assert!(
            rows.observations.len() == count * numbers
                && rows.final_observations.len() == count * numbers
        );
        assert!(rows.rewards.len() == count * *per_game && rows.counts.len() == count * *per_game);
        let games = slots
            .iter_mut()
            .zip(rows.observations.chunks_exact_mut(numbers))
            .zip(rows.final_observations.chunks_exact_mut(numbers))
            .zip(rows.rewards.chunks_exact_mut(*per_game))
            .zip(rows.counts.chunks_exact_mut(*per_game))
            .map(
                |((((slot, observations), final_observations), rewards), counts)| {
                    (
                        slot,
                        Rows {
                            observations,
                            final_observations,
                            rewards,
                            counts,
                        },
                    )
                },
            );
        let work = |(i, (slot, mut rows)): (usize, (&mut Slot, Rows<'_>))| {
            work(setup, starts, i, slot, &mut rows)
        };
        match pool {
            Some(pool) => {
                let games: Vec<_> = games.enumerate().collect();
                pool.install(|| games.into_par_iter().map(work).collect())
            }
            None => games.enumerate().map(work).collect(),
        }
    }
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads can be started")
}

impl Slot {
    fn count_on(&mut self, games: u64) {
        self.number = self.number.wrapping_add(games);
        self.seed = self.seed.wrapping_add(games);
    }

    /// Begins the next game, and returns the previous one.
    fn begin(&mut self, setup: &Setup, starts: &Starts) -> Result<Game, SetupError> {
        let game = starts.game(setup, self.number, self.seed)?;
        self.is_shown = false;
        (self.last, self.ended) = (None, None);
        Ok(std::mem::replace(&mut self.game, game))
    }

    fn play(&mut self, setup: &Setup, game: usize, actions: &[Action], rows: &mut Rows<'_>) {
        self.last = None;
        for (row, action) in actions.iter().enumerate() {
            self.game.act(row, *action);
        }
        let ending = self.game.step(setup);
        for (row, reward) in rows.rewards.iter_mut().enumerate() {
            *reward = self.game.reward_of(row) as f32;
        }
        self.taught.clear();
        if setup.teacher.is_some() {
            self.taught
                .extend((0..actions.len()).map(|row| self.game.taught(row)));
        }
        self.show(setup, rows);
        self.ended = (ending != Ending::None).then(|| Finished {
            game,
            number: self.number,
            standing: self.game.standing(),
            cut_off: ending == Ending::CutOff,
        });
    }

    fn show(&mut self, setup: &Setup, rows: &mut Rows<'_>) {
        let size = rows.observations.len() / rows.rewards.len();
        self.is_shown = true;
        for (row, observation) in rows.observations.chunks_exact_mut(size).enumerate() {
            rows.counts[row] = self.game.observe(row, observation);
        }
        if setup.truth_size() > 0 {
            self.truth[0].clear();
            let slots = setup.team_size();
            truth::write(
                self.game.contest(),
                self.game.rows(),
                slots,
                &mut self.truth[0],
            );
        }
    }
}
