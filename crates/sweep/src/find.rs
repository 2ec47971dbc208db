//! Rare failures: where in the space of the axes they are, how often they happen, and the games in which they do.
//!
//! Importance sampling whose density is learnt by cross-entropy (Rubinstein and Kroese 2004; de Boer and others, Annals of Operations
//! Research 2005). The nominal density of an axis is even over its range, over the quantiles of its distribution, or over its
//! values. Games are drawn from a density that is constant in pieces of each axis, learnt from those games that came nearest to a
//! failure. A share of games is always drawn from the nominal density, so weights have a bound (a defensive mixture, Hesterberg,
//! Technometrics 1995). A round's density depends on earlier rounds
//! alone, so the mean of its weights over failures is unbiased whatever was learnt.
//!
//! Where a distance says at any time how near a game is to a failure, the games after the learning can be populations that split
//! ([`crate::split`]): those that came near are played again from there with another future. So chance within a game is searched too.

use crate::approach::Approach;
use crate::condition::Condition;
use crate::journal::{Journal, Measured};
use crate::metric::Nearness;
use crate::plan::{Job, Plan, Point};
use crate::split::{Branch, Least, Path, Splitting};
use crate::study::StudyError;
use arena::tournament::Estimate;
use primitives::reseed::Reseed;
use primitives::stream::Stream;
use scenario::AxisValue;
use serde::Serialize;
use std::f64::consts::E;
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

/// Pieces of an axis with a range or a distribution.
const PIECES: usize = 10;
/// Rounds in which the density is learnt; as many games as in all of these are played by what came of them.
const ROUNDS: usize = 5;
/// The share of games that came nearest to a failure, from which the next density is learnt while failures are few.
const ELITE: f64 = 0.15;
/// The share of games that are drawn from the nominal density, whatever was learnt: no weight is above one over this.
const NOMINAL: f64 = 0.2;
/// So many games are believed as much as the nominal density.
const DOUBT: f64 = 10.0;
/// From so many failures on nothing else is learnt from.
const ENOUGH: usize = 10;
/// Failures that are named.
const NAMED: usize = 10;
/// Populations that split, each of which says the rate for itself.
const POPULATIONS: usize = 6;
/// The share of a population that is given up at a time.
const GIVEN_UP: f64 = 0.125;

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
    /// Games among them that are others up to a time and have another future.
    pub branches: usize,
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
    /// By which distance it came near, and how; none where that is not asked for.
    approach: Option<Approach>,
    point: Point,
    job: Job,
}

impl Sample {
    fn is_failure(&self) -> bool {
        self.margin < 0.0
    }

    /// What it counts for in the rate of failures.
    fn counts(&self) -> f64 {
        if self.is_failure() { self.weight } else { 0.0 }
    }
}

impl Path for Sample {
    fn least(&self) -> Least {
        match self.approach.as_ref().and_then(Approach::least) {
            _ if self.is_failure() => Least::Failed,
            Some(steps) => Least::Steps(steps),
            None => Least::Unknown,
        }
    }
}

/// How games are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// How many games; about as many where they split.
    pub games: usize,
    /// Whether it learns where failures are. One that does not draws evenly: brute force, to compare with.
    pub learns: bool,
    /// Whether games split, if a distance says how near they are to a failure and chance has a part in them.
    pub splits: bool,
}

/// A search: what it works with, and what it has found so far.
struct Searched<'a> {
    plan: &'a Plan,
    condition: &'a Condition,
    /// Seeds that the game itself changes to.
    reseed: Vec<Reseed>,
    journal: &'a mut Journal,
    jobs: NonZeroUsize,
    stop: &'a AtomicBool,
    tell: &'a mut dyn FnMut(usize, usize),
    nominal: Density,
    /// What was learnt.
    density: Density,
    samples: Vec<Sample>,
}

/// How often failures happen.
struct Rate {
    estimate: Estimate,
    /// Its variance, times the games that it took.
    variance: f64,
    /// Games that are others up to a time.
    branches: usize,
}

/// Looks for games in which a condition holds, in so many games; those that the journal has are not played again. `tell` is told of each round:
/// its games, its failures.
///
/// # Errors
/// [`FindError`]: a game cannot start, or `stop` was set.
pub fn find(
    plan: &Plan,
    condition: &Condition,
    Search { games, learns, splits }: Search,
    journal: &mut Journal,
    (jobs, stop): (NonZeroUsize, &AtomicBool),
    mut tell: impl FnMut(usize, usize),
) -> Result<Found, FindError> {
    let plan = &plan.of_entry(condition.entry);
    let scenario = plan.scenario(0, 0, 0).map_err(|problems| FindError::Game(problems.to_string()))?;
    let splits = splits && condition.nearness().is_some() && scenario.is_random();
    let nominal: Density = plan.sweep().axes.iter().map(|axis| even(pieces(axis))).collect();
    let (density, reseed, samples) = (nominal.clone(), scenario.reseed, vec![]);
    let mut searched =
        Searched { plan, condition, reseed, journal, jobs, stop, tell: &mut tell, nominal, density, samples };
    // How many games split and how often is settled before the first is played: a search that
    // stopped when it liked what it saw would be biased.
    let per_round = (games / (2 * ROUNDS)).max(1);
    searched.learn(per_round, learns)?;
    let left = games.saturating_sub(searched.samples.len()).max(1);
    let rate = if splits { searched.rate_by_splitting(left, per_round) } else { searched.rate_by_weights(left) };
    Ok(found(&searched, &rate?))
}

