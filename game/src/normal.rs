//! Normal numbers from random bits: the ziggurat of Marsaglia and Tsang (2000), with layer and place in it drawn from
//! different bits (Doornik 2005).
//!
//! The bell is covered by 256 layers of one area. In 98 of 100 draws a table and a comparison give the number; only
//! what falls beside the bell's edge takes an exponential. It is spelled out here because every tick asks for
//! dozens of them and a library may change its algorithm under the same seed.

use std::sync::LazyLock;

const LAYERS: usize = 256;
/// Where the lowest layer's tail begins, and the area of every layer: the numbers with which the 256th layer ends at 0.
const TAIL_FROM: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_974_658;

/// The right edges of the layers from below; the lowest as wide as a box of its area would be, and a 0 at the top.
static EDGES: LazyLock<[f64; LAYERS + 1]> = LazyLock::new(|| {
    let mut edges = [0.0; LAYERS + 1];
    (edges[0], edges[1]) = (AREA / bell(TAIL_FROM), TAIL_FROM);
    for i in 2..LAYERS {
        let below = edges[i - 1];
        edges[i] = (-2.0 * libm::log(AREA / below + bell(below))).sqrt();
    }
    edges
});

/// The bell over `x`, 1 at its top.
fn bell(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A number in 0 (included) to 1 (excluded), a multiple of 2^-53.
#[inline]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// A normal number of mean 0 and variance 1. `bits(n)` is the nth time that 64 random bits are asked for, from 0.
#[inline]
pub(crate) fn normal(mut bits: impl FnMut(u64) -> u64) -> f64 {
    let edges = &*EDGES;
    let mut asked = 0;
    let mut next = || {
        asked += 1;
        bits(asked - 1)
    };
    loop {
        let drawn = next();
        let layer = (drawn % LAYERS as u64) as usize;
        let x = (2.0 * unit(drawn) - 1.0) * edges[layer];
        if x.abs() < edges[layer + 1] {
            return x;
        }
        if let Some(x) = beside(x, layer, &mut next) {
            return x;
        }
    }
}

/// What becomes of an `x` that does not lie under the next layer: in the lowest layer a number from the tail; in others
/// it stays if a height drawn from the layer is under the bell.
#[cold]
fn beside(x: f64, layer: usize, next: &mut impl FnMut() -> u64) -> Option<f64> {
    if layer > 0 {
        let (low, high) = (bell(EDGES[layer]), bell(EDGES[layer + 1]));
        return (low + unit(next()) * (high - low) < bell(x)).then_some(x);
    }
    // Marsaglia (1964).
    loop {
        let further = -libm::log(1.0 - unit(next())) / TAIL_FROM;
        if -2.0 * libm::log(1.0 - unit(next())) > further * further {
            return Some((TAIL_FROM + further).copysign(x));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

    #[test]
    fn layers_have_one_area_and_end_at_the_top() {
        for i in 1..LAYERS {
            let area = EDGES[i] * (bell(EDGES[i + 1]) - bell(EDGES[i]));
            assert!((area / AREA - 1.0).abs() < 1e-9, "layer {i}: {area}");
        }
        let tail = (std::f64::consts::PI / 2.0).sqrt() * libm::erfc(TAIL_FROM / std::f64::consts::SQRT_2);
        let lowest = TAIL_FROM * bell(TAIL_FROM) + tail;
        assert!((lowest / AREA - 1.0).abs() < 1e-9, "{lowest}");
    }

    #[test]
    fn as_many_as_there_should_be_lie_below_every_number() {
        let mut stream = Stream::new(4, "test");
        let n = 2_000_000;
        let mut drawn: Vec<f64> = (0..n).map(|_| normal(|_| stream.bits())).collect();
        drawn.sort_by(f64::total_cmp);
        let share = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
        // Kolmogorov and Smirnov, at one in a thousand.
        let off = drawn.iter().enumerate().map(|(i, x)| (share(*x) - (i as f64 + 0.5) / f64::from(n)).abs());
        assert!(off.fold(0.0, f64::max) < 1.95 / f64::from(n).sqrt());
        for edge in [3.0, TAIL_FROM, 4.2] {
            let want = f64::from(n) * share(-edge);
            for side in [-1.0, 1.0] {
                let got = drawn.iter().filter(|x| side * **x > edge).count() as f64;
                assert!((got - want).abs() < 4.0 * want.sqrt(), "beyond {edge} on side {side}: {got} of {want}");
            }
        }
    }
}
