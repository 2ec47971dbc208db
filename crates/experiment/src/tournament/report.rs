//! The report of a tournament: entries, pairings, and every game.

use super::file::EntryKind;
use super::nash::Nash;
use super::plan::Plan;
use super::play::Record;
use super::rating::{Meeting, Rating, ratings};
use super::result::{self, Results, meeting};
use crate::Packed;
use crate::estimate::Estimate;
use crate::pipeline::Game;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// The maximum number of times in the history of ratings.
const STANDINGS_MAX: usize = 50;

/// The report of a tournament, as written by `--json`.
///
/// Only seeds with all games played count in [`Report::entries`] and [`Report::matrix`]; with a
/// partial seed, an entry would be measured against only some of its opponents.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The tournament's name.
    pub tournament: String,
    /// The version of Squall that played it.
    pub version: String,
    /// The commit from which it was built; the command fills it in.
    pub commit: String,
    /// The game file.
    pub game: String,
    /// The sea file that replaces the game's own, if all games have the same sea.
    pub sea: Option<String>,
    /// The names of the game's teams.
    pub teams: Vec<String>,
    /// If given, the only entry whose pairings were played.
    pub challenger: Option<String>,
    /// The first seed.
    pub seed: u64,
    /// The planned number of games per pairing, in all seas.
    pub games_per_pairing: u64,
    /// The number of seeds with all games played.
    pub seeds_counted: u64,
    /// The number of games not played because the tournament was stopped.
    pub games_unplayed: u64,
    /// The number of games played but not counted, because other games of their seed are missing.
    pub games_left_out: u64,
    /// Games per second of wall-clock time; the command fills it in.
    pub rate: Option<f64>,
    /// The entries, by descending rating.
    pub entries: Vec<Row>,
    /// Each entry against each other; rows and columns are in the same order.
    pub matrix: Vec<Cell>,
    /// Cycles of entries in which each beats the next and the last beats the first, because the 95 %
    /// interval of its mean result is above a half. There is one for each pair that is part of any
    /// cycle.
    #[serde(default)]
    pub cycles: Vec<Vec<String>>,
    /// The same in each sea, if there are several.
    #[serde(default)]
    pub seas: Vec<SeaReport>,
    /// The history of the ratings: after growing numbers of games, in the order in which they were
    /// played.
    #[serde(default)]
    pub history: Vec<Standings>,
    /// Games that could not start.
    pub failures: Vec<Failure>,
    /// Every game played.
    pub matches: Vec<MatchRow>,
    /// The plan with all its files, so that any game can be replayed from the report alone.
    #[serde(default)]
    pub plan: Option<Packed>,
}

/// The results in one sea, as in [`Report`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeaReport {
    /// The sea file.
    pub sea: String,
    /// The entries, by descending rating.
    pub entries: Vec<Row>,
    /// Each entry against each other.
    pub matrix: Vec<Cell>,
    /// Cycles of entries.
    pub cycles: Vec<Vec<String>>,
}

/// The results of an entry; means are per game.
///
/// All games with the same seed have the same sea, so they are one observation: the entry's mean
/// over its opponents and both sides. The intervals are over seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The entry's name.
    pub name: String,
    /// Its strategy file.
    pub strategy: String,
    /// Its kind.
    #[serde(default)]
    pub kind: EntryKind,
    /// The number of games it played; a game against itself is counted from both sides.
    pub games: u64,
    /// Its strength, from wins against all opponents.
    pub rating: Rating,
    /// Its part in the equilibrium between all entries; `None` if a pairing is not played, as with a
    /// challenger.
    #[serde(default)]
    pub nash: Option<Nash>,
    /// Points.
    pub score: Estimate,
    /// Flags grabbed.
    pub grabs: Estimate,
    /// Flags captured.
    pub captures: Estimate,
    /// Opponents tagged.
    pub tags: Estimate,
    /// Times tagged, by an opponent or the boundary.
    pub tagged: Estimate,
    /// Times a boat left the field.
    pub out_of_bounds: Estimate,
    /// Collisions of the entry's boats; a collision between teammates counts twice.
    pub collisions: Estimate,
    /// Games won.
    pub wins: u64,
    /// Games drawn.
    pub draws: u64,
    /// Games lost.
    pub losses: u64,
}

/// The results of one entry against another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The entry whose wins are counted.
    pub row: String,
    /// Its opponent.
    pub column: String,
    /// The number of games; a game against itself is counted from both sides.
    pub games: u64,
    /// Games that the row won.
    pub wins: u64,
    /// Games drawn.
    pub draws: u64,
    /// Games that the column won.
    pub losses: u64,
    /// The row's mean result: 1 for a win, a half for a draw. The interval is over seeds; earlier
    /// versions report none.
    #[serde(default)]
    pub share: Option<Estimate>,
    /// The row's share of the decisive games; `None` without decisive games. The interval is over
    /// seeds.
    pub won_of_decided: Option<Estimate>,
    /// The mean points of the row and of the column.
    pub score: [f64; 2],
    /// The row's points minus the column's, mean over games.
    pub score_difference: f64,
    /// The seeds played.
    pub seeds: Seeds,
}

