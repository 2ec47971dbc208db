//! Checksums of the data from which a run resumes.

use xxhash_rust::xxh3::xxh3_64;

/// The checksum of a string: 64-bit XXH3, 16 hexadecimal digits.
pub(crate) fn checksum(text: &str) -> String {
    format!("{:016x}", xxh3_64(text.as_bytes()))
}
