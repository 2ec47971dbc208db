//! Numbers that nobody can guess. Challenges, tickets and names of sessions are drawn here.

use crate::runtime::runtime;

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
    runtime().fill_random(&mut bytes);
    bytes
}