/// The ratings after some of the games.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Standings {
    /// The number of games played so far.
    pub games: usize,
    /// The Elo ratings in the order of [`Report::entries`]; `None` before an entry's first game.
    pub elo: Vec<Option<f64>>,
}

/// A range of seeds, inclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seeds {
    /// The first seed.
    pub first: u64,
    /// The last seed.
    pub last: u64,
}

/// A game that was played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MatchRow {
    /// Its index in the order of the tournament.
    pub game: usize,
    /// Index into [`Report::seas`].
    #[serde(default)]
    pub sea: usize,
    /// The first team's entry.
    pub blue: String,
    /// The second team's entry.
    pub red: String,
    /// The seed.
    pub seed: u64,
    /// The points of the first and the second team.
    pub score: [u32; 2],
    /// The winning team, 0 or 1; `None` for a draw.
    pub winner: Option<usize>,
    /// Duration, simulated s.
    pub duration_s: f64,
    /// Digest of the final state and of all events.
    pub digest: String,
}

/// A game that could not start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// The first team's entry.
    pub blue: String,
    /// The second team's entry.
    pub red: String,
    /// The seed.
    pub seed: u64,
    /// Why it could not start.
    pub why: String,
}

impl Report {
    /// The report for the records of a plan's games, in the order in which they were played.
    pub fn new(plan: &Plan, played: &[Record]) -> Report {
        let tournament = plan.tournament();
        let mut records = played.to_vec();
        records.sort_by_key(|record| plan.place_of(record.of));
        let name = |entry: usize| tournament.entries[entry].name.clone();
        let rounds: Vec<&[Record]> = records.chunk_by(|a, b| a.of.seed == b.of.seed).collect();
        let is_whole = |round: &&[Record]| {
            round.len() == plan.games_per_seed() && round.iter().all(|record| record.result.is_ok())
        };
        let whole: Vec<&[Record]> = rounds.into_iter().filter(is_whole).collect();
        let seeds = whole.iter().map(|round| round[0].of.seed);
        let counted: BTreeSet<u64> = seeds.collect();
        let is_left_out =
            |record: &&Record| record.result.is_ok() && !counted.contains(&record.of.seed);
        let Results {
            ranks,
            rows,
            matrix,
            cycles,
        } = Results::new(plan, &whole);
        let failures = records.iter().filter_map(|record| {
            let why = record.result.as_ref().err()?.clone();
            Some(Failure {
                blue: name(record.of.sides[0]),
                red: name(record.of.sides[1]),
                seed: record.of.seed,
                why,
            })
        });
        let matches = records.iter().filter_map(|record| {
            let Game {
                score,
                winner,
                duration_s,
                digest,
                ..
            } = record.result.as_ref().ok()?.clone();
            let [blue, red] = record.of.sides.map(name);
            let game = plan.place_of(record.of);
            Some(MatchRow {
                game,
                sea: record.of.sea,
                blue,
                red,
                seed: record.of.seed,
                score,
                winner,
                duration_s,
                digest,
            })
        });
        Report {
            tournament: tournament.name.clone(),
            version: primitives::VERSION.to_owned(),
            commit: String::new(),
            game: tournament.game.display().to_string(),
            sea: (tournament.seas().len() == 1)
                .then(|| tournament.seas()[0].map(|sea| sea.display().to_string()))
                .flatten(),
            teams: plan.teams().to_vec(),
            challenger: tournament.challenger.clone(),
            seed: tournament.seed,
            games_per_pairing: 2 * plan.seeds() * tournament.seas().len() as u64,
            seeds_counted: whole.len() as u64,
            games_unplayed: (plan.games() - records.len()) as u64,
            games_left_out: records.iter().filter(is_left_out).count() as u64,
            rate: None,
            matrix,
            cycles,
            seas: result::seas(plan, &whole),
            history: history(
                played
                    .iter()
                    .filter(|record| counted.contains(&record.of.seed)),
                &ranks,
            ),
            entries: rows,
            failures: failures.collect(),
            matches: matches.collect(),
            plan: Some(plan.pack()),
        }
    }
}

/// The ratings after a growing number of games, of the entries in `ranks` that had played by then.
fn history<'a>(played: impl Iterator<Item = &'a Record>, ranks: &[usize]) -> Vec<Standings> {
    let all: Vec<Meeting> = played.filter_map(meeting).collect();
    let step = all.len().div_ceil(STANDINGS_MAX).max(1);
    let after = |games: usize| {
        let entries: BTreeSet<usize> = all[..games]
            .iter()
            .flat_map(|meeting| meeting.sides)
            .collect();
        let place = |entry: usize| entries.iter().position(|one| *one == entry);
        let renamed = |one: &Meeting| Meeting {
            sides: one.sides.map(|entry| place(entry).unwrap_or_default()),
            ..*one
        };
        // Treat all games as one seed, since intervals are not needed.
        let rated = ratings(entries.len(), &[all[..games].iter().map(renamed).collect()]);
        Standings {
            games,
            elo: ranks
                .iter()
                .map(|entry| Some(rated[place(*entry)?].elo))
                .collect(),
        }
    };
    let points = (step..all.len())
        .step_by(step)
        .chain((!all.is_empty()).then_some(all.len()));
    points.map(after).collect()
}
