//! The report of a sweep.

use super::effects::{Effect, Interaction, Observations, effects, interactions};
use super::metric::{METRICS, Metric, Metrics};
use super::plan::Plan;
use super::table::Row;
use super::{Axis, Design};
use crate::estimate::Estimate;
use serde::Serialize;

/// The number of worst games listed per entry.
const WORST: usize = 5;

/// The report of a sweep: `report.json`, and the content of the page and the terminal output. A
/// seed counts only if all its games at a point were played.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The sweep's name.
    pub sweep: String,
    /// The purpose of the sweep, from its file.
    pub about: String,
    /// The version of Squall that played it.
    pub version: String,
    /// The game file.
    pub game: String,
    /// The strategy file of the opponents.
    pub opponent: String,
    /// How the points were chosen.
    pub design: Design,
    /// The first seed.
    pub seed: u64,
    /// Games of each entry at each point.
    pub games_per_point: u64,
    /// The number of games planned.
    pub games: usize,
    /// The number of games that were played or could not start.
    pub games_done: usize,
    /// The keys of the axes.
    pub axes: Vec<String>,
    /// The meanings of the axes, with units, from the scenario file reference.
    pub axis_meanings: Vec<Option<String>>,
    /// The names of the entries.
    pub entries: Vec<String>,
    /// The metrics; lists by metric are in this order.
    pub metrics: Vec<Metric>,
    /// The results by point.
    pub points: Vec<PointReport>,
    /// The effect of each axis on each entry.
    pub effects: Vec<Effect>,
    /// The interactions of pairs of axes, significant ones first.
    pub interactions: Vec<Interaction>,
    /// The games that each entry did not win, worst score difference first.
    pub worst: Vec<Worst>,
    /// Games that could not start.
    pub failures: Vec<Failure>,
}

/// The results of the entries at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PointReport {
    /// The values of the axes as strings.
    pub values: Vec<String>,
    /// The number of seeds with all games played.
    pub seeds: usize,
    /// The results by entry.
    pub entries: Vec<EntryAtPoint>,
    /// Each other entry minus the first, for the same seeds.
    pub differences: Vec<Difference>,
    /// The command that replays one of its games.
    pub command: String,
}

/// The results of an entry at a point: means per game, with intervals over seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryAtPoint {
    /// Its name.
    pub entry: String,
    /// By metric; `None` if no game has a value.
    pub metrics: Vec<Option<Estimate>>,
}

/// The difference of each metric between two entries.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// The entry that is compared.
    pub entry: String,
    /// The entry that it is compared with, whose metrics are subtracted.
    pub from: String,
    /// The differences by metric.
    pub metrics: Vec<Option<Estimate>>,
}

/// One of an entry's worst games.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Worst {
    /// The name of the entry.
    pub entry: String,
    /// The game's index in the tables.
    pub game: usize,
    /// The values of the axes as strings.
    pub values: Vec<String>,
    /// The points of the entry and of its opponent.
    pub score: [f64; 2],
    /// The number of hull contacts.
    pub contacts: f64,
    /// How often one of the entry's boats left the field.
    pub out_of_bounds: f64,
    /// Digest of the final state and of all events.
    pub digest: String,
    /// The command that replays it.
    pub command: String,
}

/// A game that could not start.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// The game's index in the tables.
    pub game: usize,
    /// The error.
    pub why: String,
    /// The command that retries it.
    pub command: String,
}

impl Report {
    /// Builds the report from `rows`: the results of a plan's first games, in the plan's order.
    pub fn new(plan: &Plan, rows: &[Row]) -> Report {
        let sweep = plan.sweep();
        let observed = observations(plan, rows);
        let names: Vec<String> = sweep
            .entries
            .iter()
            .map(|entry| entry.name.clone())
            .collect();
        let failures = rows.iter().filter_map(|row| {
            let why = row.result.as_ref().err()?.clone();
            Some(Failure {
                game: row.job.index,
                why,
                command: plan.command(&row.job),
            })
        });
        Report {
            sweep: sweep.name.clone(),
            about: sweep.about.clone(),
            version: primitives::VERSION.to_owned(),
            game: sweep.game.display().to_string(),
            opponent: sweep.opponent.display().to_string(),
            design: sweep.design,
            seed: sweep.seed,
            games_per_point: 2 * plan.seeds(),
            games: plan.games(),
            games_done: rows.len(),
            axes: sweep.axes.iter().map(|axis| axis.key.clone()).collect(),
            axis_meanings: sweep.axes.iter().map(Axis::meaning).collect(),
            metrics: METRICS.to_vec(),
            points: (0..plan.points().len())
                .map(|point| point_report(plan, &observed, &names, point))
                .collect(),
            effects: effects(plan, &observed),
            interactions: interactions(plan, &observed),
            worst: worst(plan, rows),
            failures: failures.collect(),
            entries: names,
        }
    }
}

