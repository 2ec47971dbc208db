//! The results of entries and pairings, from seeds with all games played.

use super::cycle::cycles;
use super::nash::{Nash, nash};
use super::plan::Plan;
use super::play::Record;
use super::rating::{Meeting, Rating, ratings};
use super::report::{Cell, Row, SeaReport, Seeds};
use crate::estimate::Estimate;
use crate::pipeline::Game;
use rules::count::Counts;
use std::path::PathBuf;

/// The results of complete seeds.
pub(super) struct Results {
    /// The entries, by descending rating.
    pub(super) ranks: Vec<usize>,
    pub(super) rows: Vec<Row>,
    pub(super) matrix: Vec<Cell>,
    pub(super) cycles: Vec<Vec<String>>,
}

/// A game from the point of view of one entry.
struct Appearance<'a> {
    game: &'a Game,
    side: usize,
    opponent: usize,
}

impl Results {
    pub(super) fn new(plan: &Plan, whole: &[&[Record]]) -> Results {
        let entries = plan.tournament().entries.len();
        let meetings = meetings(whole);
        let shares = nash(entries, &meetings);
        let row = |(entry, rating)| {
            let nash = shares.as_ref().map(|shares| shares[entry]);
            (entry, row(plan, whole, entry, (rating, nash)))
        };
        let rated = ratings(entries, &meetings).into_iter().enumerate();
        let mut order: Vec<(usize, Row)> = match whole.is_empty() {
            true => vec![],
            false => rated.map(row).collect(),
        };
        order.sort_by(|(_, a), (_, b)| b.rating.elo.total_cmp(&a.rating.elo));
        let (ranks, rows): (Vec<usize>, Vec<Row>) = order.into_iter().unzip();
        let matrix = matrix(plan, whole, &ranks);
        let place = |name: &str| rows.iter().position(|row| row.name == name);
        let mut beats = vec![vec![false; rows.len()]; rows.len()];
        for cell in &matrix {
            let low = cell.share.and_then(|share| share.low);
            if let Some((row, column)) = place(&cell.row).zip(place(&cell.column)) {
                beats[row][column] = row != column && low.is_some_and(|low| low > 0.5);
            }
        }
        let names = |cycle: Vec<usize>| cycle.iter().map(|row| rows[*row].name.clone()).collect();
        Results {
            cycles: cycles(&beats).into_iter().map(names).collect(),
            ranks,
            rows,
            matrix,
        }
    }
}

/// The results in each sea, if there are several.
pub(super) fn seas(plan: &Plan, whole: &[&[Record]]) -> Vec<SeaReport> {
    let seas = &plan.tournament().seas;
    let report = |(sea, file): (usize, &PathBuf)| {
        let own = |round: &&[Record]| -> Vec<Record> {
            let own = round.iter().filter(|record| record.of.sea == sea);
            own.cloned().collect()
        };
        let rounds: Vec<Vec<Record>> = whole.iter().map(own).collect();
        let rounds: Vec<&[Record]> = rounds.iter().map(Vec::as_slice).collect();
        let results = Results::new(plan, &rounds);
        SeaReport {
            sea: file.display().to_string(),
            entries: results.rows,
            matrix: results.matrix,
            cycles: results.cycles,
        }
    };
    let several = seas.iter().enumerate().filter(|_| seas.len() > 1);
    several.map(report).collect()
}

/// The entries of a game, and its result.
pub(super) fn meeting(record: &Record) -> Option<Meeting> {
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

/// The games of a seed with an entry; both sides of a game against itself.
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
fn row(
    plan: &Plan,
    rounds: &[&[Record]],
    entry: usize,
    (rating, nash): (Rating, Option<Nash>),
) -> Row {
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
        kind: plan.kinds()[entry],
        games: all().count() as u64,
        rating,
        nash,
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
        let result = |round: &&'a [Record]| {
            let [wins, draws, losses] = standing(of_round(round)).map(|count| count as f64);
            (wins + draws / 2.0, wins + draws + losses)
        };
        let share = Estimate::of_ratio(&rounds.iter().map(result).collect::<Vec<_>>());
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
            share,
            won_of_decided,
            score,
            score_difference,
            seeds,
        };
        (games > 0).then_some(cell)
    };
    pairs.filter_map(cell).collect()
}
