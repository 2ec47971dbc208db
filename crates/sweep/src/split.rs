//! Splitting: games that came near to a failure are played again from there, with another future, until enough of them fail.
//!
//! Adaptive multilevel splitting (Cérou and Guyader, Stochastic Analysis and Applications 2007). Of a population of games those that
//! came least near are given up, and as many others take their places: copies of those that came nearer, up to the time at which they
//! did, drawn anew from then on. The product of the shares that were kept, times the mean over the population at the end, is an unbiased
//! mean of the games as they were drawn at first, for anything that follows from a game (Bréhier, Gazeau, Goudenège, Lelièvre and
//! Rousset, Annals of Applied Probability 2016): for weights over failures too. All that came no nearer than the last one given up are
//! given up with it; that is what keeps the mean unbiased where several are as near as each other.

use primitives::stream::Stream;

/// A game of a population.
pub(crate) trait Path {
    /// How near it came: the less the nearer; none where it is not known. A failure is the nearest of all.
    fn least(&self) -> Least;
}

/// How near a game came to a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Least {
    /// It failed.
    Failed,
    /// So many steps of distance were the least.
    Steps(i64),
    /// It is not known.
    Unknown,
}

/// A game that takes the place of one that was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Branch {
    /// The place of the one that is given up.
    pub(crate) place: usize,
    /// The place of the one it is a copy of, until that came nearer than `than`.
    pub(crate) of: usize,
    /// How near the last one came that was given up.
    pub(crate) than: Least,
    /// Chooses its future.
    pub(crate) seed: u64,
}

/// A population that splits.
pub(crate) struct Splitting<P> {
    population: Vec<P>,
    /// How many are given up at a time, or more where several are as near as each other.
    few: usize,
    stream: Stream,
    /// The product of the shares that were kept.
    kept: f64,
}

impl<P: Path> Splitting<P> {
    /// A population as it was drawn.
    pub(crate) fn new(population: Vec<P>, few: usize, stream: Stream) -> Splitting<P> {
        Splitting { population, few, stream, kept: 1.0 }
    }

    /// The games.
    pub(crate) fn population(&self) -> &[P] {
        &self.population
    }

    /// Gives the least near ones up and says what takes their places; nothing once fewer than `few` have not failed, or none came nearer
    /// than others.
    pub(crate) fn next(&mut self) -> Vec<Branch> {
        let mut leasts: Vec<Least> = self.population.iter().map(Path::least).collect();
        leasts.sort_unstable_by(|a, b| b.cmp(a));
        let than = leasts.get(self.few - 1).copied().unwrap_or(Least::Failed);
        if than == Least::Failed || self.kept == 0.0 {
            return vec![];
        }
        let (given_up, left): (Vec<usize>, Vec<usize>) =
            (0..self.population.len()).partition(|place| self.population[*place].least() >= than);
        self.kept *= left.len() as f64 / self.population.len() as f64;
        if left.is_empty() {
            return vec![];
        }
        let branch = |place: usize| Branch {
            place,
            of: left[self.stream.below(left.len() as u64) as usize],
            than,
            seed: self.stream.bits() >> 1,
        };
        given_up.into_iter().map(branch).collect()
    }

    /// Puts a game in the place of one that was given up, which it returns.
    pub(crate) fn put(&mut self, place: usize, path: P) -> Option<P> {
        self.population.get_mut(place).map(|there| std::mem::replace(there, path))
    }

    /// The games at the end.
    pub(crate) fn into_population(self) -> Vec<P> {
        self.population
    }

