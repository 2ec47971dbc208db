//! The framer: cuts whatever comes down a wire into sentences, and counts what it had to leave.
//!
//! It keeps at most one sentence, in a buffer of fixed size, so no peer can make it grow. A `$` always begins
//! anew: after any noise the next whole sentence is found.

use super::checksum;
use serde::{Deserialize, Serialize};

/// The longest sentence read, bytes with `$` and CR LF. The standard says 82, but receivers with seven decimals
/// of minutes send GGA of 88.
pub const ACCEPTED_MAX: usize = 256;

/// What stands between `$` and the line's end: body, `*` and two digits.
const CONTENT_MAX: usize = ACCEPTED_MAX - 3;

/// What came through a [`Framer`].
///
/// Every `$` ever pushed is in exactly one of `sentences`, `bad_checksum`, `overlong` and `broken`, but for the
/// one that may still be under way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Sentences with a right checksum.
    pub sentences: u64,
    /// Well-formed sentences with a wrong checksum.
    pub bad_checksum: u64,
    /// Sentences given up because they went past [`ACCEPTED_MAX`].
    pub overlong: u64,
    /// Bytes outside of sentences, CR and LF not counted. The rest of a sentence that was given up is outside.
    pub garbage: u64,
    /// A `$` that no well-formed end followed: a control or non-ASCII byte, or a missing checksum.
    pub broken: u64,
}

/// A line that began like a sentence and was none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// The line from its `$` on, as far as it was kept.
    pub line: String,
    /// What is wrong with it.
    pub why: &'static str,
}

/// Cuts a byte stream into sentences.
#[derive(Clone, Debug)]
pub struct Framer {
    content: [u8; CONTENT_MAX],
    /// How much of `content` is filled; none outside of a sentence.
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
    /// A framer that waits for its first `$`.
    #[must_use]
    pub fn new() -> Framer {
        Framer { content: [0; CONTENT_MAX], filled: None, counts: Counts::default(), rejected: None }
    }

    /// Takes bytes as they come (any split, any garbage); calls `take` with the body (between `$` and `*`, ASCII)
    /// of each sentence with a right checksum, in order.
    ///
    /// A sentence ends with CR, LF or the next `$`, whichever comes first, so a peer that sends only one of them is read
    /// too. Blanks and NULs after the checksum are padding.
    pub fn push(&mut self, bytes: &[u8], take: &mut dyn FnMut(&str)) {
        for &byte in bytes {
            match (byte, self.filled) {
                // The start may be in the middle of a sentence that was cut off: gpsd, for
                // example, writes probes and binary bytes into the stream of a boat.
                (b'$', filled) => {
                    filled.into_iter().for_each(|filled| self.end(filled, take));
                    self.filled = Some(0);
                }
                (b'\r' | b'\n', None) => {}
                // Either ends it: some devices send LF alone.
                (b'\r' | b'\n', Some(filled)) => self.end(filled, take),
                (b' '..=b'~', Some(filled)) if filled < CONTENT_MAX => {
                    self.content[filled] = byte;
                    self.filled = Some(filled + 1);
                }
                // Records of a fixed length are padded with it.
                (0, Some(filled)) if split(&self.content[..filled]).is_some() => {}
                (_, filled) => self.stray(byte, filled),
            }
        }
    }

    /// What came through so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// The last line that was no sentence, for people who look for the reason.
    #[must_use]
    pub fn rejected(&self) -> Option<&Rejected> {
        self.rejected.as_ref()
    }

    fn reject(&mut self, filled: usize, why: &'static str) {
        let line = format!("${}", String::from_utf8_lossy(&self.content[..filled]));
        self.rejected = Some(Rejected { line, why });
    }

    /// A byte that belongs to no sentence: the one under way is given up with it.
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

    /// The line's end after `filled` bytes of content.
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

/// The body and the checksum stated after it; nothing if `*` and two digits of either case are not the end but for blanks,
/// or a second `*` stands in the body.
fn split(content: &[u8]) -> Option<(&[u8], u8)> {
    let (body, [b'*', high, low]) = content.trim_ascii_end().split_last_chunk::<3>()? else { return None };
    let digit = |byte: u8| char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok());
    let stated = digit(*high)? * 16 + digit(*low)?;
    (!body.contains(&b'*')).then_some((body, stated))
}
