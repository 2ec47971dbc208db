//! Numbers in lanes, as in wide registers.
//!
//! Every operation is a plain loop over all lanes, which compiles to one instruction, or to several
//! on narrower registers. The results are bit-identical, because each lane is computed separately
//! and rounded by IEEE 754, and operations are never fused.

use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Number of single-precision numbers in the widest registers. This many wave components are
/// computed side by side.
// Crates such as `wide` choose the registers at compile time; with plain arrays the choice is made
// at run time.
pub(crate) const LANES: usize = 16;

/// Number of components in a row. Each position in the row has its own partial sum over the
/// components, so that the additions do not wait for each other.
pub(crate) const ROW: usize = 4;

/// Number of rows side by side, or number of quantities for each component of a row.
pub(crate) const FOLD: usize = LANES / ROW;

/// Numbers side by side. Sixteen lanes hold one number for each of sixteen components, or four
/// quantities for each of the four components of a row, grouped by quantity.
#[derive(Clone, Copy, Debug)]
// Aligned to a cache line, the width of the widest registers: loads never straddle two lines.
#[repr(align(64))]
pub(crate) struct Lanes<T, const N: usize = LANES>(pub(crate) [T; N]);

macro_rules! operators {
    ($number:ty: $($trait:ident $method:ident $operator:tt),*) => {
        $(impl<const N: usize> $trait for Lanes<$number, N> {
            type Output = Lanes<$number, N>;

            #[inline(always)]
            fn $method(mut self, other: Lanes<$number, N>) -> Lanes<$number, N> {
                for i in 0..N {
                    self.0[i] $operator other.0[i];
                }
                self
            }
        })*
    };
}

operators!(f32: Add add +=, Sub sub -=, Mul mul *=);
operators!(f64: Add add +=, Sub sub -=, Mul mul *=, Div div /=);

impl<const N: usize> AddAssign for Lanes<f32, N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes<f32, N>) {
        *self = *self + other;
    }
}

impl<T: Copy, const N: usize> Lanes<T, N> {
    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Lanes<T, N> {
        Lanes([number; N])
    }
}

impl<const N: usize> Lanes<f64, N> {
    /// Rounds to single precision.
    #[inline(always)]
    pub(crate) fn single(self) -> Lanes<f32, N> {
        let mut single = Lanes::splat(0.0);
        for i in 0..N {
            single.0[i] = self.0[i] as f32;
        }
        single
    }

    /// The absolute values.
    #[inline(always)]
    pub(crate) fn abs(mut self) -> Lanes<f64, N> {
        for number in &mut self.0 {
            *number = number.abs();
        }
        self
    }

    /// These non-negative numbers with the signs of `others`.
    #[inline(always)]
    pub(crate) fn with_signs_of(mut self, others: Lanes<f64, N>) -> Lanes<f64, N> {
        for i in 0..N {
            self.0[i] = self.0[i].copysign(others.0[i]);
        }
        self
    }
}

/// For each lane, the number in `first` if the one in `a` is at most the one in `b`, otherwise the
/// number in `second`.
#[inline(always)]
pub(crate) fn where_at_most<const N: usize>(
    (a, b): (Lanes<f64, N>, Lanes<f64, N>),
    first: Lanes<f64, N>,
    second: Lanes<f64, N>,
) -> Lanes<f64, N> {
    let mut chosen = second;
    for i in 0..N {
        chosen.0[i] = if a.0[i] <= b.0[i] {
            first.0[i]
        } else {
            second.0[i]
        };
    }
    chosen
}

impl Lanes<f32> {
    /// Four quantities for each component of a row.
    pub(crate) fn of_row(numbers: [[f32; ROW]; FOLD]) -> Lanes<f32> {
        let mut lanes = Lanes::splat(0.0);
        lanes.0.copy_from_slice(numbers.as_flattened());
        lanes
    }

    /// Takes the numbers of one row from those of sixteen components, and repeats them four times.
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> Lanes<f32> {
        let mut repeated = Lanes::splat(0.0);
        for i in 0..LANES {
            repeated.0[i] = self.0[ROW * row + i % ROW];
        }
        repeated
    }

    /// The sum of one of the four quantities over the components of a row, always in the same
    /// order.
    #[inline(always)]
    pub(crate) fn sum(&self, number: usize) -> f64 {
        let at = |place: usize| f64::from(self.0[ROW * number + place]);
        // Use the same order on every machine: a sum of four parts, whatever the register width.
        (at(0) + at(1)) + (at(2) + at(3))
    }
}
