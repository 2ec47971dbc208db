//! Weighted utilities as integers, so that a sum does not depend on its order.

use wide::{f32x8, i32x8};

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
const _: () = assert!(game::strategy::FUNCTIONS_MAX <= FUNCTIONS_MAX);

/// The value of a place that does not exist: below all others, and far enough from overflow for two of them.
pub(super) const NOWHERE: i32 = i32::MIN / 4;

/// A priority weight, in quanta for each point of utility.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weight(f32);

impl Weight {
    /// The weight brought into 0 to [`WEIGHT_MAX`]; a non-finite one counts 0.
    pub(super) fn new(weight: f64) -> Weight {
        debug_assert!(weight.is_finite(), "weight {weight}");
        let weight = if weight.is_finite() { weight.clamp(0.0, WEIGHT_MAX) } else { 0.0 };
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

    /// The weight itself.
    pub(super) fn value(self) -> f64 {
        f64::from(self.0) * QUANTUM
    }

    /// Weighted utilities in quanta, rounded to nearest, half to even.
    #[inline]
    pub(super) fn quanta(self, utility: f32x8) -> i32x8 {
        (utility * f32x8::splat(self.0)).fast_round_int()
    }

    /// One weighted utility in quanta: the same arithmetic.
    #[inline]
    pub(super) fn quanta_of_one(self, utility: f32) -> i32 {
        self.quanta(f32x8::splat(utility)).as_array()[0]
    }
}

/// A utility brought into 0 to 100; a non-finite one counts 0.
pub(super) fn utility(utility: f64) -> f32 {
    debug_assert!(utility.is_finite(), "utility {utility}");
    if utility.is_finite() { utility.clamp(0.0, 100.0) as f32 } else { 0.0 }
}

/// Eight utilities brought into 0 to 100; non-finite ones count 0. The same as [`utility`].
#[inline]
pub(super) fn utilities(utilities: f32x8) -> f32x8 {
    debug_assert!(utilities.as_array().iter().all(|utility| utility.is_finite()), "utilities {utilities:?}");
    let is_finite = utilities.abs().simd_lt(f32x8::splat(f32::INFINITY));
    (utilities & is_finite).fast_max(f32x8::ZERO).fast_min(f32x8::splat(100.0))
}
