//! Random numbers for mutations (xorshift64*): of modest quality but fast, and reproducible from
//! the seed.

/// A random number stream.
pub struct Dice(u64);

impl Dice {
    /// The stream for this seed.
    pub fn new(seed: u64) -> Dice {
        // Seeds that differ in a few bits must give very different states, all non-zero.
        Dice(
            seed.wrapping_add(1)
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .max(1),
        )
    }

    /// A number from 0 to `sides - 1`; 0 if there are no sides.
    pub fn roll(&mut self, sides: usize) -> usize {
        (self.number() >> 33) as usize % sides.max(1)
    }

    /// A random number of 64 bits.
    pub fn number(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// A random element of a non-empty slice.
    pub fn one_of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.roll(all.len())]
    }

    /// A random range of at most `most` out of `length` elements.
    pub fn range(&mut self, length: usize, most: usize) -> std::ops::Range<usize> {
        let from = self.roll(length + 1);
        from..(from + 1 + self.roll(most)).min(length).max(from)
    }
}
