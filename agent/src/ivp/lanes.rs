//! Groups of numbers that fill a vector register.

/// Number of lanes.
// Sixteen `f32` fill one AVX-512 register. With narrower registers the compiler uses two or four;
// the results are bitwise the same, because no lane depends on the register width.
pub(crate) const LANES: usize = 16;

/// Courses and speeds per tile side: a tile is `SIDE` courses by `SIDE` speeds, a sector `SIDE` by
/// `SIDE` tiles.
pub(super) const SIDE: usize = 4;

const _: () = assert!(SIDE * SIDE == LANES);

/// A group of numbers. Plain loops over all lanes become single instructions.
#[derive(Clone, Copy, Debug)]
// Aligned to a cache line, the size of the widest register: loads that straddle two lines cost
// twice as much.
#[repr(align(64))]
pub(crate) struct Lanes<T>(pub(crate) [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Lanes<T> {
        Lanes([number; LANES])
    }

    /// One number for each lane. Not for hot code: closures are not always inlined.
    pub(super) fn each(number: impl FnMut(usize) -> T) -> Lanes<T> {
        Lanes(std::array::from_fn(number))
    }

    /// Reduces all lanes to one number, two at a time.
    #[inline(always)]
    pub(crate) fn reduced(&self, of_two: impl Fn(T, T) -> T) -> T {
        let mut halves = self.0;
        let mut width = LANES / 2;
        // Reduce in halves, always with the same pairs, so that sums and comparisons have the same
        // order on every machine.
        while width > 0 {
            for i in 0..width {
                halves[i] = of_two(halves[i], halves[i + width]);
            }
            width /= 2;
        }
        halves[0]
    }
}

impl Lanes<i32> {
    /// The largest of all lanes.
    #[inline(always)]
    pub(super) fn most(&self) -> i32 {
        self.reduced(larger)
    }

    /// The first lane that contains this number; there must be one.
    #[inline(always)]
    pub(super) fn place_of(&self, number: i32) -> usize {
        let mut places = 0_u32;
        for (i, lane) in self.0.iter().enumerate() {
            places |= u32::from(*lane == number) << i;
        }
        places.trailing_zeros() as usize
    }

    /// The largest of each group of four neighbours.
    #[inline(always)]
    pub(super) fn most_of_fours(&self) -> [i32; SIDE] {
        let mut fours = [0; SIDE];
        for (four, most) in fours.iter_mut().enumerate() {
            let of = SIDE * four;
            *most = larger(
                larger(self.0[of], self.0[of + 1]),
                larger(self.0[of + 2], self.0[of + 3]),
            );
        }
        fours
    }
}

/// The larger of two numbers, as in processor instructions: the second if unordered.
#[inline(always)]
pub(crate) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    // Not `f32::max`, which handles NaN differently from the processor's instruction.
    if a > b { a } else { b }
}

/// The smaller of two numbers, as in processor instructions: the second if unordered.
#[inline(always)]
pub(crate) fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}
