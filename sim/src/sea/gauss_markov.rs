//! The stationary Gauss-Markov process with random access to its grid.
//!
//! Also called the Ornstein-Uhlenbeck process: mean 0, variance 1, correlation e^(−lag). Its usual
//! recursion needs the entire past; here a point is computed from the noise alone. Every 32
//! correlation lengths there is an independent point (the neglected correlation is e^−32 = 1e−14).
//! The intervals in between are halved repeatedly: midway between two known points, each δ away,
//! the process has
//!
//! ```text
//! mean (a + b) ρ / (1 + ρ²)        variance (1 − ρ²) / (1 + ρ²)        ρ = e^(−δ)
//! ```
//!
//! This is the Gauss-Markov process conditioned on both (Lévy's bridge, for this process). A world
//! reset to any tick therefore computes the same bits, whatever was read before.
//!
//! If another seed takes over after a point k, the process continues from there. With x from the
//! previous seed and y from the new one, it is y_j + (x_k − y_k) e^(−lag) at the points j after k,
//! where the lag is that from k to j. This has the law of the process given all values up to k: y's
//! own value at k is subtracted, and the rest of y is independent of it.

use primitives::SimTime;
use primitives::reseed::Seeds;
use primitives::stream::Noise;

/// Grid points per correlation length.
pub(super) const STEPS_PER_LENGTH: f64 = 32.0;
/// Number of times that an interval between independent points is halved.
const LEVELS: usize = 10;
/// Grid points between two independent ones: 32 correlation lengths.
const BLOCK: i64 = 1 << LEVELS;
/// Offset that makes the noise counts of all grid points in use positive.
const COUNT_OF_POINT_ZERO: i64 = 1 << 40;

/// Two independent processes on one grid.
pub(super) type Pair = (f64, f64);

/// A process with random access.
#[derive(Clone, Debug)]
pub(super) struct GaussMarkov {
    noise: Noise,
    /// The noises that replace the first one, by ascending point.
    later: Vec<Later>,
    /// By level: the factor on the sum of the neighbours, and the standard deviation around the
    /// result.
    halving: [(f64, f64); LEVELS],
}

/// A noise that replaces the previous one.
#[derive(Clone, Copy, Debug)]
struct Later {
    /// The last point of the previous noise.
    after: i64,
    noise: Noise,
    /// The previous process minus this one at that point.
    above: Pair,
}

/// The points on the path to the last look-up, which make the next one cheap without affecting
/// results.
#[derive(Clone, Debug)]
pub(super) struct Trail {
    /// The index of the noise to which the points belong.
    of: usize,
    points: [(i64, Pair); LEVELS + 2],
}

impl Default for Trail {
    fn default() -> Trail {
        Trail {
            of: 0,
            points: [(i64::MIN, (0.0, 0.0)); LEVELS + 2],
        }
    }
}

impl Trail {
    fn known(&mut self, place: usize, index: i64, find: impl FnOnce() -> Pair) -> Pair {
        if self.points[place].0 != index {
            self.points[place] = (index, find());
        }
        self.points[place].1
    }
}

impl GaussMarkov {
    /// The process `name` of this game. `place` returns the farthest grid position read up to a
    /// given time: a seed replaced at that time still applies up to that position.
    pub(super) fn new(seeds: &Seeds, name: &str, place: impl Fn(SimTime) -> f64) -> GaussMarkov {
        let halving = std::array::from_fn(|level| {
            let apart = (BLOCK >> (level + 1)) as f64 / STEPS_PER_LENGTH;
            // Computed once per level, so that the only transcendental function in a look-up is the
            // noise's logarithm.
            let rho = libm::exp(-apart);
            (
                rho / (1.0 + rho * rho),
                (-libm::expm1(-2.0 * apart) / (1.0 + rho * rho)).sqrt(),
            )
        });
        let mut process = GaussMarkov {
            noise: Noise::new(seeds.first(), name),
            later: vec![],
            halving,
        };
        for (time, seed) in seeds.later() {
            // A place between two points depends on both.
            let after = place(*time).floor() as i64 + 1;
            let noise = Noise::new(*seed, name);
            let before = process.at(after, &mut Trail::default());
            let own = process.of_noise(noise, after, &mut Trail::default());
            process.later.push(Later {
                after,
                noise,
                above: (before.0 - own.0, before.1 - own.1),
            });
        }
        process
    }

