//! Nash averaging: ratings that neither cycles nor copies of an entry distort.
//!
//! The log-odds of all pairings are the payoffs of a game in which two players each choose an
//! entry. Its equilibrium of maximum entropy is unique, and its support are the entries that matter
//! (Balduzzi and others, Re-evaluating Evaluation, NeurIPS 2018). A copy of an entry takes a part
//! of that entry's share and changes nothing else.

use super::rating::{ELO, Meeting, PRIOR};
use crate::estimate::{Estimate, OBSERVATIONS_MIN};
use nalgebra::{DMatrix, DVector};
use primitives::math;
use primitives::stream::Stream;
use serde::{Deserialize, Serialize};

/// The part of an entry in the equilibrium, with 95 % intervals by resampling seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Nash {
    /// Its share, 0 to 1.
    pub share: Estimate,
    /// Its rating against the equilibrium, Elo points: 0 for entries with a share, and negative for
    /// all others.
    pub lead: Estimate,
}

/// Number of resamples; the interval excludes the five lowest and the five highest results.
const RESAMPLES: u64 = 200;
const EXCLUDED: usize = 5;
/// Maximum number of entries with intervals: 30 take a second.
const RESAMPLED_MAX: usize = 30;

/// The equilibrium between entries, from their games, grouped by seed; `None` if a pairing has no
/// games.
pub fn nash(entries: usize, rounds: &[Vec<Meeting>]) -> Option<Vec<Nash>> {
    let points: Vec<DMatrix<f64>> = rounds.iter().map(|round| points(entries, round)).collect();
    let sum = |seeds: &mut dyn Iterator<Item = usize>| {
        seeds.fold(DMatrix::zeros(entries, entries), |sum, seed| {
            sum + &points[seed]
        })
    };
    let all = sum(&mut (0..points.len()));
    let is_played = |i: usize, j: usize| i == j || all[(i, j)] + all[(j, i)] > 0.0;
    if !(0..entries).all(|i| (0..entries).all(|j| is_played(i, j))) {
        return None;
    }
    let found = results(&payoffs(&all));
    let seeds = points.len() as u64;
    let is_resampled = points.len() >= OBSERVATIONS_MIN && entries <= RESAMPLED_MAX;
    let resample = |number: u64| {
        let mut stream = Stream::new(number, "nash");
        let drawn = sum(&mut (0..seeds).map(|_| stream.below(seeds) as usize));
        results(&payoffs(&drawn))
    };
    let resamples = (0..RESAMPLES).filter(|_| is_resampled).map(resample);
    let resamples: Vec<Vec<[f64; 2]>> = resamples.collect();
    let estimate = |entry: usize, of: usize| {
        let mut values: Vec<f64> = resamples.iter().map(|one| one[entry][of]).collect();
        values.sort_by(f64::total_cmp);
        let mean = found[entry][of];
        let low = values.get(EXCLUDED - 1).map(|low| low.min(mean));
        let high = values.iter().nth_back(EXCLUDED - 1);
        Estimate {
            mean,
            low,
            high: high.map(|high| high.max(mean)),
        }
    };
    let entry = |entry: usize| Nash {
        share: estimate(entry, 0),
        lead: estimate(entry, 1),
    };
    Some((0..entries).map(entry).collect())
}

/// The points of each row's entry against each column's: 1 for a win, a half for a draw.
fn points(entries: usize, round: &[Meeting]) -> DMatrix<f64> {
    let mut points = DMatrix::zeros(entries, entries);
    for Meeting {
        sides: [one, other],
        share,
    } in round
    {
        points[(*one, *other)] += share;
        points[(*other, *one)] += 1.0 - share;
    }
    points
}

/// The log-odds of each row's entry against each column's.
fn payoffs(points: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(points.nrows(), points.ncols(), |i, j| {
        libm::log((points[(i, j)] + PRIOR) / (points[(j, i)] + PRIOR))
    })
}