    /// The mean of a number over all games as they were drawn at first.
    pub(crate) fn mean(&self, number: impl Fn(&P) -> f64) -> f64 {
        self.kept * self.population.iter().map(number).sum::<f64>() / self.population.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A walk of steps of one up or down, which fails where it comes to the height.
    #[derive(Clone, Debug)]
    struct Walk {
        heights: Vec<i64>,
    }

    const STEPS: usize = 100;
    const HEIGHT: i64 = 38;

    impl Walk {
        fn go_on(mut heights: Vec<i64>, seed: u64) -> Walk {
            let mut stream = Stream::new(seed, "walk");
            while heights.len() <= STEPS {
                let step = if stream.unit() < 0.5 { -1 } else { 1 };
                heights.push(heights.last().copied().unwrap_or(0) + step);
            }
            Walk { heights }
        }

        /// The same until it came nearer than the last one given up, and anew from then on.
        fn branched(&self, branch: &Branch) -> Walk {
            let Least::Steps(steps) = branch.than else { panic!("failures are not given up") };
            let nearer = self.heights.iter().position(|height| HEIGHT - height < steps);
            Walk::go_on(self.heights[..=nearer.expect("it came nearer")].to_vec(), branch.seed)
        }

        fn highest(&self) -> i64 {
            self.heights.iter().copied().max().unwrap_or(0)
        }
    }

    impl Path for Walk {
        fn least(&self) -> Least {
            if self.highest() >= HEIGHT { Least::Failed } else { Least::Steps(HEIGHT - self.highest()) }
        }
    }

    /// P(highest ≥ h) = P(end ≥ h) + P(end > h), by reflection.
    fn exact() -> f64 {
        let mut ends = vec![0.0; 2 * STEPS + 1];
        ends[STEPS] = 1.0;
        for _ in 0..STEPS {
            let from = |i: usize| ends.get(i).copied().unwrap_or(0.0);
            ends = (0..ends.len()).map(|i| 0.5 * (from(i.wrapping_sub(1)) + from(i + 1))).collect();
        }
        let above = |height: i64| ends[(STEPS as i64 + height) as usize..].iter().sum::<f64>();
        above(HEIGHT) + above(HEIGHT + 1)
    }

    #[test]
    fn the_rate_of_a_rare_failure_is_unbiased_and_known_better_than_by_as_many_walks() {
        const TRIALS: u64 = 600;
        const POPULATION: usize = 20;
        let exact = exact();
        assert!((1e-4..2e-4).contains(&exact), "{exact}");
        let (mut rates, mut walks) = (vec![], 0);
        for trial in 0..TRIALS {
            let mut stream = Stream::new(trial, "trial");
            let population = (0..POPULATION).map(|_| Walk::go_on(vec![0], stream.bits())).collect();
            let mut splitting = Splitting::new(population, 2, stream);
            walks += POPULATION;
            loop {
                let branches = splitting.next();
                if branches.is_empty() {
                    break;
                }
                walks += branches.len();
                let new = branches.iter().map(|branch| splitting.population()[branch.of].branched(branch));
                for (branch, walk) in branches.iter().zip(new.collect::<Vec<Walk>>()) {
                    splitting.put(branch.place, walk);
                }
            }
            rates.push(splitting.mean(|walk| if walk.least() == Least::Failed { 1.0 } else { 0.0 }));
        }
        let count = TRIALS as f64;
        let mean = rates.iter().sum::<f64>() / count;
        let variance = rates.iter().map(|rate| (rate - mean) * (rate - mean)).sum::<f64>() / (count - 1.0);
        assert!((mean - exact).abs() < 4.0 * (variance / count).sqrt(), "{mean}, not {exact}");
        // As many walks by brute force would know a rate with this variance.
        let brute = exact * (1.0 - exact) / (walks as f64 / count);
        assert!(brute > 5.0 * variance, "{} times", brute / variance);
    }

    #[test]
    fn a_population_that_comes_no_nearer_has_no_failures() {
        let mut splitting = Splitting::new(vec![Walk { heights: vec![0, 1] }; 5], 1, Stream::new(1, "t"));
        assert_eq!(splitting.next(), []);
        assert_eq!(splitting.mean(|_| 1.0), 0.0);
    }
}
