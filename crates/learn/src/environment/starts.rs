//! The starts of an environment's games. Seeds count up, and repeat if the number of starts is
//! limited.

use super::game::Game;
use super::setup::{Setup, SetupError};
use super::watch::Watches;
use sim::Contest;
use std::sync::OnceLock;

pub(super) struct Starts {
    seed: u64,
    /// One game per repeating start, before its first step; created on first use.
    made: Vec<OnceLock<Contest>>,
    watches: Option<Watches>,
}

impl Starts {
    pub(super) fn new(setup: &Setup, seed: u64, watches: Option<Watches>) -> Starts {
        let count = setup.starts.unwrap_or_default();
        Starts {
            seed,
            made: (0..count).map(|_| OnceLock::new()).collect(),
            watches,
        }
    }

    /// Copies the starts with a different first seed.
    pub(super) fn from(&self, setup: &Setup, seed: u64) -> Starts {
        Starts::new(setup, seed, self.watches.clone())
    }

    pub(super) fn end_watches(&mut self) {
        self.watches = None;
    }

    /// The game with this seed. `number` determines whether it is watched.
    pub(super) fn game(&self, setup: &Setup, number: u64, seed: u64) -> Result<Game, SetupError> {
        let watch = self.watches.as_ref().and_then(|watches| watches(number));
        // Repeating starts must outnumber the parallel games: with 64 of each, every game always
        // had the same start, and the policy learned nothing. A repeated start takes 0.03 ms; a new
        // start with a sea takes 0.41 ms.
        let index = seed
            .wrapping_sub(self.seed)
            .checked_rem(self.made.len() as u64);
        let seed = index.map_or(seed, |index| self.seed.wrapping_add(index));
        let place = index.map(|index| &self.made[index as usize]);
        let contest = match place.and_then(OnceLock::get) {
            Some(contest) => contest.clone(),
            None => Contest::new(setup.scenario_of(seed)?.as_ref(), seed)?,
        };
        if let Some(place) = place {
            place.get_or_init(|| contest.clone());
        }
        Ok(Game::new(setup, contest, seed, watch))
    }

    pub(super) fn check(&self, seed: u64) -> Result<(), SetupError> {
        if !self.made.is_empty() && seed.wrapping_sub(self.seed) >= self.made.len() as u64 {
            let last = self.seed.wrapping_add(self.made.len() as u64 - 1);
            return Err(SetupError::SeedOfStarts {
                seed,
                first: self.seed,
                last,
            });
        }
        Ok(())
    }
}
