//! Rare failures: how often they occur in the space of the axes, and in which games.
//!
//! Games are drawn evenly: over the range of an axis, the quantiles of its distribution, or its
//! values, each with its own seed. Cross-entropy sampling, which learns where failures are, and
//! populations that split at near failures were tried: with the same number of games their
//! intervals were no narrower.

use super::Axis;
use super::condition::Condition;
use super::journal::{Journal, SearchError};
use super::plan::{Job, Plan, Point};
use crate::estimate::Estimate;
use primitives::stream::Stream;
use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// The number of games between two progress reports.
const ROUND: usize = 100;
/// The maximum number of failures listed.
const NAMED: usize = 10;

/// The result of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The name of the entry.
    pub entry: String,
    /// The condition that defines a failure.
    pub condition: String,
    /// The number of games played.
    pub games: usize,
    /// The number of failures among them.
    pub failures: usize,
    /// The share of failures, with its exact interval.
    pub rate: Estimate,
    /// The worst failures, worst first.
    pub named: Vec<Named>,
}

/// A game with a failure, as listed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// The value of the metric.
    pub value: f64,
    /// The values of the axes as text.
    pub values: Vec<String>,
    /// The command that replays it.
    pub command: String,
}

/// A game in which the condition holds.
struct Failed {
    value: f64,
    margin: f64,
    point: Point,
    job: Job,
}

/// Plays `games` games, at least one, and finds those in which a condition holds; games in the
/// journal are not played again. `tell` receives the games and failures after each round.
///
/// # Errors
/// [`SearchError`] if a game cannot start or `stop` was set.
pub fn find(
    plan: &Plan,
    condition: &Condition,
    games: usize,
    journal: &mut Journal,
    threads: (NonZeroUsize, &AtomicBool),
    mut tell: impl FnMut(usize, usize),
) -> Result<Found, SearchError> {
    let plan = &plan.of_entry(condition.entry);
    let mut stream = Stream::new(plan.sweep().seed, "sweep/find");
    let mut failed: Vec<Failed> = vec![];
    for first in (0..games).step_by(ROUND) {
        let count = ROUND.min(games - first);
        let mut value = |axis: &Axis| axis.at(stream.unit());
        let points: Vec<Point> = (0..count)
            .map(|_| plan.sweep().axes.iter().map(&mut value).collect())
            .collect();
        // A point has two games, one from each side. One of them is played, with its own seed.
        let round = plan.at(points, (plan.sweep().seed, 1));
        let job = |i: usize| Job {
            index: 2 * i + i % 2,
            point: i,
            entry: 0,
            seed: plan.sweep().seed.wrapping_add((first + i) as u64),
            side: i % 2,
        };
        let order: Vec<Job> = (0..count).map(job).collect();
        let played = journal.play(&round, &order, threads)?;
        let before = failed.len();
        for (job, metrics) in order.into_iter().zip(played) {
            let value = metrics.0[condition.metric];
            let margin = condition.margin(value);
            if margin < 0.0 {
                failed.push(Failed {
                    value,
                    margin,
                    point: round.points()[job.point].clone(),
                    job,
                });
            }
        }
        tell(count, failed.len() - before);
    }
    let failures = failed.len();
    failed.sort_by(|a, b| {
        a.margin
            .total_cmp(&b.margin)
            .then(a.job.seed.cmp(&b.job.seed))
    });
    let named = failed.iter().take(NAMED).map(|one| Named {
        value: one.value,
        values: one.point.iter().map(ToString::to_string).collect(),
        command: plan
            .at(vec![one.point.clone()], (one.job.seed, 1))
            .command(&Job {
                point: 0,
                ..one.job
            }),
    });
    Ok(Found {
        entry: plan.sweep().entries[0].name.clone(),
        condition: condition.to_string(),
        games,
        failures,
        rate: rate_of(failures, games),
        named: named.collect(),
    })
}

/// A share with its exact 95 % interval (Clopper and Pearson, Biometrika 1934), which is
/// informative even without a failure.
fn rate_of(failures: usize, games: usize) -> Estimate {
    let k = failures as f64;
    let n = games as f64;
    let quantile = |a: f64, b: f64, p: f64| Beta::new(a, b).ok().map(|beta| beta.inverse_cdf(p));
    Estimate {
        mean: k / n,
        low: if failures == 0 {
            Some(0.0)
        } else {
            quantile(k, n - k + 1.0, 0.025)
        },
        high: if failures == games {
            Some(1.0)
        } else {
            quantile(k + 1.0, n - k, 0.975)
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_rate_is_that_of_the_tables_of_clopper_and_pearson() {
        // By bisection of the sums of binomial probabilities.
        for (failures, games, low, high) in [
            (0, 100, 0.0, 0.036_217),
            (7, 600, 0.004_703, 0.023_889),
            (10, 10, 0.691_503, 1.0),
        ] {
            let rate = rate_of(failures, games);
            let got = rate.low.zip(rate.high).expect("an interval");
            assert!(
                (got.0 - low).abs() < 1e-5 && (got.1 - high).abs() < 1e-5,
                "{failures} of {games}: {rate:?}"
            );
        }
    }
}
