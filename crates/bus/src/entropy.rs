//! Numbers that nobody can guess; in a simulated network they follow from the seed.

use crate::simulated;

/// A number nobody can guess.
#[must_use]
pub fn random_number() -> u64 {
    u64::from_le_bytes(random_bytes())
}

/// Bytes nobody can guess.
///
/// # Panics
/// If the operating system has no randomness to give.
#[must_use]
pub fn random_bytes<const N: usize>() -> [u8; N] {
    let mut bytes = [0; N];
    // Challenges, tickets and names of sessions are drawn here: without this, no simulated game
    // could be repeated by its seed.
    if simulated::is_inside() {
        let numbers = std::iter::from_fn(simulated::random_number).flat_map(u64::to_le_bytes);
        bytes.iter_mut().zip(numbers).for_each(|(byte, drawn)| *byte = drawn);
    } else {
        getrandom::fill(&mut bytes).expect("the operating system has randomness");
    }
    bytes
}