/// The share of each entry, and its lead in Elo points.
fn results(payoffs: &DMatrix<f64>) -> Vec<[f64; 2]> {
    let shares = equilibrium(payoffs);
    let leads = payoffs * &shares;
    let lead = |lead: f64| ELO * lead.min(0.0);
    let entries = shares.iter().zip(leads.iter());
    entries.map(|(share, own)| [*share, lead(*own)]).collect()
}

/// The equilibrium of maximum entropy of an antisymmetric game.
///
/// With a reward for entropy, weighted by a temperature, the equilibrium is unique and smooth. It is
/// followed from a high temperature, where all shares are equal, to almost zero. A solver for linear
/// programs would find some equilibrium, not this one.
fn equilibrium(payoffs: &DMatrix<f64>) -> DVector<f64> {
    /// The last temperature; shares are about this accurate.
    const COLD: f64 = 1e-8;
    let count = payoffs.nrows();
    let scale = payoffs.amax();
    let mut state = DVector::from_element(count + 1, -libm::log(count as f64));
    let mut temperature = if scale > 0.0 { scale } else { 0.0 };
    if count > 0 {
        state[count] *= -temperature;
    }
    while temperature > COLD * scale {
        state = solved(payoffs, temperature, state);
        temperature /= 2.0;
    }
    let shares = state.rows(0, count).map(math::exp);
    let sum = shares.sum();
    shares / sum
}

