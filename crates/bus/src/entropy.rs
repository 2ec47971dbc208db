//! Unpredictable random numbers for challenges, tickets and session names.

use crate::runtime::runtime;

/// An unpredictable random number.
#[must_use]
pub fn random_number() -> u64 {
    u64::from_le_bytes(random_bytes())
}

/// Unpredictable random bytes.
///
/// # Panics
/// If the operating system cannot provide randomness.
#[must_use]
pub fn random_bytes<const N: usize>() -> [u8; N] {
    let mut bytes = [0; N];
    runtime().fill_random(&mut bytes);
    bytes
}
