//! Changes of real inputs: of bytes that are binary, and of texts that are words and numbers.

pub mod binary;
pub mod text;

use crate::Dice;

/// How many changes an input gets: mostly few, so that it gets past the first check.
fn count(dice: &mut Dice) -> usize {
    // Bytes at random end at the first checksum, version or unknown key; so real inputs are
    // changed as what they are: numbers for numbers, words for words, records with lengths and
    // checksums that are right again.
    let most = *dice.one_of(&[1, 1, 2, 3, 8]);
    1 + dice.roll(most)
}
