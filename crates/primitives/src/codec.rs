//! Encodes and decodes messages: CDR, little-endian, with the 4-byte encapsulation header.
//!
//! ROS 2 and its tools can read this format. Every message begins with a [`Stamp`], whose version
//! is checked first, so that a message from a newer peer causes a clear error instead of garbage.

use crate::stamp::{Message, Stamp};
use byteorder::LittleEndian;
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// The header of every message: plain CDR, little-endian.
pub const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

/// Why bytes do not form a message.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DecodeError {
    /// The first four bytes are not the header of little-endian CDR.
    #[error("not CDR little-endian: the bytes begin with {found:02x?}, expected 00 01 00 00")]
    Encapsulation {
        /// The first bytes found, at most four.
        found: Vec<u8>,
    },
    /// The sender uses a different version of this message.
    #[error("{schema} has version {found}; this program reads version {expected}")]
    Version {
        /// The message's name.
        schema: &'static str,
        /// The sender's version.
        found: u8,
        /// Our version.
        expected: u8,
    },
    /// The bytes do not fit the message's layout.
    #[error("not a {schema}: {reason}")]
    Layout {
        /// The message's name.
        schema: &'static str,
        /// The mismatch.
        reason: String,
    },
}

/// Encodes `message`.
///
/// # Panics
/// Never: every message is a plain struct of numbers, lists and strings.
pub fn encode<M: Message + Serialize>(message: &M) -> Vec<u8> {
    encode_plain(message)
}

/// Encodes a message without a stamp, for another system.
///
/// # Panics
/// If the length of a list is not known in advance: use plain structs of numbers, lists and
/// strings.
pub fn encode_plain<T: Serialize>(message: &T) -> Vec<u8> {
    // Large enough for most messages: growing would cost as much as writing.
    let mut bytes = Vec::with_capacity(4096);
    bytes.extend(ENCAPSULATION);
    cdr_encoding::to_writer::<T, LittleEndian, _>(&mut bytes, message)
        .expect("a plain struct always encodes");
    bytes
}

/// Decodes a message without a stamp, from another system; `None` if its layout differs. Up to
/// three bytes of padding may follow.
pub fn decode_plain<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let body = bytes.strip_prefix(&ENCAPSULATION)?;
    let (message, used) = cdr_encoding::from_bytes::<T, LittleEndian>(body).ok()?;
    (body.len() - used < 4).then_some(message)
}

/// Decodes the message in `bytes`.
///
/// # Errors
/// [`DecodeError`] names the invalid part; bytes after the end of the message are an error.
pub fn decode<M: Message + DeserializeOwned>(bytes: &[u8]) -> Result<M, DecodeError> {
    let schema = M::SCHEMA;
    let body = bytes
        .strip_prefix(&ENCAPSULATION)
        .ok_or_else(|| DecodeError::Encapsulation {
            found: bytes.iter().take(4).copied().collect(),
        })?;
    let layout = |reason: String| DecodeError::Layout { schema, reason };
    let (stamp, _) =
        cdr_encoding::from_bytes::<Stamp, LittleEndian>(body).map_err(|e| layout(e.to_string()))?;
    if !(M::OLDEST..=M::VERSION).contains(&stamp.version) {
        return Err(DecodeError::Version {
            schema,
            found: stamp.version,
            expected: M::VERSION,
        });
    }
    let (message, used) =
        cdr_encoding::from_bytes::<M, LittleEndian>(body).map_err(|e| layout(e.to_string()))?;
    if used != body.len() {
        return Err(layout(format!(
            "{} extra bytes at the end",
            body.len() - used
        )));
    }
    Ok(message)
}
