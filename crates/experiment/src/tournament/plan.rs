//! The games of a tournament.

use super::file::EntryKind;
use super::{Entrant, Tournament};
use crate::jobs::{load_game, teams_of, too_many_games};
use crate::{Packed, UnpackError};
use primitives::TeamId;
use scenario::{Files, Overrides, Problems, Scenario, digest_of};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// A tournament with all required files.
#[derive(Clone, Debug)]
pub struct Plan {
    tournament: Tournament,
    /// The names of the game's two teams.
    teams: Vec<String>,
    seeds: u64,
    /// The entries' kinds.
    kinds: Vec<EntryKind>,
    /// The games of each seed.
    rounds: Vec<Round>,
    files: Arc<Files>,
}

/// A game, for every seed.
#[derive(Clone, Debug)]
struct Round {
    /// The entries of the first and second team.
    sides: [usize; 2],
    /// Index into [`Tournament::seas`].
    sea: usize,
    scenario: Scenario,
}

/// One game.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Match {
    /// The seed of the game.
    pub seed: u64,
    /// The indices of the entries that play as the first and the second team.
    pub sides: [usize; 2],
    /// The index of the sea in [`Tournament::seas`].
    #[serde(default)]
    pub sea: usize,
}

impl Plan {
    /// The games of a tournament: every entry, or the challenger, against every other entry in every
    /// sea. All pairings play the same seeds, each of them twice with sides exchanged. An entry plays each
    /// seed only once against itself, since exchanging sides would give the same game.
    ///
    /// # Errors
    /// All problems in the files and their combination; also a game with real boats, which cannot
    /// be played in a tournament.
    pub fn new(tournament: &Tournament) -> Result<Plan, Problems> {
        Plan::of_files(tournament, Arc::default())
    }

    fn of_files(tournament: &Tournament, files: Arc<Files>) -> Result<Plan, Problems> {
        let teams = teams_of(&tournament.game, &files)?;
        let is_played = |sides: [usize; 2]| {
            let is_there = |name: &String| {
                sides
                    .iter()
                    .any(|side| tournament.entries[*side].name == *name)
            };
            tournament.challenger.as_ref().is_none_or(is_there)
        };
        let pairs = pairs(tournament).into_iter();
        let pairs: Vec<[usize; 2]> = pairs.filter(|sides| is_played(*sides)).collect();
        let mut rounds = vec![];
        for (sea, file) in tournament.seas().into_iter().enumerate() {
            for sides in &pairs {
                let strategy = |entry: usize| tournament.entries[entry].strategy.clone();
                let strategies = teams.iter().cloned().zip(sides.map(strategy)).collect();
                let overrides = Overrides {
                    sea: file.cloned(),
                    strategies,
                    ..Overrides::default()
                };
                rounds.push(Round {
                    sides: *sides,
                    sea,
                    scenario: load_game(&tournament.game, &overrides, &files, &tournament.game)?,
                });
            }
        }
        let seeds = u64::from(tournament.games).div_ceil(2);
        let plan = Plan {
            tournament: tournament.clone(),
            teams,
            seeds,
            kinds: kinds(tournament, &rounds),
            rounds,
            files,
        };
        match too_many_games(plan.games(), &tournament.game) {
            Some(problem) => Err(Problems(vec![problem])),
            None => Ok(plan),
        }
    }

    /// The tournament.
    pub fn tournament(&self) -> &Tournament {
        &self.tournament
    }

    /// The kind of each entry.
    pub fn kinds(&self) -> &[EntryKind] {
        &self.kinds
    }

    /// The names of the game's teams, first team first.
    pub fn teams(&self) -> &[String] {
        &self.teams
    }

    /// The number of seeds, starting with the tournament's first seed.
    pub fn seeds(&self) -> u64 {
        self.seeds
    }

    /// The number of games per seed.
    pub fn games_per_seed(&self) -> usize {
        self.rounds.len()
    }

    /// The total number of games.
    pub fn games(&self) -> usize {
        usize::try_from(self.seeds)
            .map_or(usize::MAX, |seeds| seeds.saturating_mul(self.rounds.len()))
    }

