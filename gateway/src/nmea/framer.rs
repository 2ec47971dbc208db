//! Splits incoming bytes into sentences, and counts what it discards.
//!
//! The framer keeps at most one sentence, in a buffer of fixed size, so no peer can exhaust memory.
//! A `$` always starts a new sentence, so the next complete sentence is found after any noise.

use super::checksum;
use serde::{Deserialize, Serialize};

/// Maximum bytes of an accepted sentence, including `$` and CR LF. The standard says 82, but
/// receivers that send minutes with seven decimal places send GGA sentences of 88.
pub const ACCEPTED_MAX: usize = 256;

/// Maximum bytes between `$` and the end of the line: body, `*` and two digits.
const CONTENT_MAX: usize = ACCEPTED_MAX - 3;

/// Counts of the input of a [`Framer`].
///
/// Every `$` is counted in exactly one of `sentences`, `bad_checksum`, `overlong` and `broken`,
/// except that of a sentence that is still incomplete.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Sentences with a valid checksum.
    pub sentences: u64,
    /// Well-formed sentences with a wrong checksum.
    pub bad_checksum: u64,
    /// Sentences discarded because they exceeded [`ACCEPTED_MAX`].
    pub overlong: u64,
    /// Bytes outside sentences, except CR and LF. The rest of an abandoned sentence counts as
    /// outside.
    pub garbage: u64,
    /// A `$` without a well-formed end: a control or non-ASCII byte, or a missing checksum.
    pub broken: u64,
}

/// A line that looked like a sentence but was not one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// The stored part of the line, from its `$`.
    pub line: String,
    /// The fault.
    pub why: &'static str,
}

/// Splits a byte stream into sentences.
#[derive(Clone, Debug)]
pub struct Framer {
    content: [u8; CONTENT_MAX],
    /// Bytes of `content` in use; `None` outside a sentence.
    filled: Option<usize>,
    counts: Counts,
    rejected: Option<Rejected>,
}

impl Default for Framer {
    fn default() -> Framer {
        Framer::new()
    }
}

impl Framer {
    /// A framer waiting for its first `$`.
    pub fn new() -> Framer {
        Framer {
            content: [0; CONTENT_MAX],
            filled: None,
            counts: Counts::default(),
            rejected: None,
        }
    }

    /// Accepts bytes, however they are split and with any garbage. Calls `take` with the body
    /// (between `$` and `*`, ASCII) of each sentence with a valid checksum, in order.
    ///
    /// A sentence ends with CR, LF or the next `$`, whichever comes first, so a peer may use only
    /// one of them. Spaces, tabs and NULs after the checksum are padding.
    pub fn push(&mut self, bytes: &[u8], take: &mut dyn FnMut(&str)) {
        for &byte in bytes {
            match (byte, self.filled) {
                // The start may be in the middle of a truncated sentence: gpsd, for example, writes
                // probes and binary bytes into a boat's stream.
                (b'$', filled) => {
                    filled.into_iter().for_each(|filled| self.end(filled, take));
                    self.filled = Some(0);
                }
                (b'\r' | b'\n', None) => {}
                // Either character ends it: some devices send only LF.
                (b'\r' | b'\n', Some(filled)) => self.end(filled, take),
                (b' '..=b'~', Some(filled)) if filled < CONTENT_MAX => {
                    self.content[filled] = byte;
                    self.filled = Some(filled + 1);
                }
                // Records of fixed length are padded with NULs.
                (0 | b'\t', Some(filled)) if split(&self.content[..filled]).is_some() => {}
                (_, filled) => self.stray(byte, filled),
            }
        }
    }

    /// The counts so far.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The last line that was not a sentence, to help find the cause.
    pub fn rejected(&self) -> Option<&Rejected> {
        self.rejected.as_ref()
    }

    fn reject(&mut self, filled: usize, why: &'static str) {
        let line = format!("${}", String::from_utf8_lossy(&self.content[..filled]));
        self.rejected = Some(Rejected { line, why });
    }

    /// Handles a byte that cannot be part of a sentence: the byte ends an incomplete sentence.
    fn stray(&mut self, byte: u8, filled: Option<usize>) {
        self.counts.garbage += 1;
        self.filled = None;
        let Some(filled) = filled else { return };
        if (b' '..=b'~').contains(&byte) {
            self.counts.overlong += 1;
            self.reject(filled, "is too long");
        } else {
            self.counts.broken += 1;
            self.reject(filled, "is interrupted by a non-text byte");
        }
    }

    /// Handles the end of a line after `filled` bytes of content.
    fn end(&mut self, filled: usize, take: &mut dyn FnMut(&str)) {
        self.filled = None;
        let Some((body, stated)) = split(&self.content[..filled]) else {
            self.counts.broken += 1;
            self.reject(filled, "has no checksum");
            return;
        };
        if checksum(body) != stated {
            self.counts.bad_checksum += 1;
            self.reject(filled, "has a wrong checksum");
            return;
        }
        self.counts.sentences += 1;
        take(std::str::from_utf8(body).expect("only ASCII is kept"));
    }
}

/// The body, and the checksum stated after it. `None` unless `*` and two hex digits end the content
/// apart from padding, or if the body contains a second `*`.
fn split(content: &[u8]) -> Option<(&[u8], u8)> {
    let (body, [b'*', high, low]) = content.trim_ascii_end().split_last_chunk::<3>()? else {
        return None;
    };
    let digit = |byte: u8| {
        char::from(byte)
            .to_digit(16)
            .and_then(|digit| u8::try_from(digit).ok())
    };
    let stated = digit(*high)? * 16 + digit(*low)?;
    (!body.contains(&b'*')).then_some((body, stated))
}
