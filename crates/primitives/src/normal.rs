//! Normally distributed numbers from random bits: the ziggurat algorithm of Marsaglia and Tsang
//! (2000), with layer and position drawn from different bits (Doornik 2005).
//!
//! The bell curve is covered by 256 layers of equal area. In 98 of 100 draws, a table look-up and a
//! comparison yield the number; only the others need an exponential. It is implemented here because
//! every tick draws dozens of numbers, and a library may change its algorithm for the same seed.

use std::sync::LazyLock;

const LAYERS: usize = 256;
/// Start of the lowest layer's tail, and the area of every layer. With these values the 256th layer
/// ends at 0.
const TAIL_FROM: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_974_658;

/// The layers from the bottom, and a closing entry at the top.
static LAYER: LazyLock<[Layer; LAYERS + 1]> = LazyLock::new(|| {
    let layer = |edge| Layer {
        edge,
        bell: bell(edge),
    };
    let mut layers = [layer(0.0); LAYERS + 1];
    // The lowest layer is as wide as a rectangle of the same area.
    (layers[0], layers[1]) = (layer(AREA / bell(TAIL_FROM)), layer(TAIL_FROM));
    for i in 2..LAYERS {
        let below = layers[i - 1];
        layers[i] = layer((-2.0 * libm::log(AREA / below.edge + below.bell)).sqrt());
    }
    layers
});

#[derive(Clone, Copy)]
struct Layer {
    /// The layer's right-hand edge.
    edge: f64,
    /// Height of the bell curve at the edge, where the layer begins.
    bell: f64,
}

/// The bell curve at `x`, 1 at its peak.
fn bell(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A number in 0 (included) to 1 (excluded), a multiple of 2^-53.
#[inline]
pub(crate) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// A normally distributed number with mean 0 and variance 1. `bits(n)` is the nth request for 64
/// random bits, counted from 0.
#[inline]
pub(crate) fn normal(mut bits: impl FnMut(u64) -> u64) -> f64 {
    let first = bits(0);
    inside(first).unwrap_or_else(|layer_x| try_on(layer_x, bits))
}

/// The number if it lies under the next layer; otherwise the drawn layer and position.
#[inline]
fn inside(drawn: u64) -> Result<f64, (usize, f64)> {
    let layers = &*LAYER;
    let layer = (drawn % LAYERS as u64) as usize;
    let x = (2.0 * unit(drawn) - 1.0) * layers[layer].edge;
    if x.abs() < layers[layer + 1].edge {
        Ok(x)
    } else {
        Err((layer, x))
    }
}

/// Retries until a number is accepted.
#[cold]
#[inline(never)]
fn try_on(first: (usize, f64), mut bits: impl FnMut(u64) -> u64) -> f64 {
    let mut drawn = Err(first);
    let mut asked = 0;
    let mut next = || {
        asked += 1;
        bits(asked)
    };
    loop {
        match drawn {
            Ok(x) => return x,
            Err((layer, x)) => {
                if let Some(x) = beside(x, layer, &mut next) {
                    return x;
                }
            }
        }
        drawn = inside(next());
    }
}

/// Handles an `x` beyond the next layer. The lowest layer draws from the tail; the others accept
/// `x` if a height drawn within the layer is under the bell curve.
fn beside(x: f64, layer: usize, next: &mut impl FnMut() -> u64) -> Option<f64> {
    if layer > 0 {
        let low = LAYER[layer].bell;
        let high = LAYER[layer + 1].bell;
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
            let area = LAYER[i].edge * (LAYER[i + 1].bell - LAYER[i].bell);
            assert!((area / AREA - 1.0).abs() < 1e-9, "layer {i}: {area}");
        }
        let tail =
            (std::f64::consts::PI / 2.0).sqrt() * libm::erfc(TAIL_FROM / std::f64::consts::SQRT_2);
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
        // Kolmogorov-Smirnov test at a significance of 0.1 %.
        let off = drawn
            .iter()
            .enumerate()
            .map(|(i, x)| (share(*x) - (i as f64 + 0.5) / f64::from(n)).abs());
        assert!(off.fold(0.0, f64::max) < 1.95 / f64::from(n).sqrt());
        for edge in [3.0, TAIL_FROM, 4.2] {
            let want = f64::from(n) * share(-edge);
            for side in [-1.0, 1.0] {
                let got = drawn.iter().filter(|x| side * **x > edge).count() as f64;
                assert!(
                    (got - want).abs() < 4.0 * want.sqrt(),
                    "beyond {edge} on side {side}: {got} of {want}"
                );
            }
        }
    }
}