/// The unbiased variance of numbers.
fn variance(numbers: &[f64]) -> f64 {
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    numbers.iter().map(|one| (one - mean) * (one - mean)).sum::<f64>() / (numbers.len() as f64 - 1.0).max(1.0)
}

/// How many pieces an axis is cut into.
fn pieces(axis: &scenario::Axis) -> usize {
    if axis.values.is_empty() { PIECES } else { axis.values.len() }
}

fn even(pieces: usize) -> Vec<f64> {
    vec![1.0 / pieces as f64; pieces]
}

/// Draws games from a density, each with a seed of its own, after as many `before`.
fn draw(plan: &Plan, (density, nominal): (&Density, &Density), (before, count): (usize, usize)) -> Vec<Sample> {
    let mut stream = Stream::new(plan.sweep().seed, &format!("sweep/find/{before}"));
    let mut sample = |i: usize| {
        let (pieces, weight) = draw_pieces(&mut stream, density, nominal);
        let value =
            |(k, axis): (usize, &scenario::Axis)| axis.at((pieces[k] as f64 + stream.unit()) / density[k].len() as f64);
        let values: Vec<AxisValue> = plan.sweep().axes.iter().enumerate().map(value).collect();
        let (seed, side) = (plan.sweep().seed.wrapping_add((before + i) as u64), (before + i) % 2);
        let job = Job { index: 0, point: 0, entry: 0, seed, side };
        Sample { pieces, weight, margin: f64::NAN, approach: None, point: Point::from(values), job }
    };
    (0..count).map(&mut sample).collect()
}

impl Searched<'_> {
    /// Plays rounds of so many games, and learns from each where failures are, unless it shall not.
    fn learn(&mut self, per_round: usize, learns: bool) -> Result<(), FindError> {
        for _ in 0..ROUNDS {
            let new = self.play(self.draw(per_round))?;
            self.samples.extend(new);
            if learns {
                self.density = learnt(&self.nominal, &self.samples);
            }
        }
        Ok(())
    }

    /// The rate by so many more games, and those before, each with its weight.
    fn rate_by_weights(&mut self, games: usize) -> Result<Rate, FindError> {
        let new = self.play(self.draw(games))?;
        self.samples.extend(new);
        let weights: Vec<f64> = self.samples.iter().map(Sample::counts).collect();
        // By the games after all learning: what a longer search would gain.
        let variance = variance(&weights[weights.len() / 2..]);
        Ok(Rate { estimate: Estimate::of(&weights), variance, branches: 0 })
    }

    /// The rate by populations that split, in about so many games; `per_round` were played in each round before.
    fn rate_by_splitting(&mut self, games: usize, per_round: usize) -> Result<Rate, FindError> {
        // A population costs as many games as it has and, for each factor e by which failures are rarer, as many again.
        let last = &self.samples[self.samples.len() - per_round..];
        let failed = last.iter().filter(|one| one.is_failure()).count();
        let rarer = std::iter::successors(Some(failed.max(1) as f64), |count| Some(E * count));
        let factors = rarer.take_while(|count| *count < per_round as f64).count();
        let each = (games / POPULATIONS / (1 + factors)).max(4);
        let mut first = self.play(self.draw(POPULATIONS * each))?.into_iter();
        let few = ((each as f64 * GIVEN_UP).ceil() as usize).max(1);
        let stream = |i: usize| Stream::new(self.plan.sweep().seed, &format!("sweep/find/split/{i}"));
        let mut populations: Vec<Splitting<Sample>> =
            (0..POPULATIONS).map(|i| Splitting::new(first.by_ref().take(each).collect(), few, stream(i))).collect();
        let mut branches = 0;
        loop {
            let next = |(i, population): (usize, &mut Splitting<Sample>)| {
                population.next().into_iter().map(move |branch| (i, branch)).collect::<Vec<(usize, Branch)>>()
            };
            let next: Vec<(usize, Branch)> = populations.iter_mut().enumerate().flat_map(next).collect();
            if next.is_empty() {
                break;
            }
            let drawn = next.iter().map(|(i, branch)| self.branched(populations[*i].population(), branch)).collect();
            let new = self.play(drawn)?;
            branches += new.len();
            for ((i, branch), sample) in next.into_iter().zip(new) {
                self.samples.extend(populations[i].put(branch.place, sample));
            }
        }
        let rates: Vec<f64> = populations.iter().map(|population| population.mean(Sample::counts)).collect();
        let variance = variance(&rates) / POPULATIONS as f64 * (POPULATIONS * each + branches) as f64;
        self.samples.extend(populations.into_iter().flat_map(Splitting::into_population));
        Ok(Rate { estimate: Estimate::of(&rates), variance, branches })
    }

    /// Draws so many games by what was learnt.
    fn draw(&self, count: usize) -> Vec<Sample> {
        draw(self.plan, (&self.density, &self.nominal), (self.samples.len(), count))
    }

    /// Plays games that were drawn, and tells of them.
    fn play(&mut self, mut drawn: Vec<Sample>) -> Result<Vec<Sample>, FindError> {
        let Searched { plan, condition, journal, jobs, stop, tell, .. } = self;
        let points = drawn.iter().map(|sample| sample.point.clone()).collect();
        // Two games a point: one from each side, with the seed of the point's place.
        let round = plan.at(points, (plan.sweep().seed, 1));
        for (i, Sample { job, .. }) in drawn.iter_mut().enumerate() {
            (job.index, job.point) = (2 * i + job.side, i);
        }
        let order: Vec<Job> = drawn.iter().map(|sample| sample.job).collect();
        let played = journal.play(&round, &order, *jobs, stop)?;
        if played.len() < drawn.len() {
            return Err(FindError::Stopped);
        }
        for (sample, result) in drawn.iter_mut().zip(played) {
            let Measured { numbers, approaches } = result.map_err(FindError::Game)?;
            let margin = condition.margin(numbers[condition.metric]);
            // A game that did not fail is the nearer the less the distance was.
            let near = |nearness: Nearness| numbers[nearness.metric()].max(f64::MIN_POSITIVE);
            sample.margin = match condition.nearness() {
                Some(nearness) if margin.is_nan() || margin >= 0.0 => near(nearness),
                _ if margin.is_nan() => f64::INFINITY,
                _ => margin,
            };
            sample.approach = condition.nearness().map(|nearness| approaches[nearness as usize].clone());
        }
        tell(drawn.len(), drawn.iter().filter(|one| one.is_failure()).count());
        Ok(drawn)
    }

    /// A copy of a game until it came nearer than the last one given up, with another future. A game that failed before it came so near
    /// stays as it is: whatever its future, it failed.
    fn branched(&self, population: &[Sample], branch: &Branch) -> Sample {
        let parent = &population[branch.of];
        let mut point = parent.point.clone();
        let since = match (branch.than, &parent.approach) {
            (Least::Steps(steps), Some(approach)) => approach.first_below(steps),
            _ => None,
        };
        if let Some(after_s) = since {
            let known = if point.reseed.is_empty() { &self.reseed } else { &point.reseed };
            let mut reseed: Vec<Reseed> = known.iter().filter(|one| one.after_s < after_s).copied().collect();
            reseed.push(Reseed { after_s, seed: branch.seed });
            point.reseed = reseed;
        }
        Sample { pieces: parent.pieces.clone(), approach: None, point, ..*parent }
    }
}

