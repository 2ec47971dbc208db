//! Rare failures: where in the space of the axes they are, how often they happen, and the games in which they do.
//!
//! Importance sampling whose density is learnt by cross-entropy (Rubinstein and Kroese 2004; de Boer and others, Annals of Operations
//! Research 2005). The nominal density of an axis is even over its range, over the quantiles of its distribution, or over its
//! values. Games are drawn from a density that is constant in pieces of each axis, learnt from those games that came nearest to a
//! failure, and a part of which is always the nominal one: weights have a bound. A round's density depends on earlier rounds
//! alone, so the mean of its weights over failures is unbiased whatever was learnt.

use crate::condition::Condition;
use crate::journal::Journal;
use crate::plan::{Job, Plan, Point};
use crate::study::StudyError;
use arena::tournament::Estimate;
use game::stream::Stream;
use serde::Serialize;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// Pieces of an axis with a range or a distribution.
const PIECES: usize = 10;
/// Rounds in which the density is learnt; as many games as in all of these are played by what came of them.
const ROUNDS: usize = 5;
/// The share of games that came nearest to a failure, from which the next density is learnt while failures are few.
const ELITE: f64 = 0.15;
/// The share of the nominal density that is left in any.
const NOMINAL: f64 = 0.2;
/// So many games are believed as much as the nominal density.
const DOUBT: f64 = 10.0;
/// From so many failures on nothing else is learnt from.
const ENOUGH: usize = 10;
/// Failures that are named.
const NAMED: usize = 10;

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Found {
    /// The entry.
    pub entry: String,
    /// What is a failure.
    pub condition: String,
    /// Games that were played.
    pub games: usize,
    /// Failures among them.
    pub failures: usize,
    /// The share of failures among games of the nominal density: unbiased.
    pub rate: Estimate,
    /// How many games of the nominal density would know the rate as well as one of these; none without failures.
    pub factor: Option<f64>,
    /// Where failures are: the density that was learnt, by axis.
    pub densities: Vec<Densities>,
    /// Failures, the nearest and worst ones first.
    pub named: Vec<Named>,
}

/// The density of an axis in comparison with the nominal one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Densities {
    /// The axis' key.
    pub axis: String,
    /// Where its pieces begin, or its values.
    pub pieces: Vec<String>,
    /// How much likelier each is than in the nominal density.
    pub times: Vec<f64>,
}

/// A game with a failure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Named {
    /// The metric.
    pub value: f64,
    /// By axis, as people read it.
    pub values: Vec<String>,
    /// The command that plays it again.
    pub command: String,
}

/// Why nothing was found.
#[derive(Debug, thiserror::Error)]
pub enum FindError {
    /// A game cannot start.
    #[error("{0}")]
    Game(String),
    /// What was played cannot be written down.
    #[error(transparent)]
    Journal(#[from] StudyError),
    /// It was stopped.
    #[error("stopped before enough games were played")]
    Stopped,
}

/// The probability of each piece of each axis.
type Density = Vec<Vec<f64>>;

/// A game that was drawn and played.
struct Sample {
    pieces: Vec<usize>,
    /// How much likelier it is in the nominal density than in the one that it was drawn from.
    weight: f64,
    margin: f64,
    point: Point,
    job: Job,
}

/// How games are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// How many games.
    pub games: usize,
    /// Whether it learns where failures are. One that does not draws evenly: brute force, to compare with.
    pub learns: bool,
}

/// Looks for games in which a condition holds, in so many games; those that the journal has are not played again. `tell` is told of each round:
/// its games, its failures.
///
/// # Errors
/// [`FindError`]: a game cannot start, or `stop` was set.
pub fn find(
    plan: &Plan,
    condition: &Condition,
    Search { games, learns }: Search,
    journal: &mut Journal,
    (jobs, stop): (NonZeroUsize, &AtomicBool),
    mut tell: impl FnMut(usize, usize),
) -> Result<Found, FindError> {
    let plan = plan.of_entry(condition.entry);
    let nominal: Density = plan.sweep().axes.iter().map(|axis| even(pieces(axis))).collect();
    let per_round = (games / (2 * ROUNDS)).max(1);
    let mut density = nominal.clone();
    let mut samples: Vec<Sample> = vec![];
    for round in 0..=ROUNDS {
        let count = if round < ROUNDS { per_round } else { games.saturating_sub(samples.len()).max(1) };
        let new = play_round(&plan, condition, (&density, &nominal), (samples.len(), count), journal, (jobs, stop))?;
        tell(count, new.iter().filter(|one| one.margin < 0.0).count());
        samples.extend(new);
        if round < ROUNDS && learns {
            density = learnt(&nominal, &samples);
        }
    }
    Ok(found(&plan, condition, &density, &nominal, &samples))
}

