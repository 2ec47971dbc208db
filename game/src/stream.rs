//! Randomness: one seed a game, and from it an independent stream for every named use.
//!
//! A stream is ChaCha8 keyed by the seed and the stream's name, so a new consumer never shifts the
//! numbers of another one. The few samplers are spelled out here rather than taken from a
//! library that may change its algorithm under the same seed.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use xxhash_rust::xxh3::xxh3_128;

/// A named stream of random numbers.
#[derive(Clone, Debug)]
pub struct Stream(ChaCha8Rng);

impl Stream {
    /// The stream `name` (for example `spawn` or `mind/red_one`) of the game with this seed.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Stream {
        let mut key = [0; 32];
        key[..8].copy_from_slice(&seed.to_le_bytes());
        key[8..16].copy_from_slice(&(name.len() as u64).to_le_bytes());
        key[16..].copy_from_slice(&xxh3_128(name.as_bytes()).to_le_bytes());
        Stream(ChaCha8Rng::from_seed(key))
    }

    /// A whole number, every one of the 2^64 equally likely.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A number in 0 (included) to 1 (excluded), a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number between `low` and `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A whole number below `bound`, by rejection: no number is favoured.
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

    /// A normal number of mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        normal_quantile(between_0_and_1(self.bits()))
    }

    /// Puts `items` into a random order (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last as u64 + 1) as usize);
        }
    }
}

/// Noise that can be looked up: a random number for every count, without a state.
///
/// For what is drawn every tick. A world that is put back to an earlier tick finds the same numbers again. The mixing is
/// the finaliser of SplitMix64 (Steele, Lea and Flood 2014), of a counter that starts at a key of the seed and the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Noise(u64);

impl Noise {
    /// The noise `name` (for example `gps/red_one`) of the game with this seed.
    #[must_use]
    pub fn new(seed: u64, name: &str) -> Noise {
        Noise(Stream::new(seed, name).bits())
    }

