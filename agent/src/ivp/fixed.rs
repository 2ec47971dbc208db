//! Weighted utilities as integers, so that sums do not depend on their order.

use super::lanes::{larger, smaller};

/// The step to which weight times utility is rounded.
///
/// A product is then at most 6.4 million steps, which is exact in an `f32`, and the sum of
/// [`FUNCTIONS_MAX`] products is exact in an `i32`.
pub const QUANTUM: f64 = 1.0 / 64.0;

/// The maximum priority weight; larger weights are clamped to it.
pub const WEIGHT_MAX: f64 = 1000.0;

/// The maximum number of functions in a problem.
pub const FUNCTIONS_MAX: usize = 256;

// A checked program never exceeds this limit.
const _: () = assert!(scenario::strategy::FUNCTIONS_MAX <= FUNCTIONS_MAX);

/// The value of a place outside the grid: below all others, but the sum of two does not overflow.
pub(super) const NOWHERE: i32 = i32::MIN / 4;

/// From this number to twice its value, the values of an `f32` are exactly the integers, so adding
/// to it rounds to an integer.
const INTEGERS: f32 = (1_u32 << 23) as f32;

// A product is smaller, so the sum of both rounds to nearest, half to even.
const _: () = assert!(100.0 * WEIGHT_MAX / QUANTUM < INTEGERS as f64);

/// A priority weight, in quanta per point of utility.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight(f32);

impl Weight {
    /// The weight clamped to 0 to [`WEIGHT_MAX`]; 0 for a non-finite one.
    pub(super) fn new(weight: f64) -> Weight {
        debug_assert!(weight.is_finite(), "weight {weight}");
        // Weights may be expressions of a strategy, so their values are known only at run time.
        let weight = if weight.is_finite() {
            weight.clamp(0.0, WEIGHT_MAX)
        } else {
            0.0
        };
        // Use single precision, as in the bounds: with two different roundings a bound could fall
        // below its points.
        Weight((weight / QUANTUM) as f32)
    }

    /// A fraction (0 to 1) of this weight.
    pub(super) fn share(self, share: f64) -> Weight {
        Weight((f64::from(self.0) * share) as f32)
    }

    /// Whether functions of this weight have no effect.
    pub(super) fn is_zero(self) -> bool {
        self.0 == 0.0
    }

    /// A weighted utility (0 to 100) in quanta, rounded to nearest, half to even.
    #[inline(always)]
    pub(super) fn quanta(self, utility: f32) -> i32 {
        // Avoid a float-to-integer conversion, which is slow because it handles out-of-range
        // values.
        (utility * self.0 + INTEGERS).to_bits() as i32 - INTEGERS.to_bits() as i32
    }
}

/// A utility clamped to 0 to 100; 0 for a non-finite one.
#[inline(always)]
pub(super) fn utility(utility: f64) -> f32 {
    debug_assert!(utility.is_finite(), "utility {utility}");
    let within = if utility < 0.0 { 0.0 } else { utility };
    let within = if within > 100.0 { 100.0 } else { within };
    (if utility.abs() < f64::INFINITY {
        within
    } else {
        0.0
    }) as f32
}

/// A utility in single precision clamped to 0 to 100; 0 for a non-finite one. Same result as
/// [`utility`].
#[inline(always)]
pub(super) fn single(utility: f32) -> f32 {
    debug_assert!(utility.is_finite(), "utility {utility}");
    let within = larger(0.0, smaller(100.0, utility));
    if utility.abs() < f32::INFINITY {
        within
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_rounded_to_nearest_half_to_even() {
        let weight = |quanta: f32| Weight::new(f64::from(quanta) * QUANTUM);
        for (factor, utility, want) in [
            (1.0, 0.0, 0),
            (1.0, 0.5, 0),
            (1.0, 1.5, 2),
            (1.0, 2.5, 2),
            (3.0, 0.75, 2),
            (64_000.0, 100.0, 6_400_000),
        ] {
            assert_eq!(
                weight(factor).quanta(utility),
                want,
                "{factor} times {utility}"
            );
        }
        let mut stream = primitives::stream::Stream::new(1, "fixed");
        for _ in 0..100_000 {
            let factor = stream.between(0.0, 64_000.0) as f32;
            let utility = stream.between(0.0, 100.0) as f32;
            let want = (f64::from(utility * factor)).round_ties_even() as i32;
            assert_eq!(
                Weight(factor).quanta(utility),
                want,
                "{factor} times {utility}"
            );
        }
    }

    #[test]
    fn utilities_are_brought_into_range_alike_in_both_precisions() {
        for (given, want) in [
            (-5.0, 0.0),
            (-0.0, 0.0),
            (0.0, 0.0),
            (50.5, 50.5),
            (100.0, 100.0),
            (1e30, 100.0),
        ] {
            assert_eq!(
                (utility(given), single(given as f32)),
                (want, want),
                "{given}"
            );
        }
    }
}