/// How many pieces an axis is cut into.
fn pieces(axis: &game::scenario::Axis) -> usize {
    if axis.values.is_empty() { PIECES } else { axis.values.len() }
}

fn even(pieces: usize) -> Vec<f64> {
    vec![1.0 / pieces as f64; pieces]
}

/// Draws games from a density and plays them, each with a seed of its own.
fn play_round(
    plan: &Plan,
    condition: &Condition,
    (density, nominal): (&Density, &Density),
    (before, count): (usize, usize),
    journal: &mut Journal,
    (jobs, stop): (NonZeroUsize, &AtomicBool),
) -> Result<Vec<Sample>, FindError> {
    let mut stream = Stream::new(plan.sweep().seed, &format!("sweep/find/{before}"));
    let mut drawn = vec![];
    for _ in 0..count {
        let mut pieces = vec![];
        let mut values = vec![];
        let mut weight = 1.0;
        for (k, axis) in plan.sweep().axes.iter().enumerate() {
            let piece = pick(&density[k], stream.unit());
            values.push(axis.at((piece as f64 + stream.unit()) / density[k].len() as f64));
            weight *= nominal[k][piece] / density[k][piece];
            pieces.push(piece);
        }
        drawn.push((pieces, weight, Point { values }));
    }
    let points = drawn.iter().map(|(.., point)| point.clone()).collect();
    // Two games a point: one from each side, with the seed of the point's place.
    let round = plan.at(points, (plan.sweep().seed, 1));
    let mut samples = vec![];
    for (i, (pieces, weight, point)) in drawn.into_iter().enumerate() {
        let seed = plan.sweep().seed.wrapping_add((before + i) as u64);
        let side = (before + i) % 2;
        samples.push((pieces, weight, point, Job { index: 2 * i + side, point: i, entry: 0, seed, side }));
    }
    let order: Vec<Job> = samples.iter().map(|(.., job)| *job).collect();
    let played = journal.play(&round, &order, jobs, stop)?;
    if played.len() < count {
        return Err(FindError::Stopped);
    }
    let margin = |numbers: Vec<f64>| {
        let number = numbers[condition.metric];
        if number.is_nan() { f64::INFINITY } else { condition.margin(number) }
    };
    let margins = played.into_iter().map(|result| result.map(margin)).collect::<Result<Vec<f64>, String>>();
    let margins = margins.map_err(FindError::Game)?;
    let sample = |((pieces, weight, point, job), margin)| Sample { pieces, weight, margin, point, job };
    Ok(samples.into_iter().zip(margins).map(sample).collect())
}

/// The piece in which this share of a density ends.
fn pick(density: &[f64], share: f64) -> usize {
    let mut sum = 0.0;
    let found = density.iter().position(|piece| {
        sum += piece;
        share < sum
    });
    found.unwrap_or(density.len() - 1)
}

/// The density that goes to where failures are, by those of all games so far that came nearest to one. What few games say is believed
/// little.
fn learnt(nominal: &Density, samples: &[Sample]) -> Density {
    let mut order: Vec<&Sample> = samples.iter().collect();
    order.sort_by(|a, b| a.margin.total_cmp(&b.margin));
    let count = ((samples.len() as f64 * ELITE).ceil() as usize).clamp(1, order.len());
    // Failures, once there are enough; before that those that came nearest to one. Of many that are as near as each other
    // none says more than the others, so they are left out if there are nearer ones.
    let failures = order.iter().take_while(|one| one.margin < 0.0).count();
    let nearest = order[count - 1].margin;
    let nearer = order.iter().take_while(|one| one.margin < nearest).count();
    let taken = match (failures >= ENOUGH, nearer) {
        (true, _) => failures,
        (false, 0) => order.iter().take_while(|one| one.margin <= nearest).count(),
        (false, nearer) => nearer,
    };
    let elite = &order[..taken];
    let weights: f64 = elite.iter().map(|one| one.weight).sum();
    let believed = elite.len() as f64 / (elite.len() as f64 + DOUBT);
    let axis = |k: usize| {
        let piece = |p: usize| {
            let there: f64 = elite.iter().filter(|one| one.pieces[k] == p).map(|one| one.weight).sum();
            let share = if weights > 0.0 { there / weights } else { nominal[k][p] };
            let new = believed * share + (1.0 - believed) * nominal[k][p];
            NOMINAL * nominal[k][p] + (1.0 - NOMINAL) * new
        };
        (0..nominal[k].len()).map(piece).collect()
    };
    (0..nominal.len()).map(axis).collect()
}

