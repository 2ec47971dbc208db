//! Games with their own buffers: from actions to observations and rewards.

use super::game::Side;
use super::games::{Finished, Games, Rows};
use super::setup::{Player, Setup, SetupError};
use super::watch::Watches;
use agent::Action;
use sim::Contest;

/// [`Games`] that store their last results.
pub struct VectorEnvironment {
    games: Games,
    shown: Shown,
}

/// The buffers of [`Rows`].
struct Shown {
    observations: Vec<f32>,
    final_observations: Vec<f32>,
    rewards: Vec<f32>,
    counts: Vec<bool>,
    /// A critic's inputs, rows × values, and those before a new game began; empty if they are the
    /// observations.
    states: Vec<f32>,
    final_states: Vec<f32>,
}

impl Shown {
    fn rows(&mut self) -> Rows<'_> {
        let Shown { observations, final_observations, rewards, counts, .. } = self;
        Rows { observations, final_observations, rewards, counts }
    }
}

impl VectorEnvironment {
    /// Starts `games` games on `threads` threads. Seeds count up from `seed`, game by game and
    /// episode by episode.
    ///
    /// # Errors
    /// [`SetupError`] if the setup cannot be played.
    pub fn new(setup: Setup, games: usize, threads: usize, seed: u64) -> Result<VectorEnvironment, SetupError> {
        VectorEnvironment::watched(setup, games, threads, seed, None)
    }

    /// Like [`VectorEnvironment::new`], with watches.
    ///
    /// # Errors
    /// [`SetupError`] if the setup cannot be played.
    pub fn watched(
        setup: Setup,
        games: usize,
        threads: usize,
        seed: u64,
        watches: Option<Watches>,
    ) -> Result<VectorEnvironment, SetupError> {
        let mut games = Games::watched(setup, games, threads, seed, watches)?;
        let (rows, numbers) = (games.rows().0, games.rows().0 * games.setup().observation_size());
        let mut shown = Shown {
            observations: vec![0.0; numbers],
            final_observations: vec![0.0; numbers],
            rewards: vec![0.0; rows],
            counts: vec![false; rows],
            states: vec![],
            final_states: vec![],
        };
        games.show(shown.rows());
        let mut environment = VectorEnvironment { games, shown };
        environment.note_states();
        Ok(environment)
    }

    /// The setup.
    #[must_use]
    pub fn setup(&self) -> &Setup {
        self.games.setup()
    }

    /// Adds an opponent with weight 0.
    pub fn add_opponent(&mut self, player: Player) {
        self.games.add_opponent(player);
    }

    /// Sets the opponents' draw weights from each slot's next game on; missing ones are 0.
    pub fn set_weights(&mut self, weights: impl IntoIterator<Item = f64>) {
        self.games.set_weights(weights);
    }

    /// The number of rows in all, and per game.
    #[must_use]
    pub fn rows(&self) -> (usize, usize) {
        self.games.rows()
    }

    /// The observation of every boat, rows × values.
    #[must_use]
    pub fn observations(&self) -> &[f32] {
        &self.shown.observations
    }

    /// The boats' last observations before a new game began, rows × values; valid only for games
    /// that ended in the last step.
    #[must_use]
    pub fn final_observations(&self) -> &[f32] {
        &self.shown.final_observations
    }

    /// A critic's inputs, rows × [`Setup::state_size`].
    #[must_use]
    pub fn states(&self) -> &[f32] {
        if self.setup().truth_size() == 0 { &self.shown.observations } else { &self.shown.states }
    }

    /// The same before a new game began; valid only for games that ended in the last step.
    #[must_use]
    pub fn final_states(&self) -> &[f32] {
        if self.setup().truth_size() == 0 { &self.shown.final_observations } else { &self.shown.final_states }
    }

    /// The teacher's actions for the boats of a game in the last step, by row: see
    /// [`Games::taught`].
    #[must_use]
    pub fn taught(&self, game: usize) -> &[Option<Action>] {
        self.games.taught(game)
    }

    /// The rewards of the last step, by row.
    #[must_use]
    pub fn rewards(&self) -> &[f32] {
        &self.shown.rewards
    }

    /// By row, whether its next action takes effect: false for a tagged boat, and where a strategy
    /// plays the enemies.
    #[must_use]
    pub fn counts(&self) -> &[bool] {
        &self.shown.counts
    }

    /// The episodes that ended in the last step, by game.
    #[must_use]
    pub fn finished(&self) -> &[Finished] {
        self.games.finished()
    }

    /// The number of boats of a game that receive actions: its first rows.
    #[must_use]
    pub fn boats(&self, game: usize) -> usize {
        self.games.boats(game).len()
    }

    /// The current game in a slot.
    #[must_use]
    pub fn contest(&self, game: usize) -> &Contest {
        self.games.contest(game)
    }

    /// The sides of a game.
    #[must_use]
    pub fn side(&self, game: usize) -> Side {
        self.games.standing(game).side
    }

    /// Plays one step of every game with an action for each row.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a new game cannot begin.
    ///
    /// # Panics
    /// If there is not one action for each row.
    pub fn step(&mut self, actions: &[Action]) -> Result<(), SetupError> {
        self.games.step(actions, self.shown.rows())?;
        self.note_states();
        Ok(())
    }

    /// Joins observations and the truth.
    fn note_states(&mut self) {
        let truth = self.setup().truth_size();
        if truth == 0 {
            return;
        }
        let (size, (rows, per_game)) = (self.setup().observation_size(), self.rows());
        let VectorEnvironment { games, shown } = self;
        let Shown { observations, final_observations, states, final_states, .. } = shown;
        for (states, observations, is_last) in
            [(states, &*observations, false), (final_states, &*final_observations, true)]
        {
            states.resize(rows * (size + truth), 0.0);
            for (row, state) in states.chunks_exact_mut(size + truth).enumerate() {
                let (game, place) = (row / per_game, row % per_game);
                let (now, last) = games.truth(game);
                let of_game = if is_last { last } else { now };
                state[..size].copy_from_slice(&observations[row * size..(row + 1) * size]);
                match of_game.get(place * truth..(place + 1) * truth) {
                    Some(numbers) => state[size..].copy_from_slice(numbers),
                    None => state[size..].fill(0.0),
                }
            }
        }
    }
}
