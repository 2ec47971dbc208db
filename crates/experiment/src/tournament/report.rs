//! The report of a tournament: entries, pairings, and every game.

use super::plan::Plan;
use super::play::Record;
use super::rating::{Meeting, Rating, ratings};
use crate::Packed;
use crate::estimate::Estimate;
use crate::pipeline::Game;
use rules::count::Counts;
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
    /// The sea file that replaces the game's own.
    pub sea: Option<String>,
    /// The names of the game's teams.
    pub teams: Vec<String>,
    /// If given, the only entry whose pairings were played.
    pub challenger: Option<String>,
    /// The first seed.
    pub seed: u64,
    /// The planned number of games per pairing.
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
    /// The number of games it played; a game against itself is counted from both sides.
    pub games: u64,
    /// Its strength, from wins against all opponents.
    pub rating: Rating,
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

/// A game from the point of view of one entry.
struct Appearance<'a> {
    game: &'a Game,
    side: usize,
    opponent: usize,
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
        let mut order: Vec<(usize, Row)> = match whole.is_empty() {
            true => vec![],
            false => {
                let rated = ratings(tournament.entries.len(), &meetings(&whole));
                rated
                    .into_iter()
                    .enumerate()
                    .map(|(entry, rating)| (entry, row(plan, &whole, entry, rating)))
                    .collect()
            }
        };
        order.sort_by(|(_, a), (_, b)| b.rating.elo.total_cmp(&a.rating.elo));
        let ranks: Vec<usize> = order.iter().map(|(entry, _)| *entry).collect();
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
            sea: tournament.sea.as_ref().map(|sea| sea.display().to_string()),
            teams: plan.teams().to_vec(),
            challenger: tournament.challenger.clone(),
            seed: tournament.seed,
            games_per_pairing: 2 * plan.seeds(),
            seeds_counted: whole.len() as u64,
            games_unplayed: (plan.games() - records.len()) as u64,
            games_left_out: records.iter().filter(is_left_out).count() as u64,
            rate: None,
            matrix: matrix(plan, &whole, &ranks),
            history: history(
                played
                    .iter()
                    .filter(|record| counted.contains(&record.of.seed)),
                &ranks,
            ),
            entries: order.into_iter().map(|(_, row)| row).collect(),
            failures: failures.collect(),
            matches: matches.collect(),
            plan: Some(plan.pack()),
        }
    }
}

/// The entries of a game, and its result.
fn meeting(record: &Record) -> Option<Meeting> {
    let winner = record.result.as_ref().ok()?.winner;
    Some(Meeting {
        sides: record.of.sides,
        share: winner.map_or(0.5, |side| if side == 0 { 1.0 } else { 0.0 }),
    })
}

/// The pairings and their results, grouped by seed.
fn meetings(rounds: &[&[Record]]) -> Vec<Vec<Meeting>> {
    rounds
        .iter()
        .map(|round| round.iter().filter_map(meeting).collect())
        .collect()
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

/// An entry's games with a seed. A game against itself appears twice, once from each side.
fn appearances(round: &[Record], entry: usize) -> impl Iterator<Item = Appearance<'_>> {
    round.iter().flat_map(move |record| {
        let sides = (0..2).filter(move |side| record.of.sides[*side] == entry);
        sides.filter_map(move |side| {
            let game = record.result.as_ref().ok()?;
            Some(Appearance {
                game,
                side,
                opponent: record.of.sides[1 - side],
            })
        })
    })
}

/// The results of an entry. Each round is one observation.
fn row(plan: &Plan, rounds: &[&[Record]], entry: usize, rating: Rating) -> Row {
    let entrant = &plan.tournament().entries[entry];
    let estimate = |value: &dyn Fn(&Appearance<'_>) -> u32| {
        let observation = |round: &&[Record]| {
            let values: Vec<f64> = appearances(round, entry)
                .map(|appearance| f64::from(value(&appearance)))
                .collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        Estimate::of(&rounds.iter().map(observation).collect::<Vec<f64>>())
    };
    let count = |of: fn(&Counts) -> u32| estimate(&|a: &Appearance<'_>| of(&a.game.counts[a.side]));
    let all = || rounds.iter().flat_map(|round| appearances(round, entry));
    let [wins, draws, losses] = standing(all());
    Row {
        name: entrant.name.clone(),
        strategy: entrant.strategy.display().to_string(),
        games: all().count() as u64,
        rating,
        score: estimate(&|a: &Appearance<'_>| a.game.score[a.side]),
        grabs: count(|counts| counts.grabs),
        captures: count(|counts| counts.captures),
        tags: count(|counts| counts.tags),
        tagged: count(|counts| counts.tagged),
        out_of_bounds: count(|counts| counts.out_of_bounds),
        collisions: count(|counts| counts.collisions),
        wins,
        draws,
        losses,
    }
}

/// The numbers of games won, drawn and lost.
fn standing<'a>(appearances: impl Iterator<Item = Appearance<'a>>) -> [u64; 3] {
    appearances.fold(
        [0; 3],
        |[wins, draws, losses], appearance| match appearance.game.winner {
            None => [wins, draws + 1, losses],
            Some(winner) if winner == appearance.side => [wins + 1, draws, losses],
            Some(_) => [wins, draws, losses + 1],
        },
    )
}

/// The results of each entry in `ranks` against each of its opponents.
fn matrix<'a>(plan: &Plan, rounds: &[&'a [Record]], ranks: &[usize]) -> Vec<Cell> {
    let (Some(first), Some(last)) = (rounds.first(), rounds.last()) else {
        return vec![];
    };
    let seeds = Seeds {
        first: first[0].of.seed,
        last: last[0].of.seed,
    };
    let name = |entry: usize| plan.tournament().entries[entry].name.clone();
    let pairs = ranks
        .iter()
        .flat_map(|row| ranks.iter().map(move |column| (*row, *column)));
    let cell = |(row, column): (usize, usize)| {
        let of_round =
            |round: &&'a [Record]| appearances(round, row).filter(move |a| a.opponent == column);
        let all = || rounds.iter().flat_map(of_round);
        let games = all().count() as u64;
        let decided = |round: &&'a [Record]| {
            let [wins, _, losses] = standing(of_round(round));
            (wins as f64, (wins + losses) as f64)
        };
        let won_of_decided = Estimate::of_ratio(&rounds.iter().map(decided).collect::<Vec<_>>());
        let points = |side: usize| {
            let of = |a: Appearance<'_>| {
                f64::from(a.game.score[if side == 0 { a.side } else { 1 - a.side }])
            };
            all().map(of).sum::<f64>() / games as f64
        };
        let score = [points(0), points(1)];
        let [wins, draws, losses] = standing(all());
        let score_difference = score[0] - score[1];
        let row = name(row);
        let column = name(column);
        let cell = Cell {
            row,
            column,
            games,
            wins,
            draws,
            losses,
            won_of_decided,
            score,
            score_difference,
            seeds,
        };
        (games > 0).then_some(cell)
    };
    pairs.filter_map(cell).collect()
}