fn found(plan: &Plan, condition: &Condition, density: &Density, nominal: &Density, samples: &[Sample]) -> Found {
    let weight = |one: &Sample| if one.margin < 0.0 { one.weight } else { 0.0 };
    let weights: Vec<f64> = samples.iter().map(weight).collect();
    let rate = Estimate::of(&weights);
    // By the games after all learning: what a longer search would gain.
    let last = &weights[weights.len() / 2..];
    let mean = last.iter().sum::<f64>() / last.len() as f64;
    let variance = last.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>() / (last.len() as f64 - 1.0).max(1.0);
    let mut failures: Vec<&Sample> = samples.iter().filter(|one| one.margin < 0.0).collect();
    failures.sort_by(|a, b| a.margin.total_cmp(&b.margin).then(a.job.seed.cmp(&b.job.seed)));
    let value = |one: &Sample| {
        if condition.is_below { condition.threshold + one.margin } else { condition.threshold - one.margin }
    };
    let named = failures.iter().take(NAMED).map(|one| Named {
        value: value(one),
        values: one.point.values.iter().map(ToString::to_string).collect(),
        command: plan.at(vec![one.point.clone()], (one.job.seed, 1)).command(&Job { point: 0, ..one.job }),
    });
    let densities = plan.sweep().axes.iter().enumerate().map(|(k, axis)| Densities {
        axis: axis.key.clone(),
        pieces: (0..nominal[k].len()).map(|p| axis.at(p as f64 / nominal[k].len() as f64).to_string()).collect(),
        times: density[k].iter().zip(&nominal[k]).map(|(learnt, nominal)| learnt / nominal).collect(),
    });
    Found {
        entry: plan.sweep().entries[0].name.clone(),
        condition: condition.to_string(),
        games: samples.len(),
        failures: failures.len(),
        rate,
        factor: (variance > 0.0 && rate.mean > 0.0).then(|| rate.mean * (1.0 - rate.mean) / variance),
        densities: densities.collect(),
        named: named.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A space of two axes in which a failure is a corner: 2 % of it.
    fn round(density: &Density, nominal: &Density, seed: u64, count: usize) -> Vec<Sample> {
        let mut stream = Stream::new(seed, "corner");
        let mut sample = |_| {
            let pieces: Vec<usize> = density.iter().map(|density| pick(density, stream.unit())).collect();
            let weight = (0..2).map(|k| nominal[k][pieces[k]] / density[k][pieces[k]]).product();
            let place = [0, 1].map(|k| (pieces[k] as f64 + stream.unit()) / 10.0);
            let margin = (0.9 - place[0]).max(0.8 - place[1]);
            let job = Job { index: 0, point: 0, entry: 0, seed: 0, side: 0 };
            Sample { pieces, weight, margin, point: Point { values: vec![] }, job }
        };
        (0..count).map(&mut sample).collect()
    }

    #[test]
    fn the_rate_is_unbiased_and_known_better_than_by_as_many_nominal_games() {
        let nominal = vec![even(10), even(10)];
        let (mut rates, mut nominal_rates) = (vec![], vec![]);
        for trial in 0..200 {
            let (mut density, mut samples) = (nominal.clone(), vec![]);
            for k in 0..6 {
                let count = if k < 5 { 40 } else { 200 };
                samples.extend(round(&density, &nominal, 100 * trial + k, count));
                density = learnt(&nominal, &samples);
                for axis in &density {
                    assert!((axis.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{axis:?}");
                    assert!(axis.iter().all(|piece| *piece >= NOMINAL / 10.0 - 1e-12), "{axis:?}");
                }
            }
            let weights: Vec<f64> = samples.iter().map(|one| if one.margin < 0.0 { one.weight } else { 0.0 }).collect();
            rates.push(weights.iter().sum::<f64>() / weights.len() as f64);
            let brute = round(&nominal, &nominal, 100 * trial + 99, weights.len());
            nominal_rates.push(brute.iter().filter(|one| one.margin < 0.0).count() as f64 / weights.len() as f64);
        }
        let mean = Estimate::of(&rates);
        assert!((mean.mean - 0.02).abs() < 1.5 * mean.half_width().unwrap_or(0.0), "{mean:?}, not 0.02");
        let spread = |rates: &[f64]| rates.iter().map(|rate| (rate - 0.02) * (rate - 0.02)).sum::<f64>();
        assert!(spread(&nominal_rates) > 2.5 * spread(&rates), "{} {}", spread(&nominal_rates), spread(&rates));
    }
}
