//! Which games a tournament consists of.

use super::{Entrant, Tournament};
use crate::{Packed, UnpackError};
use scenario::{Files, Problem, Problems, Scenario, digest_of};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// A tournament with everything that its games need.
#[derive(Clone, Debug)]
pub struct Plan {
    tournament: Tournament,
    /// The names of the game's two teams.
    teams: Vec<String>,
    seeds: u64,
    /// What is played with each seed: who is the first team and who the second, and the game.
    rounds: Vec<([usize; 2], Scenario)>,
    files: Arc<Files>,
}

/// One game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Match {
    /// Chooses the game.
    pub seed: u64,
    /// Which entry plays as the first team, and which as the second.
    pub sides: [usize; 2],
}

impl Plan {
    /// The games of a tournament: of every entry with every other, or of the challenger with every other. All pairings play the
    /// same seeds, each of them twice, with the sides exchanged; an entry against itself plays them once, since exchanged sides are
    /// the same game.
    ///
    /// # Errors
    /// Everything that is wrong in the files, also in what they are together; and a game with real boats, which cannot
    /// be played here.
    pub fn new(tournament: &Tournament) -> Result<Plan, Problems> {
        Plan::of_files(tournament, Arc::default())
    }

    fn of_files(tournament: &Tournament, files: Arc<Files>) -> Result<Plan, Problems> {
        let teams = tournament.teams(&files)?;
        let count = tournament.entries.len();
        let is_played = |sides: [usize; 2]| {
            let is_there = |name: &String| sides.iter().any(|side| tournament.entries[*side].name == *name);
            tournament.challenger.as_ref().is_none_or(is_there)
        };
        let mut rounds = vec![];
        for one in 0..count {
            for other in (one..count).filter(|other| is_played([one, *other])) {
                let both = [[one, other], [other, one]];
                let sides = match (one == other, tournament.self_play) {
                    (true, true) => &both[..1],
                    (true, false) => &[],
                    (false, _) => &both[..],
                };
                for sides in sides {
                    rounds.push((*sides, game_of(tournament, &teams, *sides, &files)?));
                }
            }
        }
        let seeds = u64::from(tournament.games).div_ceil(2);
        Ok(Plan { tournament: tournament.clone(), teams, seeds, rounds, files })
    }

    /// The tournament.
    #[must_use]
    pub fn tournament(&self) -> &Tournament {
        &self.tournament
    }

    /// The names of the game's teams, the first one first.
    #[must_use]
    pub fn teams(&self) -> &[String] {
        &self.teams
    }

    /// How many seeds are played, from the tournament's own on.
    #[must_use]
    pub fn seeds(&self) -> u64 {
        self.seeds
    }

    /// How many games are played with each seed.
    #[must_use]
    pub fn games_per_seed(&self) -> usize {
        self.rounds.len()
    }

    /// How many games are played.
    #[must_use]
    pub fn games(&self) -> usize {
        usize::try_from(self.seeds).map_or(usize::MAX, |seeds| seeds.saturating_mul(self.rounds.len()))
    }

    /// The game at `index`, seed by seed: whoever stops early has whole seeds.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn match_at(&self, index: usize) -> (Match, &Scenario) {
        assert!(index < self.games(), "match {index} of {}", self.games());
        let (sides, scenario) = &self.rounds[index % self.rounds.len()];
        // Whole seeds first: a seed counts when all its games were played, or an entry would be
        // measured against some of its opponents, perhaps the easy ones.
        let seed = self.tournament.seed.wrapping_add((index / self.rounds.len()) as u64);
        (Match { seed, sides: *sides }, scenario)
    }

    /// The place of a game.
    ///
    /// # Panics
    /// If it has none.
    #[must_use]
    pub fn place_of(&self, of: Match) -> usize {
        let round = self.rounds.iter().position(|(sides, _)| *sides == of.sides).expect("they play each other");
        of.seed.wrapping_sub(self.tournament.seed) as usize * self.rounds.len() + round
    }

    /// What identifies the games that are played with each seed, in their order: what the program makes of their files. Of another version,
    /// or with another file, it is another game; entries may have other names, and files may lie elsewhere.
    #[must_use]
    pub fn pairings(&self) -> Vec<String> {
        self.rounds.iter().map(|(_, scenario)| scenario.digest()).collect()
    }

    /// What identifies it. It depends on what files say and not on where they lie: of two that lie elsewhere but name each other in the
    /// same way it is the same.
    #[must_use]
    pub fn digest(&self) -> String {
        let nowhere = |entry: &Entrant| Entrant { strategy: PathBuf::new(), ..entry.clone() };
        let (entries, sea) = (self.tournament.entries.iter().map(nowhere).collect(), self.tournament.sea.is_some());
        let meant = Tournament { game: PathBuf::new(), sea: None, entries, ..self.tournament.clone() };
        digest_of(&format!("{meant:?} {sea}"), &self.files.list())
    }

    /// It with all that its games need, for a process on another machine.
    #[must_use]
    pub fn pack(&self) -> Packed {
        Packed::new(&self.tournament, self.files.list(), self.digest())
    }

    /// The plan that was packed elsewhere.
    ///
    /// # Errors
    /// [`UnpackError`]: it is damaged, or another version of Squall packed it.
    pub fn unpack(packed: Packed) -> Result<Plan, UnpackError> {
        packed.unpack(Plan::of_files, Plan::digest)
    }
}

/// The game in which one entry plays as the first team and another as the second, if it can be played here.
fn game_of(
    tournament: &Tournament,
    teams: &[String],
    sides: [usize; 2],
    files: &Arc<Files>,
) -> Result<Scenario, Problems> {
    let scenario = tournament.game_of(teams, sides, files)?;
    let at_top = |message| Problems(vec![Problem::of_file(tournament.game.clone(), message)]);
    scenario.has_no_real_boats().map_err(|real_boats| at_top(real_boats.to_string()))?;
    Ok(scenario)
}
