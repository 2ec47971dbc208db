//! Randomness: one seed per game, from which each named use derives an independent stream.
//!
//! A stream is ChaCha8 keyed by the seed and the stream's name, so that a new consumer never shifts
//! the numbers of others. The few samplers are implemented here because a library may change its
//! algorithm for the same seed.

use crate::normal::{normal, unit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use xxhash_rust::xxh3::xxh3_128;

/// A named stream of random numbers.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream `name` (for example `spawn` or `mind/red_one`) of the game with this seed.
    pub fn new(seed: u64, name: &str) -> Stream {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&(name.len() as u64).to_le_bytes());
        key[16..].copy_from_slice(&xxh3_128(name.as_bytes()).to_le_bytes());
        Stream(ChaCha8Rng::from_seed(key))
    }

    /// 64 uniform random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number in 0 (included) to 1 (excluded), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        unit(self.bits())
    }

    /// A uniform number between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A uniform integer below `bound`, by rejection.
    ///
    /// # Panics
    /// If `bound` is 0.
    pub fn below(&mut self, bound: u64) -> u64 {
        assert!(bound > 0, "nothing is below 0");
        let unfair = bound.wrapping_neg() % bound;
        loop {
            let bits = self.bits();
            if bits >= unfair {
                return bits % bound;
            }
        }
    }

    /// A normally distributed number with mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        normal(|_| self.bits())
    }

    /// Shuffles `items` (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u64 + 1) as usize);
        }
    }
}

/// Stateless noise: a random number for every count.
///
/// Use it for draws at every tick: a world reset to an earlier tick draws the same numbers again.
/// The mixing function is the finaliser of SplitMix64 (Steele, Lea and Flood 2014), applied to a
/// counter that starts at a key derived from seed and name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Noise(u64);

impl Noise {
    /// The noise `name` (for example `gps/red_one`) of the game with this seed.
    pub fn new(seed: u64, name: &str) -> Noise {
        Noise(Stream::new(seed, name).bits())
    }

    /// 64 uniform random bits.
    #[inline]
    pub fn bits(&self, count: u64) -> u64 {
        let mut z = self
            .0
            .wrapping_add(count.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in 0 (included) to 1 (excluded).
    #[inline]
    pub fn unit(&self, count: u64) -> f64 {
        unit(self.bits(count))
    }

    /// Two independent normally distributed numbers with mean 0 and variance 1. Uses two uniform
    /// numbers: those at twice the count and at the number after that.
    #[inline]
    pub fn normal_pair(&self, count: u64) -> (f64, f64) {
        (self.normal(2 * count), self.normal(2 * count + 1))
    }

    /// A normally distributed number with mean 0 and variance 1, in place of the uniform number at
    /// `count`. Further bits, if needed, are derived from the first.
    pub fn normal(&self, count: u64) -> f64 {
        let first = self.bits(count);
        normal(|asked| {
            if asked == 0 {
                first
            } else {
                Noise(first).bits(asked)
            }
        })
    }

    /// An exponentially distributed number with mean 1.
    pub fn exponential(&self, count: u64) -> f64 {
        -libm::log(1.0 - self.unit(count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_and_name_give_the_same_numbers() {
        let mut a = Stream::new(7, "spawn");
        let mut b = Stream::new(7, "spawn");
        assert!((0..100).all(|_| a.bits() == b.bits()));
    }

    #[test]
    fn another_seed_or_name_gives_other_numbers() {
        let first = Stream::new(7, "spawn").bits();
        assert_ne!(first, Stream::new(8, "spawn").bits());
        assert_ne!(first, Stream::new(7, "gust").bits());
    }

    #[test]
    fn a_stream_is_pinned_so_that_old_games_can_be_played_again() {
        let mut stream = Stream::new(1, "mind/blue_one");
        let got: Vec<u64> = (0..3).map(|_| stream.bits()).collect();
        assert_eq!(got, PINNED);
    }

    /// Recorded once; a change would make old games impossible to replay.
    const PINNED: [u64; 3] = [
        16_757_449_972_422_118_870,
        3_474_384_729_306_545_788,
        10_929_957_793_316_752_716,
    ];

    #[test]
    fn units_have_the_mean_and_variance_of_a_uniform_number() {
        let mut stream = Stream::new(3, "test");
        let n = 100_000;
        let mut sum = 0.0;
        let mut squares = 0.0;
        for _ in 0..n {
            let x = stream.unit();
            sum += x;
            squares += x * x;
        }
        let mean = sum / f64::from(n);
        let variance = squares / f64::from(n) - mean * mean;
        assert!((mean - 0.5).abs() < 0.005, "mean {mean}");
        assert!((variance - 1.0 / 12.0).abs() < 0.002, "variance {variance}");
    }

    #[test]
    fn noise_is_normal_uncorrelated_and_the_same_when_looked_up_again() {
        let noise = Noise::new(1, "test");
        let n = 200_000_u64;
        let pairs: Vec<(f64, f64)> = (0..n).map(|i| noise.normal_pair(i)).collect();
        assert_eq!(noise.normal_pair(77), pairs[77]);
        assert_ne!(Noise::new(1, "tess").bits(0), noise.bits(0));
        let mean = |f: &dyn Fn(usize) -> f64| (0..pairs.len() - 1).map(f).sum::<f64>() / n as f64;
        let square = |x: f64| x * x;
        // Within five standard errors each.
        for (what, got, want, within) in [
            ("mean", mean(&|i| pairs[i].0), 0.0, 0.0112),
            ("variance", mean(&|i| square(pairs[i].0)), 1.0, 0.0158),
            ("variance", mean(&|i| square(pairs[i].1)), 1.0, 0.0158),
            (
                "fourth moment",
                mean(&|i| square(square(pairs[i].0))),
                3.0,
                0.11,
            ),
            (
                "correlation in a pair",
                mean(&|i| pairs[i].0 * pairs[i].1),
                0.0,
                0.0112,
            ),
            (
                "correlation of neighbours",
                mean(&|i| pairs[i].0 * pairs[i + 1].0),
                0.0,
                0.0112,
            ),
            (
                "exponential",
                mean(&|i| noise.exponential(i as u64)),
                1.0,
                0.0112,
            ),
        ] {
            assert!((got - want).abs() < within, "{what}: {got}");
        }
    }

    #[test]
    fn a_shuffle_keeps_every_item() {
        let mut items: Vec<u32> = (0..50).collect();
        Stream::new(5, "test").shuffle(&mut items);
        assert_ne!(items, (0..50).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..50).collect::<Vec<_>>());
    }
}
