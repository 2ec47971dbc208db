//! Games with their own result buffers.

use super::games::{Games, Rows};
use super::setup::{Setup, SetupError};
use super::watch::Watches;
use agent::Action;
use std::ops::Deref;

/// [`Games`] that store their latest results.
pub struct VectorEnvironment {
    pub(crate) games: Games,
    shown: Shown,
    /// The actions of all steps, while a caller collects them.
    pub(crate) actions: Option<Vec<Action>>,
}

impl Deref for VectorEnvironment {
    type Target = Games;

    fn deref(&self) -> &Games {
        &self.games
    }
}

/// The buffers of [`Rows`].
struct Shown {
    observations: Vec<f32>,
    final_observations: Vec<f32>,
    rewards: Vec<f32>,
    counts: Vec<bool>,
    /// A critic's inputs, rows × values, and those at the end of a game; empty if the critic
    /// receives only the observations.
    states: Vec<f32>,
    final_states: Vec<f32>,
}

impl Shown {
    fn rows(&mut self) -> Rows<'_> {
        let Shown {
            observations,
            final_observations,
            rewards,
            counts,
            ..
        } = self;
        Rows {
            observations,
            final_observations,
            rewards,
            counts,
        }
    }
}

impl VectorEnvironment {
    /// Starts games as [`Games::new`] does.
    ///
    /// # Errors
    /// [`SetupError`] if the setup cannot be played.
    pub fn new(
        setup: Setup,
        games: usize,
        threads: usize,
        seed: u64,
        watches: Option<Watches>,
    ) -> Result<VectorEnvironment, SetupError> {
        let mut games = Games::new(setup, games, threads, seed, watches)?;
        let rows = games.rows().0;
        let numbers = games.rows().0 * games.setup().observation_size();
        let mut shown = Shown {
            observations: vec![0.0; numbers],
            final_observations: vec![0.0; numbers],
            rewards: vec![0.0; rows],
            counts: vec![false; rows],
            states: vec![],
            final_states: vec![],
        };
        games.show(shown.rows());
        let mut environment = VectorEnvironment {
            games,
            shown,
            actions: None,
        };
        environment.note_states();
        Ok(environment)
    }

    /// The observations, rows × values.
    pub fn observations(&self) -> &[f32] {
        &self.shown.observations
    }

    /// The last observations before a new game began, rows × values. Valid only for games that
    /// ended in the last step.
    pub fn final_observations(&self) -> &[f32] {
        &self.shown.final_observations
    }

    /// A critic's inputs, rows × [`Setup::state_size`].
    pub fn states(&self) -> &[f32] {
        if self.setup().truth_size() == 0 {
            &self.shown.observations
        } else {
            &self.shown.states
        }
    }

    /// A critic's inputs before a new game began. Valid only for games that ended in the last step.
    pub fn final_states(&self) -> &[f32] {
        if self.setup().truth_size() == 0 {
            &self.shown.final_observations
        } else {
            &self.shown.final_states
        }
    }

    /// The rewards of the last step, by row.
    pub fn rewards(&self) -> &[f32] {
        &self.shown.rewards
    }

    /// By row, whether the next action takes effect; see [`Rows::counts`](super::Rows::counts).
    pub fn counts(&self) -> &[bool] {
        &self.shown.counts
    }

    /// Plays one step of every game with one action per row.
    ///
    /// # Errors
    /// [`SetupError::NoStart`] if a new game cannot begin.
    ///
    /// # Panics
    /// If the number of actions is not the number of rows.
    pub fn step(&mut self, actions: &[Action]) -> Result<(), SetupError> {
        self.games.step(actions, true, self.shown.rows())?;
        self.actions
            .iter_mut()
            .for_each(|collected| collected.extend_from_slice(actions));
        self.note_states();
        Ok(())
    }

    /// Joins the observations with the true state.
    fn note_states(&mut self) {
        let truth = self.setup().truth_size();
        if truth == 0 {
            return;
        }
        let size = self.setup().observation_size();
        let (rows, per_game) = self.rows();
        let VectorEnvironment { games, shown, .. } = self;
        let Shown {
            observations,
            final_observations,
            states,
            final_states,
            ..
        } = shown;
        for (states, observations, is_last) in [
            (states, &*observations, false),
            (final_states, &*final_observations, true),
        ] {
            states.resize(rows * (size + truth), 0.0);
            for (row, state) in states.chunks_exact_mut(size + truth).enumerate() {
                let game = row / per_game;
                let place = row % per_game;
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
