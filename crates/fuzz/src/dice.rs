//! Random numbers for changing inputs (xorshift64*): not good ones, but many, and the same for the same seed.

/// A stream of random numbers.
pub struct Dice(u64);

impl Dice {
    /// The stream of this seed.
    #[must_use]
    pub fn new(seed: u64) -> Dice {
        // Seeds that differ in a few bits are to differ in all; none may be 0.
        Dice(seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15).max(1))
    }

    /// 0 to `sides - 1`; of no sides 0.
    pub fn roll(&mut self, sides: usize) -> usize {
        (self.number() >> 33) as usize % sides.max(1)
    }

    /// Any 64 bits.
    pub fn number(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// One of them; there must be one.
    pub fn one_of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.roll(all.len())]
    }

    /// A part of something this long, of at most `most`.
    pub fn range(&mut self, length: usize, most: usize) -> std::ops::Range<usize> {
        let from = self.roll(length + 1);
        from..(from + 1 + self.roll(most)).min(length).max(from)
    }
}
