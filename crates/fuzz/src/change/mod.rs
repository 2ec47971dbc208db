//! Mutates real inputs: binary ones by bytes, texts by words and numbers.

pub mod binary;
pub mod text;

use crate::Dice;

/// Number of mutations of an input: usually few, so that it passes the first check.
fn count(dice: &mut Dice) -> usize {
    // Random bytes fail at the first checksum, version or unknown key. So mutations follow the
    // structure of real inputs: number for number, word for word, and records with corrected
    // lengths and checksums.
    let most = *dice.one_of(&[1, 1, 2, 3, 8]);
    1 + dice.roll(most)
}