/// Newton's method for the equilibrium at a temperature. The state are the logarithms of the shares,
/// and a multiplier for their sum.
fn solved(payoffs: &DMatrix<f64>, temperature: f64, mut state: DVector<f64>) -> DVector<f64> {
    const STEPS_MAX: usize = 100;
    const HALVINGS_MAX: usize = 30;
    const CLOSE: f64 = 1e-13;
    let count = payoffs.nrows();
    let error = |state: &DVector<f64>| {
        let shares = state.rows(0, count).map(math::exp);
        let gains = payoffs * &shares;
        DVector::from_fn(count + 1, |i, _| match i == count {
            true => shares.sum() - 1.0,
            false => temperature * state[i] - gains[i] + state[count],
        })
    };
    for _ in 0..STEPS_MAX {
        let shares = state.rows(0, count).map(math::exp);
        let slopes = DMatrix::from_fn(count + 1, count + 1, |i, j| match (i < count, j < count) {
            (true, true) if i == j => temperature,
            (true, true) => -payoffs[(i, j)] * shares[j],
            (true, false) => 1.0,
            (false, true) => shares[j],
            (false, false) => 0.0,
        });
        let now = error(&state);
        let Some(mut step) = slopes.lu().solve(&now) else {
            break;
        };
        let mut next = &state - &step;
        for _ in 0..HALVINGS_MAX {
            if error(&next).norm() < now.norm() {
                break;
            }
            step /= 2.0;
            next = &state - &step;
        }
        let moved = (next.rows(0, count).map(math::exp) - shares).amax();
        state = next;
        if moved < CLOSE {
            break;
        }
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Accuracy of shares and payoffs.
    const CLOSE: f64 = 1e-6;

    fn game(rows: &[&[f64]]) -> DMatrix<f64> {
        DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])
    }

    fn assert_shares(payoffs: &DMatrix<f64>, want: &[f64]) {
        let shares = equilibrium(payoffs);
        let error = (&shares - DVector::from_column_slice(want)).amax();
        assert!(error < CLOSE, "{shares}, expected {want:?}");
    }

    #[test]
    fn shares_are_those_of_games_with_known_equilibria() {
        let third = 1.0 / 3.0;
        let cycle = game(&[&[0.0, 4.6, -4.6], &[-4.6, 0.0, 4.6], &[4.6, -4.6, 0.0]]);
        assert_shares(&cycle, &[third, third, third]);
        // Each share is proportional to the payoff of the game between the other two.
        let biased = game(&[&[0.0, 1.0, -2.0], &[-1.0, 0.0, 3.0], &[2.0, -3.0, 0.0]]);
        assert_shares(&biased, &[0.5, third, 1.0 / 6.0]);
        let ladder = game(&[&[0.0, 1.0, 2.0], &[-1.0, 0.0, 1.0], &[-2.0, -1.0, 0.0]]);
        assert_shares(&ladder, &[1.0, 0.0, 0.0]);
        assert_shares(&DMatrix::zeros(4, 4), &[0.25; 4]);
        assert_shares(&DMatrix::zeros(0, 0), &[]);
    }

    #[test]
    fn a_copy_of_an_entry_changes_nothing_for_the_others() {
        // The example of the paper: three agents in a cycle, the third of them twice.
        let copied = game(&[
            &[0.0, 4.6, -4.6, -4.6],
            &[-4.6, 0.0, 4.6, 4.6],
            &[4.6, -4.6, 0.0, 0.0],
            &[4.6, -4.6, 0.0, 0.0],
        ]);
        let third = 1.0 / 3.0;
        assert_shares(&copied, &[third, third, third / 2.0, third / 2.0]);
        let leads = |games: &[([usize; 2], f64)], entries: usize| {
            let games = games.iter().map(|(sides, share)| Meeting {
                sides: *sides,
                share: *share,
            });
            let found = nash(entries, &[games.collect()]).expect("all pairings are played");
            found.iter().map(|one| one.lead.mean).collect::<Vec<_>>()
        };
        let games = [([0, 1], 1.0), ([1, 2], 1.0), ([2, 0], 0.0)];
        let alone = leads(&games, 3);
        let copy = [([3, 0], 0.5), ([1, 3], 0.0), ([2, 3], 0.0)];
        let copied = leads(&[&games[..], &copy].concat(), 4);
        for (alone, copied) in alone.iter().zip(&copied) {
            assert!((alone - copied).abs() < 1e-3, "{alone} and {copied}");
        }
        // The odds are two to one: a win, and the prior of one win each.
        let behind = -ELO * std::f64::consts::LN_2;
        assert!(
            alone[0] > -1e-3 && (alone[1] - behind).abs() < 1e-3,
            "{alone:?}"
        );
    }

    #[test]
    fn no_entry_beats_the_equilibrium_of_random_games() {
        for seed in 0..200 {
            let mut stream = Stream::new(seed, "games");
            let count = 2 + stream.below(15) as usize;
            let mut payoffs = DMatrix::zeros(count, count);
            for i in 0..count {
                for j in 0..i {
                    payoffs[(i, j)] = stream.between(-3.0, 3.0).round();
                    payoffs[(j, i)] = -payoffs[(i, j)];
                }
            }
            let shares = equilibrium(&payoffs);
            let best = (&payoffs * &shares).max();
            assert!(
                best < CLOSE && (shares.sum() - 1.0).abs() < CLOSE,
                "seed {seed}: {best}"
            );
        }
    }

    #[test]
    fn intervals_need_seeds_that_differ_and_every_pairing_needs_games() {
        let game = |sides, share| Meeting { sides, share };
        let seed = |share| vec![game([0, 1], share), game([1, 2], 1.0), game([0, 2], 1.0)];
        let seeds: Vec<_> = (0..10).map(|i| seed(f64::from(i % 2))).collect();
        let found = nash(3, &seeds).expect("all pairings are played");
        let Estimate { mean, low, high } = found[0].share;
        assert!(low < Some(0.1) && high > Some(0.9), "{found:?}");
        assert!((mean - 0.5).abs() < CLOSE, "{found:?}");
        assert_eq!(found[2].share.high.map(|high| high < CLOSE), Some(true));
        assert_eq!(nash(3, &seeds[..4]).expect("played")[0].share.low, None);
        assert_eq!(nash(3, &[vec![game([0, 1], 1.0)]]), None);
    }
}