    /// Every one of 2^64 whole numbers equally likely.
    #[inline]
    #[must_use]
    pub fn bits(&self, count: u64) -> u64 {
        let mut z = self.0.wrapping_add(count.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in 0 (included) to 1 (excluded).
    #[inline]
    #[must_use]
    pub fn unit(&self, count: u64) -> f64 {
        (self.bits(count) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Two independent normal numbers, of mean 0 and variance 1. Takes the place of two units, those of twice the count
    /// and the one after it.
    #[must_use]
    pub fn normal_pair(&self, count: u64) -> (f64, f64) {
        let normal = |count: u64| normal_quantile(between_0_and_1(self.bits(count)));
        (normal(2 * count), normal(2 * count + 1))
    }

    /// A number from the exponential distribution of mean 1.
    #[must_use]
    pub fn exponential(&self, count: u64) -> f64 {
        -libm::log(1.0 - self.unit(count))
    }
}

/// A number above 0 and below 1.
fn between_0_and_1(bits: u64) -> f64 {
    ((bits >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
}

/// The normal number (mean 0, variance 1) that `share` of all are below: Wichura's PPND16 (1988, Algorithm AS 241), to
/// sixteen digits. Six in seven are found without a logarithm.
fn normal_quantile(share: f64) -> f64 {
    let off = share - 0.5;
    if off.abs() <= 0.425 {
        let r = 0.180_625 - off * off;
        return off * ratio(&MIDDLE, r);
    }
    let r = (-libm::log(if off < 0.0 { share } else { 1.0 - share })).sqrt();
    let size = if r <= 5.0 { ratio(&FLANK, r - 1.6) } else { ratio(&TAIL, r - 5.0) };
    if off < 0.0 { -size } else { size }
}

/// The ratio of two polynomials, the highest power first.
#[inline]
fn ratio([above, below]: &[[f64; 8]; 2], x: f64) -> f64 {
    let horner = |powers: &[f64; 8]| powers[1..].iter().fold(powers[0], |sum, c| sum * x + c);
    horner(above) / horner(below)
}

const MIDDLE: [[f64; 8]; 2] = [
    [
        2.509_080_928_730_122_7e3,
        3.343_057_558_358_813e4,
        6.726_577_092_700_87e4,
        4.592_195_393_154_987e4,
        1.373_169_376_550_946e4,
        1.971_590_950_306_551_3e3,
        1.331_416_678_917_843_8e2,
        3.387_132_872_796_366_5,
    ],
    [
        5.226_495_278_852_854e3,
        2.872_908_573_572_194_3e4,
        3.930_789_580_009_271e4,
        2.121_379_430_158_659_7e4,
        5.394_196_021_424_751e3,
        6.871_870_074_920_579e2,
        4.231_333_070_160_091e1,
        1.0,
    ],
];
const FLANK: [[f64; 8]; 2] = [
    [
        7.745_450_142_783_414e-4,
        2.272_384_498_926_918_4e-2,
        2.417_807_251_774_506e-1,
        1.270_458_252_452_368_4,
        3.647_848_324_763_204_5,
        5.769_497_221_460_691,
        4.630_337_846_156_546,
        1.423_437_110_749_683_5,
    ],
    [
        1.050_750_071_644_416_9e-9,
        5.475_938_084_995_345e-4,
        1.519_866_656_361_645_7e-2,
        1.481_039_764_274_800_8e-1,
        6.897_673_349_851e-1,
        1.676_384_830_183_803_8,
        2.053_191_626_637_758_7,
        1.0,
    ],
];
const TAIL: [[f64; 8]; 2] = [
    [
        2.010_334_399_292_288_1e-7,
        2.711_555_568_743_487_6e-5,
        1.242_660_947_388_078_4e-3,
        2.653_218_952_657_612_4e-2,
        2.965_605_718_285_048_7e-1,
        1.784_826_539_917_291_3,
        5.463_784_911_164_114,
        6.657_904_643_501_103,
    ],
    [
        2.044_263_103_389_939_8e-15,
        1.421_511_758_316_446e-7,
        1.846_318_317_510_054_8e-5,
        7.868_691_311_456_133e-4,
        1.487_536_129_085_061_5e-2,
        1.369_298_809_227_358e-1,
        5.998_322_065_558_88e-1,
        1.0,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_seed_and_name_give_the_same_numbers() {
        let (mut a, mut b) = (Stream::new(7, "spawn"), Stream::new(7, "spawn"));
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

    /// Read off once; changes only if old games become unplayable.
    const PINNED: [u64; 3] = [16_757_449_972_422_118_870, 3_474_384_729_306_545_788, 10_929_957_793_316_752_716];

    #[test]
    fn units_have_the_mean_and_variance_of_a_uniform_number() {
        let mut stream = Stream::new(3, "test");
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
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
        // Five standard errors each.
        for (what, got, want, within) in [
            ("mean", mean(&|i| pairs[i].0), 0.0, 0.0112),
            ("variance", mean(&|i| square(pairs[i].0)), 1.0, 0.0158),
            ("variance", mean(&|i| square(pairs[i].1)), 1.0, 0.0158),
            ("fourth moment", mean(&|i| square(square(pairs[i].0))), 3.0, 0.11),
            ("correlation in a pair", mean(&|i| pairs[i].0 * pairs[i].1), 0.0, 0.0112),
            ("correlation of neighbours", mean(&|i| pairs[i].0 * pairs[i + 1].0), 0.0, 0.0112),
            ("exponential", mean(&|i| noise.exponential(i as u64)), 1.0, 0.0112),
        ] {
            assert!((got - want).abs() < within, "{what}: {got}");
        }
    }

    #[test]
    fn a_normal_quantile_is_where_that_share_is_below() {
        let below = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
        for i in 1..20_000_u64 {
            let share = i as f64 / 20_000.0;
            let x = normal_quantile(share);
            assert!((below(x) / share - 1.0).abs() < 1e-13, "{share}: {x}");
            assert!((normal_quantile(1.0 - share) + x).abs() < 1e-11, "{share}: {x}");
        }
        for power in 1..=52 {
            let share = libm::exp2(-f64::from(power));
            assert!((below(normal_quantile(share)) / share - 1.0).abs() < 1e-12, "2^-{power}");
        }
        assert!((between_0_and_1(0) > 0.0) && between_0_and_1(u64::MAX) < 1.0);
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