/// The mean of both sides, by point, entry and seed.
fn observations(plan: &Plan, rows: &[Row]) -> Observations {
    let entries = plan.sweep().entries.len();
    // A stopped sweep may have played only a few of a million seeds.
    let seeds = (plan.seeds() as usize).min(rows.len().div_ceil(2 * entries));
    let of_seed = |point: usize, seed: usize| -> Option<Vec<Metrics>> {
        let first = point * plan.games_per_point() + seed * 2 * entries;
        let games = rows.get(first..first + 2 * entries)?;
        let games = games
            .iter()
            .map(|row| row.result.as_ref().ok().copied())
            .collect::<Option<Vec<Metrics>>>()?;
        Some(games.chunks(2).map(mean).collect())
    };
    let of_point = |point: usize| {
        let seeds: Vec<Option<Vec<Metrics>>> =
            (0..seeds).map(|seed| of_seed(point, seed)).collect();
        let of_entry = |entry: usize| {
            seeds
                .iter()
                .map(|seed| Some(seed.as_ref()?[entry]))
                .collect()
        };
        (0..entries).map(of_entry).collect()
    };
    Observations {
        by_point: (0..plan.points().len()).map(of_point).collect(),
    }
}

/// The mean over games.
fn mean(games: &[Metrics]) -> Metrics {
    Metrics(std::array::from_fn(|i| {
        games.iter().map(|game| game.0[i]).sum::<f64>() / games.len() as f64
    }))
}

fn point_report(
    plan: &Plan,
    observed: &Observations,
    names: &[String],
    point: usize,
) -> PointReport {
    let all = |of: &dyn Fn(usize) -> Option<Estimate>| (0..METRICS.len()).map(of).collect();
    let entries = names.iter().enumerate().map(|(entry, name)| EntryAtPoint {
        entry: name.clone(),
        metrics: all(&|metric| observed.estimate(&[point], entry, metric)),
    });
    let differences = names
        .iter()
        .enumerate()
        .skip(1)
        .map(|(entry, name)| Difference {
            entry: name.clone(),
            from: names[0].clone(),
            metrics: all(&|metric| observed.difference(point, [entry, 0], metric)),
        });
    PointReport {
        values: plan.points()[point]
            .iter()
            .map(ToString::to_string)
            .collect(),
        seeds: observed.by_point[point][0].iter().flatten().count(),
        entries: entries.collect(),
        differences: differences.collect(),
        command: plan.command(&plan.job(point * plan.games_per_point())),
    }
}

/// The games that each entry lost or drew, largest margin first.
fn worst(plan: &Plan, rows: &[Row]) -> Vec<Worst> {
    let mut worst = vec![];
    for (entry, entrant) in plan.sweep().entries.iter().enumerate() {
        let of_entry = rows.iter().filter(|row| row.job.entry == entry);
        let measured = of_entry.filter_map(|row| Some((row, row.result.as_ref().ok()?)));
        let mut games: Vec<(f64, &Row, &Metrics)> = measured
            .map(|(row, metrics)| (metrics.of("score_difference"), row, metrics))
            .collect();
        games.retain(|(difference, ..)| *difference <= 0.0);
        games.sort_by(|(one, a, _), (other, b, _)| {
            one.total_cmp(other).then(a.job.index.cmp(&b.job.index))
        });
        worst.extend(
            games
                .into_iter()
                .take(WORST)
                .map(|(_, Row { job, digest, .. }, metrics)| Worst {
                    entry: entrant.name.clone(),
                    game: job.index,
                    values: plan.points()[job.point]
                        .iter()
                        .map(ToString::to_string)
                        .collect(),
                    score: metrics.score(),
                    contacts: metrics.of("contacts"),
                    out_of_bounds: metrics.of("out_of_bounds"),
                    digest: digest.clone(),
                    command: plan.command(job),
                }),
        );
    }
    worst
}
