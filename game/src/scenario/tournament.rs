//! A tournament: who enters, and which game they play against each other.

use super::{Overrides, Problems, Scenario, load, load_with};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A tournament, ready to be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tournament {
    /// The tournament file's stem.
    pub name: String,
    /// The game file.
    pub game: PathBuf,
    /// The sea file that takes the place of the game's own.
    pub sea: Option<PathBuf>,
    /// Who enters: two at least, with names of their own.
    pub entries: Vec<Entrant>,
    /// How many games each pairing is to play, half of them on each side.
    pub games: u32,
    /// The first seed.
    pub seed: u64,
    /// Whether entries also play against themselves.
    pub self_play: bool,
}

/// Who enters a tournament.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entrant {
    /// Its name in the tables.
    pub name: String,
    /// The strategy file that all its boats follow.
    pub strategy: PathBuf,
}

impl Tournament {
    /// The names of the game's teams, the first one first.
    ///
    /// # Errors
    /// Everything that is wrong in the game's files.
    pub fn teams(&self) -> Result<Vec<String>, Problems> {
        Ok(load(&self.game)?.teams.into_iter().map(|team| team.name).collect())
    }

    /// What takes the place of the game's own files when one entry plays as the first of these teams and another as
    /// the second.
    ///
    /// # Panics
    /// If there are no such entries.
    #[must_use]
    pub fn overrides(&self, teams: &[String], sides: [usize; 2]) -> Overrides {
        let of_side = |side: usize| self.entries[side].strategy.clone();
        let strategies: BTreeMap<String, PathBuf> = teams.iter().cloned().zip(sides.map(of_side)).collect();
        Overrides { sea: self.sea.clone(), strategies, ..Overrides::default() }
    }

    /// The game in which one entry plays as the first team and another as the second.
    ///
    /// # Errors
    /// Everything that is wrong in any file.
    ///
    /// # Panics
    /// If there are no such entries.
    pub fn game_of(&self, teams: &[String], sides: [usize; 2]) -> Result<Scenario, Problems> {
        load_with(&self.game, &self.overrides(teams, sides))
    }
}