    pub(super) fn neighbour_correlation() -> f64 {
        libm::exp(-1.0 / STEPS_PER_LENGTH)
    }

    /// The two processes at a grid point.
    pub(super) fn at(&self, index: i64, trail: &mut Trail) -> Pair {
        let of = self
            .later
            .iter()
            .rposition(|later| later.after < index)
            .map_or(0, |place| place + 1);
        if trail.of != of {
            *trail = Trail {
                of,
                ..Trail::default()
            };
        }
        let Some(Later {
            after,
            noise,
            above,
        }) = of.checked_sub(1).map(|place| self.later[place])
        else {
            return self.of_noise(self.noise, index, trail);
        };
        let own = self.of_noise(noise, index, trail);
        let left = libm::exp(-((index - after) as f64) / STEPS_PER_LENGTH);
        (own.0 + left * above.0, own.1 + left * above.1)
    }

    /// The process of a noise at a grid point.
    fn of_noise(&self, noise: Noise, index: i64, trail: &mut Trail) -> Pair {
        let draw = |index: i64| noise.normal_pair((COUNT_OF_POINT_ZERO + index) as u64);
        let block = index.div_euclid(BLOCK);
        // The slots for the ends of blocks alternate, so that the end of one block is still known
        // as the start of the next.
        let end = |block: i64| LEVELS + (block & 1) as usize;
        // Neighbours share most of their path: a sequence of points costs about one draw each.
        let mut low = trail.known(end(block), block * BLOCK, || draw(block * BLOCK));
        if index == block * BLOCK {
            return low;
        }
        let mut high = trail.known(end(block + 1), (block + 1) * BLOCK, || {
            draw((block + 1) * BLOCK)
        });
        let mut low_index = block * BLOCK;
        for (level, (pull, sigma)) in self.halving.into_iter().enumerate() {
            let middle_index = low_index + (BLOCK >> (level + 1));
            let middle = trail.known(level, middle_index, || {
                let fresh = draw(middle_index);
                (
                    pull * (low.0 + high.0) + sigma * fresh.0,
                    pull * (low.1 + high.1) + sigma * fresh.1,
                )
            });
            match index.cmp(&middle_index) {
                std::cmp::Ordering::Equal => return middle,
                std::cmp::Ordering::Less => high = middle,
                std::cmp::Ordering::Greater => (low, low_index) = (middle, middle_index),
            }
        }
        unreachable!("halving a block ten times reaches each of its 1024 points")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::reseed::Reseed;

    /// A seed replaced at point 500, and again at 900.
    fn reseeded(seed: u64) -> Seeds {
        Seeds::new(
            seed,
            &[(500.0, seed + 1), (900.0, seed + 2)].map(|(after_s, seed)| Reseed { after_s, seed }),
        )
    }

    #[test]
    fn after_another_seed_it_is_the_process_given_what_was_before() {
        const GAMES: u64 = 20_000;
        const AFTER: i64 = 700;
        let first = GaussMarkov::new(&9.into(), "test", |now| now.as_s());
        let at = |process: &GaussMarkov, index| process.at(index, &mut Trail::default());
        // The process at these distances after the point of the change, given its value at that
        // point.
        let lags = [1_i64, 40, 60];
        let known = at(&first, AFTER + 1).0;
        let mut sums = [[0.0; 3]; 3];
        for seed in 0..GAMES {
            let seeds = Seeds::new(
                9,
                &[Reseed {
                    after_s: AFTER as f64,
                    seed: 100 + seed,
                }],
            );
            let process = GaussMarkov::new(&seeds, "test", |now| now.as_s());
            assert_eq!(at(&process, AFTER - 3), at(&first, AFTER - 3));
            assert_eq!(at(&process, AFTER + 1), at(&first, AFTER + 1));
            let x = lags.map(|lag| at(&process, AFTER + 1 + lag).0);
            for (sums, x) in sums.iter_mut().zip(x) {
                *sums = [sums[0] + x, sums[1] + x * x, sums[2]];
            }
            sums[1][2] += x[1] * x[2];
        }
        let games = GAMES as f64;
        for (lag, [sum, squares, _]) in lags.into_iter().zip(sums) {
            let rho = libm::exp(-(lag as f64) / STEPS_PER_LENGTH);
            let mean = sum / games;
            let variance = squares / games - (sum / games) * (sum / games);
            let want = 1.0 - rho * rho;
            assert!(
                (mean - known * rho).abs() < 5.0 * (want / games).sqrt(),
                "lag {lag}: mean {mean}"
            );
            assert!(
                (variance - want).abs() < 5.0 * want * (2.0 / games).sqrt(),
                "lag {lag}: variance {variance}"
            );
        }
        let rho = |steps: f64| libm::exp(-steps / STEPS_PER_LENGTH);
        let covariance = sums[1][2] / games - sums[1][0] / games * sums[2][0] / games;
        let want = rho(20.0) * (1.0 - rho(80.0));
        assert!(
            (covariance - want).abs() < 5.0 / games.sqrt(),
            "covariance {covariance}, want {want}"
        );
    }

    #[test]
    fn a_point_is_the_same_however_one_comes_to_it() {
        let process = GaussMarkov::new(&reseeded(3), "test", |now| now.as_s());
        let mut trail = Trail::default();
        let in_order: Vec<Pair> = (-2100..2100)
            .map(|index| process.at(index, &mut trail))
            .collect();
        let stride = 1777; // coprime to 4200: every point once, in a scrambled order
        for i in 0..4200 {
            let i = i * stride % 4200;
            assert_eq!(
                process.at(i as i64 - 2100, &mut trail),
                in_order[i],
                "point {i} by the trail"
            );
            assert_eq!(
                process.at(i as i64 - 2100, &mut Trail::default()),
                in_order[i],
                "point {i} alone"
            );
        }
    }

    #[test]
    fn it_has_the_moments_of_its_process_within_blocks_and_across_their_ends() {
        const POINTS: i64 = 4_000_000;
        let process = GaussMarkov::new(&5.into(), "test", |now| now.as_s());
        let mut trail = Trail::default();
        let x: Vec<Pair> = (0..POINTS)
            .map(|index| process.at(index, &mut trail))
            .collect();
        // Five standard errors; 125 000 correlation lengths count as half as many independent
        // draws.
        let within = 5.0 * (2.0 / (POINTS as f64 / STEPS_PER_LENGTH)).sqrt();
        let mean = |f: &dyn Fn(usize) -> f64, lag: usize| {
            (0..x.len() - lag).map(f).sum::<f64>() / (x.len() - lag) as f64
        };
        assert!(
            mean(&|i| x[i].0, 0).abs() < within,
            "mean {}",
            mean(&|i| x[i].0, 0)
        );
        assert!(
            mean(&|i| x[i].0 * x[i].1, 0).abs() < within,
            "correlation of the two"
        );
        for lag in [0, 1, 5, 16, 32, 64, 96] {
            let want = libm::exp(-(lag as f64) / STEPS_PER_LENGTH);
            for (which, got) in [
                mean(&|i| x[i].0 * x[i + lag].0, lag),
                mean(&|i| x[i].1 * x[i + lag].1, lag),
            ]
            .into_iter()
            .enumerate()
            {
                assert!(
                    (got - want).abs() < within,
                    "process {which}, lag {lag}: {got}, want {want} within {within}"
                );
            }
        }
        // The same at the seams between blocks only: 3900 seams.
        let seams = || (1..POINTS as usize / BLOCK as usize).map(|block| block * BLOCK as usize);
        for lag in [1, 8, 32] {
            let got =
                seams().map(|i| x[i - lag].0 * x[i + lag].0).sum::<f64>() / seams().count() as f64;
            let want = libm::exp(-2.0 * lag as f64 / STEPS_PER_LENGTH);
            assert!(
                (got - want).abs() < 5.0 * (2.0 / 3900.0_f64).sqrt(),
                "lag {lag} over a seam: {got}, want {want}"
            );
        }
    }
}
