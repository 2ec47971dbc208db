//! The breaking point: the axis value where a condition starts to hold, found by sequential search.
//!
//! The condition is assumed false at one end of the axis and true at the other, with a single
//! change between. At each tested value, seeds are played in batches until the interval of the
//! metric's mean excludes the threshold, or the games of a point are used up. The chance of any
//! wrong verdict is shared among all looks (Bonferroni), so that the resulting interval has a
//! confidence of at least 95 %.

use super::condition::Condition;
use super::journal::{Journal, SearchError};
use super::metric::Metrics;
use super::plan::{Job, Plan, Point};
use crate::estimate::{Estimate, mean_and_squares};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// Seeds of the first batch at a value; each later one doubles the total.
const FIRST_SEEDS: u64 = 8;
/// The number of values tested between the ends.
const STEPS: u32 = 9;
/// The chance of any wrong verdict.
const ALPHA: f64 = 0.05;

/// The result of the search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BreakingPoint {
    /// The key of the axis.
    pub axis: String,
    /// The name of the entry.
    pub entry: String,
    /// The condition as text.
    pub condition: String,
    /// The last value, starting from the end where the condition is false, at which it is certainly
    /// false; `None` if there is no such value.
    pub low: Option<f64>,
    /// The first value at which it is certainly true; `None` if there is no such value.
    pub high: Option<f64>,
    /// Where the metric crosses the threshold, interpolated between the means at tested values;
    /// `None` if it does not.
    pub at: Option<f64>,
    /// Every tested value, in ascending order.
    pub tried: Vec<Tried>,
}

/// A tested value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tried {
    /// The value of the axis.
    pub value: f64,
    /// The number of games played there.
    pub games: u64,
    /// The metric's mean, with its 95 % interval.
    pub mean: Estimate,
    /// Whether the condition holds there; `None` if all games left it undecided.
    pub holds: Option<bool>,
    /// The command that replays the first of its games.
    pub command: String,
    #[serde(skip)]
    share: f64,
}

