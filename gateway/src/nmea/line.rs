//! A sentence being written: fields one by one, then the checksum and the line's end.

use super::{EMITTED_MAX, checksum};
use std::fmt::Write;
use std::ops::Range;

/// `$`, `*`, two digits, CR and LF.
const FRAME: usize = 6;

/// A sentence on its way out.
///
/// Numbers and free texts are spare: should the line come out longer than [`EMITTED_MAX`], its longest spare
/// fields are left empty. Everyone understands an empty field, and a cut one would be another number.
pub(super) struct Line<'a> {
    out: &'a mut Vec<u8>,
    body: String,
    spare: Vec<Range<usize>>,
}

impl<'a> Line<'a> {
    pub(super) fn new(out: &'a mut Vec<u8>, address: &str) -> Line<'a> {
        let mut body = String::with_capacity(EMITTED_MAX);
        body.push_str(address);
        Line { out, body, spare: Vec::new() }
    }

    /// An empty field.
    pub(super) fn empty(&mut self) {
        self.body.push(',');
    }

    /// A field that is never left out; the caller knows that it is short.
    pub(super) fn fixed(&mut self, text: &str) {
        self.body.push(',');
        self.body.push_str(text);
    }

    /// A text of somebody else's: empty if anything in it means something to the framing.
    pub(super) fn words(&mut self, words: &str) {
        let plain = |byte: u8| matches!(byte, b' '..=b'~') && !matches!(byte, b',' | b'*' | b'$');
        self.spare(if words.bytes().all(plain) { words } else { "" });
    }

    /// A letter, or an empty field.
    pub(super) fn letter(&mut self, letter: Option<char>) {
        let mut bytes = [0; 4];
        self.words(letter.map_or("", |letter| letter.encode_utf8(&mut bytes)));
    }

    /// A number with so many decimals; an empty field for none and for what is no finite number.
    pub(super) fn number(&mut self, number: Option<f64>, decimals: usize) {
        self.padded(number, 0, decimals);
    }

    /// A number with zeros before it up to `width`.
    pub(super) fn padded(&mut self, number: Option<f64>, width: usize, decimals: usize) {
        self.spare(&printed(number, width, decimals));
    }

    /// A number without the zeros at its end.
    pub(super) fn brief(&mut self, number: Option<f64>, decimals: usize) {
        let text = printed(number, 0, decimals);
        self.spare(if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text });
    }

    /// A compass angle in 0 (included) to 360 (excluded) as printed.
    pub(super) fn compass(&mut self, angle_deg: Option<f64>, width: usize, decimals: usize) {
        self.padded(angle_deg.map(|angle_deg| compass_deg(angle_deg, decimals)), width, decimals);
    }

    /// A size and `E` for a positive or `W` for a negative number; two empty fields for none.
    pub(super) fn east(&mut self, number: Option<f64>, decimals: usize) {
        let number = number.filter(|number| number.is_finite());
        self.number(number.map(f64::abs), decimals);
        self.letter(number.map(|number| if number < 0.0 { 'W' } else { 'E' }));
    }

    /// Appends the sentence to what is going out.
    pub(super) fn end(mut self) {
        while self.body.len() + FRAME > EMITTED_MAX {
            self.empty_the_longest();
        }
        let sum = checksum(self.body.as_bytes());
        self.out.extend_from_slice(format!("${}*{sum:02X}\r\n", self.body).as_bytes());
    }

    fn spare(&mut self, text: &str) {
        self.body.push(',');
        let start = self.body.len();
        self.body.push_str(text);
        if !text.is_empty() {
            self.spare.push(start..self.body.len());
        }
    }

    /// Empties the longest spare field, the last of equals.
    fn empty_the_longest(&mut self) {
        let longest = self.spare.iter().enumerate().max_by_key(|(_, range)| range.len()).map(|(i, _)| i);
        let gone = self.spare.remove(longest.expect("the fixed fields of every sentence fit"));
        self.body.replace_range(gone.clone(), "");
        for later in self.spare.iter_mut().filter(|range| range.start > gone.start) {
            *later = later.start - gone.len()..later.end - gone.len();
        }
    }
}

/// An angle brought into 0 to 360, such that rounding to so many decimals does not make it 360.
pub(super) fn compass_deg(angle_deg: f64, decimals: usize) -> f64 {
    let turned = angle_deg.rem_euclid(360.0);
    let steps_per_deg = [1.0, 10.0, 100.0, 1000.0][decimals];
    if (turned * steps_per_deg).round() >= 360.0 * steps_per_deg { 0.0 } else { turned }
}

/// The text of a number, never `-0`; nothing for what is no finite number.
fn printed(number: Option<f64>, width: usize, decimals: usize) -> String {
    let mut text = String::new();
    let Some(number) = number.filter(|number| number.is_finite()) else { return text };
    write!(text, "{number:0width$.decimals$}").expect("a string takes what is written to it");
    if text.starts_with('-') && !text.bytes().any(|byte| matches!(byte, b'1'..=b'9')) {
        return printed(Some(0.0), width, decimals);
    }
    text
}
