//! Checksums of what a run resumes from.

use xxhash_rust::xxh3::xxh3_64;

/// The checksum of a text: XXH3 of 64 bits, 16 hexadecimal digits.
pub(crate) fn checksum(text: &str) -> String {
    format!("{:016x}", xxh3_64(text.as_bytes()))
}
