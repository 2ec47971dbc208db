//! Mutates real inputs: binary ones byte by byte, texts by words and numbers.

pub mod binary;
pub mod text;

use crate::Dice;

/// Number of mutations per input: mostly few, so that inputs pass the first check.
fn count(dice: &mut Dice) -> usize {
    // Random bytes fail at the first checksum, version or unknown key. Mutations therefore follow
    // the structure of real inputs: a number replaces a number, a word a word, and records get
    // correct lengths and checksums.
    let most = *dice.one_of(&[1, 1, 2, 3, 8]);
    1 + dice.roll(most)
}
