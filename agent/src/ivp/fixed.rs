//! Weighted utilities as integers, so that a sum does not depend on its order.

use super::lanes::{larger, smaller};

/// The step to which weight times utility is rounded.
///
/// With it a product counts at most 6.4 million steps, which an `f32` and the sum of [`FUNCTIONS_MAX`] of them in an
/// `i32` hold exactly.
pub const QUANTUM: f64 = 1.0 / 64.0;

/// The largest priority weight; larger ones count as this.
pub const WEIGHT_MAX: f64 = 1000.0;

/// The most functions a problem takes.
pub const FUNCTIONS_MAX: usize = 256;

// What a checked program may ask for is heard.
const _: () = assert!(scenario::strategy::FUNCTIONS_MAX <= FUNCTIONS_MAX);

/// The value of a place that does not exist: below all others, and far enough from overflow for two of them.
pub(super) const NOWHERE: i32 = i32::MIN / 4;

/// From here to twice as much the numbers that an `f32` holds are the integers: what is added to it is rounded to one.
const INTEGERS: f32 = (1_u32 << 23) as f32;

// A product is less, so the sum of both is rounded to nearest, half to even.
const _: () = assert!(100.0 * WEIGHT_MAX / QUANTUM < INTEGERS as f64);

/// A priority weight, in quanta for each point of utility.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight(f32);

impl Weight {
    /// The weight brought into 0 to [`WEIGHT_MAX`]; a non-finite one counts 0.
    pub(super) fn new(weight: f64) -> Weight {
        debug_assert!(weight.is_finite(), "weight {weight}");
        // Weights may be expressions of a strategy, so what they come to is known only now.
        let weight = if weight.is_finite() { weight.clamp(0.0, WEIGHT_MAX) } else { 0.0 };
        // In single precision here and in the bounds: rounded twice in different ways, a bound
        // could fall short of its points.
        Weight((weight / QUANTUM) as f32)
    }

    /// A share (0 to 1) of this weight.
    pub(super) fn share(self, share: f64) -> Weight {
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
        Weight((f64::from(self.0) * share) as f32)
    }

    /// Whether nothing can come of it.
    pub(super) fn is_zero(self) -> bool {
        self.0 == 0.0
    }

    /// A weighted utility (0 to 100) in quanta, rounded to nearest, half to even.
    #[inline(always)]
    pub(super) fn quanta(self, utility: f32) -> i32 {
        // Without a conversion, which is slow where numbers that are too large for an integer are provided for.
        (utility * self.0 + INTEGERS).to_bits() as i32 - INTEGERS.to_bits() as i32
    }
}

/// A utility brought into 0 to 100; a non-finite one counts 0.
#[inline(always)]
pub(super) fn utility(utility: f64) -> f32 {
    debug_assert!(utility.is_finite(), "utility {utility}");
    let within = if utility < 0.0 { 0.0 } else { utility };
    let within = if within > 100.0 { 100.0 } else { within };
    (if utility.abs() < f64::INFINITY { within } else { 0.0 }) as f32
}

/// A utility in single precision brought into 0 to 100; a non-finite one counts 0. The same as [`utility`].
#[inline(always)]
pub(super) fn single(utility: f32) -> f32 {
    debug_assert!(utility.is_finite(), "utility {utility}");
    let within = larger(0.0, smaller(100.0, utility));
    if utility.abs() < f32::INFINITY { within } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_rounded_to_nearest_half_to_even() {
        let weight = |quanta: f32| Weight::new(f64::from(quanta) * QUANTUM);
        for (factor, utility, want) in
            [(1.0, 0.0, 0), (1.0, 0.5, 0), (1.0, 1.5, 2), (1.0, 2.5, 2), (3.0, 0.75, 2), (64_000.0, 100.0, 6_400_000)]
        {
            assert_eq!(weight(factor).quanta(utility), want, "{factor} times {utility}");
        }
        let mut stream = primitives::stream::Stream::new(1, "fixed");
        for _ in 0..100_000 {
            let (factor, utility) = (stream.between(0.0, 64_000.0) as f32, stream.between(0.0, 100.0) as f32);
            let want = (f64::from(utility * factor)).round_ties_even() as i32;
            assert_eq!(Weight(factor).quanta(utility), want, "{factor} times {utility}");
        }
    }

    #[test]
    fn utilities_are_brought_into_range_alike_in_both_precisions() {
        for (given, want) in [(-5.0, 0.0), (-0.0, 0.0), (0.0, 0.0), (50.5, 50.5), (100.0, 100.0), (1e30, 100.0)] {
            assert_eq!((utility(given), single(given as f32)), (want, want), "{given}");
        }
    }
}