    /// The game at `index`, ordered by seed, so that an early stop leaves complete seeds.
    ///
    /// # Panics
    /// If `index` is out of range.
    pub fn match_at(&self, index: usize) -> (Match, &Scenario) {
        assert!(index < self.games(), "match {index} of {}", self.games());
        let Round {
            sides,
            sea,
            scenario,
        } = &self.rounds[index % self.rounds.len()];
        // Ordered by seed: a seed counts only if all its games were played. Otherwise an entry
        // would be measured against only some of its opponents, perhaps the easy ones.
        let seed = self
            .tournament
            .seed
            .wrapping_add((index / self.rounds.len()) as u64);
        (
            Match {
                seed,
                sides: *sides,
                sea: *sea,
            },
            scenario,
        )
    }

    /// The index of a game.
    ///
    /// # Panics
    /// If the game is not part of the plan.
    pub fn place_of(&self, of: Match) -> usize {
        let round = self
            .rounds
            .iter()
            .position(|round| (round.sides, round.sea) == (of.sides, of.sea))
            .expect("they play each other");
        of.seed.wrapping_sub(self.tournament.seed) as usize * self.rounds.len() + round
    }

    /// Identifies the games of each seed, in order, by their parsed files. A different version of
    /// Squall or a different file gives different games; other entry names or file locations do
    /// not.
    pub fn pairings(&self) -> Vec<String> {
        self.rounds
            .iter()
            .map(|round| round.scenario.digest())
            .collect()
    }

    /// Identifies the plan. It depends on the contents of files, not on their location: moved files
    /// with the same references to each other give the same digest.
    pub fn digest(&self) -> String {
        let nowhere = |entry: &Entrant| Entrant {
            strategy: PathBuf::new(),
            ..entry.clone()
        };
        let entries = self.tournament.entries.iter().map(nowhere).collect();
        let sea = self.tournament.sea.is_some();
        let meant = Tournament {
            game: PathBuf::new(),
            sea: None,
            seas: vec![PathBuf::new(); self.tournament.seas.len()],
            entries,
            ..self.tournament.clone()
        };
        digest_of(&format!("{meant:?} {sea}"), &self.files.list())
    }

    /// The plan with all required files, for a process on another machine.
    pub fn pack(&self) -> Packed {
        Packed::new(&self.tournament, self.files.list(), self.digest())
    }

    /// A plan packed elsewhere.
    ///
    /// # Errors
    /// [`UnpackError`] if it is damaged or was packed by a different version of Squall.
    pub fn unpack(packed: Packed) -> Result<Plan, UnpackError> {
        packed.unpack(Plan::of_files, Plan::digest)
    }
}

/// The entries of the first and second team in every game of a seed and sea.
fn pairs(tournament: &Tournament) -> Vec<[usize; 2]> {
    let count = tournament.entries.len();
    let mut pairs = vec![];
    for one in 0..count {
        for other in one..count {
            pairs.extend(match (one == other, tournament.self_play) {
                (true, true) => vec![[one, one]],
                (true, false) => vec![],
                (false, _) => vec![[one, other], [other, one]],
            });
        }
    }
    pairs
}

/// The kind of each entry: as given, or that of the strategy with which it plays.
fn kinds(tournament: &Tournament, rounds: &[Round]) -> Vec<EntryKind> {
    let inferred = |entry: usize| {
        let side = |round: &Round| round.sides.iter().position(|side| *side == entry);
        let (round, side) = rounds
            .iter()
            .find_map(|round| Some((round, side(round)?)))?;
        let mut boats = round.scenario.vehicles.iter();
        let boat = boats.find(|boat| boat.team == TeamId(side as u8))?;
        Some(EntryKind::of(&round.scenario.strategies[boat.strategy]))
    };
    let kind = |(i, entry): (usize, &Entrant)| entry.kind.or_else(|| inferred(i));
    let entries = tournament.entries.iter().enumerate();
    entries.map(|one| kind(one).unwrap_or_default()).collect()
}