/// Searches along the axis with this key, or the only one with numbers, with all others at their
/// nominal values. Games in the journal are not played again. `tell` receives each tested value.
///
/// # Errors
/// [`SearchError`] if there is no axis or there are several, if a game cannot start, or if `stop`
/// was set.
pub fn breaking_point(
    plan: &Plan,
    condition: &Condition,
    along: Option<&str>,
    journal: &mut Journal,
    threads: (NonZeroUsize, &AtomicBool),
    mut tell: impl FnMut(&Tried),
) -> Result<BreakingPoint, SearchError> {
    let axes = &plan.sweep().axes;
    let numeric: Vec<usize> = (0..axes.len())
        .filter(|k| axes[*k].at(0.0).number().is_some())
        .collect();
    let axis = match along {
        Some(key) => numeric.iter().copied().find(|k| axes[*k].key == key),
        None => (numeric.len() == 1).then(|| numeric[0]),
    };
    let keys = || {
        numeric
            .iter()
            .map(|k| axes[*k].key.as_str())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let axis = axis.ok_or_else(|| SearchError::Axes(numeric.len(), keys()))?;
    let plan = plan.of_entry(condition.entry);
    let mut tried: Vec<Tried> = vec![];
    let mut test = |share: f64, tried: &mut Vec<Tried>| {
        let one = try_value(&plan, condition, (axis, share), journal, threads)?;
        tell(&one);
        let holds = one.holds;
        tried.push(one);
        Ok::<Option<bool>, SearchError>(holds)
    };
    // The ends first: if both have the same verdict, there is nothing to find.
    let ends = [test(0.0, &mut tried)?, test(1.0, &mut tried)?];
    let (mut ok, mut broken) = match ends {
        [Some(false), Some(true)] => (0.0, 1.0),
        [Some(true), Some(false)] => (1.0, 0.0),
        _ => return Ok(found(&plan, condition, axis, tried)),
    };
    // If a value stays undecided, the search continues on both sides of it in turn.
    let mut untold: Option<[f64; 2]> = None;
    for step in 0..STEPS {
        let share = match untold {
            None => 0.5 * (ok + broken),
            Some([near_ok, _]) if step % 2 == 0 => 0.5 * (ok + near_ok),
            Some([_, near_broken]) => 0.5 * (near_broken + broken),
        };
        match test(share, &mut tried)? {
            Some(false) => ok = share,
            Some(true) => broken = share,
            None => {
                let [near_ok, near_broken] = untold.unwrap_or([share; 2]);
                let is_nearer_ok = (share - ok).abs() < (near_ok - ok).abs();
                let is_nearer_broken = (share - broken).abs() < (near_broken - broken).abs();
                untold = Some([
                    if is_nearer_ok { share } else { near_ok },
                    if is_nearer_broken { share } else { near_broken },
                ]);
            }
        }
    }
    Ok(found(&plan, condition, axis, tried))
}

/// Plays at one value until it is decided, or all games are used up.
fn try_value(
    plan: &Plan,
    condition: &Condition,
    (axis, share): (usize, f64),
    journal: &mut Journal,
    threads: (NonZeroUsize, &AtomicBool),
) -> Result<Tried, SearchError> {
    let mut values: Point = plan.sweep().axes.iter().map(super::Axis::nominal).collect();
    values[axis] = plan.sweep().axes[axis].at(share);
    let value = values[axis].number().unwrap_or(f64::NAN);
    let most = plan.seeds();
    let plan = plan.at(vec![values], (plan.sweep().seed, most));
    let looks = (most as f64 / FIRST_SEEDS as f64).log2().ceil().max(0.0) + 1.0;
    let alpha = ALPHA / looks / f64::from(STEPS + 2);
    let mut observations: Vec<f64> = vec![];
    let mut until = FIRST_SEEDS.min(most);
    loop {
        let order: Vec<Job> = (2 * observations.len()..2 * until as usize)
            .map(|index| plan.job(index))
            .collect();
        let played = journal.play(&plan, &order, threads)?;
        let number = |metrics: &Metrics| metrics.0[condition.metric];
        observations.extend(
            played
                .chunks(2)
                .map(|sides| 0.5 * (number(&sides[0]) + number(&sides[1]))),
        );
        let holds = verdict(condition, &observations, alpha);
        if holds.is_some() || until >= most {
            return Ok(Tried {
                value,
                games: 2 * observations.len() as u64,
                mean: Estimate::of(&observations),
                holds,
                command: plan.command(&plan.job(0)),
                share,
            });
        }
        until = (2 * until).min(most);
    }
}

/// Whether a condition holds for the mean of these observations; `None` if that is uncertain at
/// level `alpha`.
fn verdict(condition: &Condition, observations: &[f64], alpha: f64) -> Option<bool> {
    let count = observations.len() as f64;
    let (mean, squares) = mean_and_squares(observations);
    // Equal observations are less informative than their spread suggests: adds one that is half a
    // unit off.
    let error = ((squares + 0.25) / (count - 1.0).max(1.0) / count).sqrt();
    let quantile = StudentsT::new(0.0, 1.0, (count - 1.0).max(1.0))
        .ok()?
        .inverse_cdf(1.0 - alpha / 2.0);
    let margin = condition.margin(mean);
    (margin.abs() > quantile * error).then_some(margin < 0.0)
}

fn found(plan: &Plan, condition: &Condition, axis: usize, mut tried: Vec<Tried>) -> BreakingPoint {
    tried.sort_by(|a, b| a.share.total_cmp(&b.share));
    let rises = tried.first().is_none_or(|first| first.holds != Some(true));
    let sure = |holds: bool| {
        tried
            .iter()
            .filter(move |one| one.holds == Some(holds))
            .map(|one| one.value)
    };
    // Starting from the end where it is false: the last such value before it is ever true.
    let pick = |holds: bool, greatest: bool| {
        let values = sure(holds);
        if greatest {
            values.reduce(f64::max)
        } else {
            values.reduce(f64::min)
        }
    };
    let crossing = tried.windows(2).find_map(|pair| {
        let margins = [0, 1].map(|i| condition.margin(pair[i].mean.mean));
        let is_crossed = (margins[0] < 0.0) != (margins[1] < 0.0);
        let share = pair[0].share
            + (pair[1].share - pair[0].share) * margins[0] / (margins[0] - margins[1]);
        is_crossed.then(|| plan.sweep().axes[axis].at(share).number())?
    });
    BreakingPoint {
        axis: plan.sweep().axes[axis].key.clone(),
        entry: plan.sweep().entries[0].name.clone(),
        condition: condition.to_string(),
        low: pick(false, rises),
        high: pick(true, !rises),
        at: crossing,
        tried,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_verdict_is_as_seldom_wrong_as_it_says() {
        // Coins with 50 % heads: whether fewer than half are heads cannot be decided, and is rarely
        // decided wrongly.
        let condition = Condition {
            entry: 0,
            metric: 0,
            is_below: true,
            threshold: 0.5,
        };
        let mut wrong = 0;
        for trial in 0..2000 {
            let mut stream = primitives::stream::Stream::new(trial, "coins");
            let coins: Vec<f64> = (0..64)
                .map(|_| f64::from(u8::from(stream.unit() < 0.5)))
                .collect();
            wrong += i32::from(verdict(&condition, &coins, 0.05).is_some());
        }
        assert!(
            (40..140).contains(&wrong),
            "{wrong} of 2000, expected about 100"
        );
        let sure: Vec<f64> = vec![1.0; 20];
        assert_eq!(verdict(&condition, &sure, 0.001), Some(false));
        assert_eq!(
            verdict(
                &Condition {
                    is_below: false,
                    ..condition
                },
                &sure,
                0.001
            ),
            Some(true)
        );
    }
}
