//! Numbers side by side, as they lie in the widest registers.

/// How many.
// Sixteen `f32` are one register of AVX-512. With less the compiler takes two or four, and the
// results are the same to the bit: no lane ever depends on how many there are.
pub(crate) const LANES: usize = 16;

/// Courses of a tile, and speeds of one: a tile is so many courses and so many speeds, and so many tiles by as many are a
/// sector.
pub(super) const SIDE: usize = 4;

const _: () = assert!(SIDE * SIDE == LANES);

/// Numbers side by side. Plain loops over all of them become single instructions.
#[derive(Clone, Copy, Debug)]
// A cache line and the widest register: loads that straddle two lines cost twice.
#[repr(align(64))]
pub(crate) struct Lanes<T>(pub(crate) [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// The same number in all places.
    #[inline(always)]
    pub(crate) fn splat(number: T) -> Lanes<T> {
        Lanes([number; LANES])
    }

    /// A number for each place. Not for what has to be fast: closures are not always inlined.
    pub(super) fn each(number: impl FnMut(usize) -> T) -> Lanes<T> {
        Lanes(std::array::from_fn(number))
    }
}

impl<T: Copy> Lanes<T> {
    /// All of them brought to one, two at a time.
    #[inline(always)]
    pub(crate) fn reduced(&self, of_two: impl Fn(T, T) -> T) -> T {
        let mut halves = self.0;
        let mut width = LANES / 2;
        // In halves, always the same pairs: sums and comparisons have one order on every
        // machine.
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
    /// The largest.
    #[inline(always)]
    pub(super) fn most(&self) -> i32 {
        self.reduced(larger)
    }

    /// The first place of a number that is there.
    #[inline(always)]
    pub(super) fn place_of(&self, number: i32) -> usize {
        let mut places = 0_u32;
        for (i, lane) in self.0.iter().enumerate() {
            places |= u32::from(*lane == number) << i;
        }
        places.trailing_zeros() as usize
    }

    /// The largest of each four neighbours.
    #[inline(always)]
    pub(super) fn most_of_fours(&self) -> [i32; SIDE] {
        let mut fours = [0; SIDE];
        for (four, most) in fours.iter_mut().enumerate() {
            let of = SIDE * four;
            *most = larger(larger(self.0[of], self.0[of + 1]), larger(self.0[of + 2], self.0[of + 3]));
        }
        fours
    }
}

/// The larger of two numbers, as processors compare them: the second where they do not compare.
#[inline(always)]
pub(crate) fn larger<T: PartialOrd>(a: T, b: T) -> T {
    // Not `f32::max`: that asks for NaN, and a processor's own instruction does not.
    if a > b { a } else { b }
}

/// The smaller of two numbers, as processors compare them: the second where they do not compare.
#[inline(always)]
pub(crate) fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}