/// A piece of each axis, and how much likelier it is in the nominal density than in the mixture that it is drawn from.
fn draw_pieces(stream: &mut Stream, density: &Density, nominal: &Density) -> (Vec<usize>, f64) {
    let from = if stream.unit() < NOMINAL { nominal } else { density };
    let pieces: Vec<usize> = from.iter().map(|pieces| pick(pieces, stream.unit())).collect();
    let likelier = pieces.iter().enumerate().map(|(k, piece)| density[k][*piece] / nominal[k][*piece]).product::<f64>();
    (pieces, 1.0 / (NOMINAL + (1.0 - NOMINAL) * likelier))
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
            believed * share + (1.0 - believed) * nominal[k][p]
        };
        (0..nominal[k].len()).map(piece).collect()
    };
    (0..nominal.len()).map(axis).collect()
}

fn found(searched: &Searched, Rate { estimate: rate, variance, branches }: &Rate) -> Found {
    let Searched { plan, condition, nominal, density, samples, .. } = searched;
    let mut failures: Vec<&Sample> = samples.iter().filter(|one| one.is_failure()).collect();
    failures.sort_by(|a, b| a.margin.total_cmp(&b.margin).then(a.job.seed.cmp(&b.job.seed)));
    let value = |one: &Sample| {
        if condition.is_below { condition.threshold + one.margin } else { condition.threshold - one.margin }
    };
    // A game may be in several places.
    failures.dedup_by_key(|one| (one.job.seed, one.job.side, one.point.clone()));
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
        branches: *branches,
        rate: *rate,
        factor: (*variance > 0.0 && rate.mean > 0.0).then(|| rate.mean * (1.0 - rate.mean) / variance),
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
            let (pieces, weight) = draw_pieces(&mut stream, density, nominal);
            assert!(weight <= 1.0 / NOMINAL + 1e-12, "{weight}");
            let place = [0, 1].map(|k| (pieces[k] as f64 + stream.unit()) / 10.0);
            let margin = (0.9 - place[0]).max(0.8 - place[1]);
            let job = Job { index: 0, point: 0, entry: 0, seed: 0, side: 0 };
            Sample { pieces, weight, margin, approach: None, point: Point::from(vec![]), job }
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
