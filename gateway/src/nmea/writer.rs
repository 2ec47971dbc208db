//! Writes a sentence according to its layout: the fields one by one, then checksum and line end.

use super::date_time::{Date, TimeOfDay};
use super::layout::{Field, Format, Layout, TENTHS};
use super::position::{LATITUDE, LONGITUDE};
use super::{EMITTED_MAX, with_checksum};
use primitives::LatLon;
use std::ops::Range;

/// Number of bytes around the body: `$`, `*`, two digits, CR and LF.
const FRAME: usize = 6;

/// A sentence being written.
///
/// Numbers and free-text fields are optional: if the line would exceed [`EMITTED_MAX`], the longest
/// optional fields are left empty. Every reader understands an empty field, whereas a truncated one
/// would be a different number.
pub(super) struct Writer {
    body: String,
    spare: Vec<Range<usize>>,
}

impl Writer {
    /// The sentence with this layout.
    pub(super) fn line(layout: Layout<'_>) -> String {
        let mut line = Writer {
            body: String::with_capacity(EMITTED_MAX),
            spare: Vec::new(),
        };
        layout
            .fields
            .into_iter()
            .for_each(|field| line.field(field));
        // Omit a field rather than send a sentence that a strict reader rejects.
        while line.body.len() + FRAME > EMITTED_MAX {
            line.empty_the_longest();
        }
        with_checksum(&line.body)
    }

    fn field(&mut self, field: Field<'_>) {
        match field {
            Field::Address(address) => self.body.push_str(address),
            Field::Standard(talker, kind) => {
                self.body.extend(talker.0.map(char::from));
                self.body.push_str(kind);
            }
            Field::Constant(text) | Field::Unit(text) => self.fixed(text),
            Field::Optional(is_there, text) => {
                if *is_there {
                    self.fixed(text);
                }
            }
            Field::Number(number, format) => self.number(*number, format),
            Field::Required(number, format, _) => self.number(Some(*number), format),
            Field::ReadOnly(_) => self.fixed(""),
            Field::East(number) => {
                // The sign is a separate letter; both are empty for a missing number.
                let number = number.filter(|number| number.is_finite());
                self.number(number.map(f64::abs), TENTHS);
                self.spare(number.map_or("", |number| if number < 0.0 { "W" } else { "E" }));
            }
            Field::Whole(number, width) => {
                self.spare(&number.map_or_else(String::new, |n| format!("{n:0width$}")))
            }
            Field::Quality(quality) => self.fixed(&quality.to_string()),
            Field::Index(index) => self.fixed(&index.to_string()),
            Field::Text(text) => self.text(text),
            Field::Letter(letter) => self.text(&letter.map_or_else(String::new, String::from)),
            Field::Mode(mode) => self.fixed(&String::from(mode.letter())),
            Field::Operator(operator) => {
                self.spare(&operator.map_or_else(String::new, |o| o.number().to_string()))
            }
            // This field is never omitted: without it, a reader would have to guess whether a fix
            // is valid.
            Field::ValidFix(valid, _) => self.fixed(if *valid { "A" } else { "V" }),
            Field::Time(time) => self.fixed(&time.and_then(TimeOfDay::text).unwrap_or_default()),
            Field::Date(date) => self.fixed(&date.and_then(Date::text).unwrap_or_default()),
            Field::DayMonthYear(date) => self.day_month_year(*date),
            Field::Position(at, decimals) => self.position(*at, decimals),
            Field::Place(at, decimals) => self.position(Some(*at), decimals),
        }
    }

    /// A position in four fields, which are empty if it is missing or off the globe.
    fn position(&mut self, at: Option<LatLon>, decimals: u32) {
        // Write both or neither: half a position would be read as one on the equator or the prime
        // meridian.
        let texts = at.and_then(|at| {
            Some((
                LATITUDE.printed(at.lat_deg, decimals)?,
                LONGITUDE.printed(at.lon_deg, decimals)?,
            ))
        });
        let (lat, lon) = texts.unwrap_or_else(|| (",".to_owned(), ",".to_owned()));
        self.fixed(&lat);
        self.fixed(&lon);
    }

    /// A date in three fields.
    fn day_month_year(&mut self, date: Option<Date>) {
        match date.filter(|date| date.is_valid() && date.year < 10_000) {
            Some(Date { year, month, day }) => {
                self.fixed(&format!("{day:02},{month:02},{year:04}"))
            }
            None => self.fixed(",,"),
        }
    }

    /// Writes a field that is never omitted; the caller ensures that it is short.
    fn fixed(&mut self, text: &str) {
        self.body.push(',');
        self.body.push_str(text);
    }

    fn number(&mut self, number: Option<f64>, format: Format) {
        self.spare(&format.text(number));
    }

    /// Writes an external string; if it contains a framing character, the field is left empty.
    fn text(&mut self, text: &str) {
        let plain = |byte: u8| matches!(byte, b' '..=b'~') && !matches!(byte, b',' | b'*' | b'$');
        self.spare(if text.bytes().all(plain) { text } else { "" });
    }

    fn spare(&mut self, text: &str) {
        self.body.push(',');
        let start = self.body.len();
        self.body.push_str(text);
        if !text.is_empty() {
            self.spare.push(start..self.body.len());
        }
    }

    /// Empties the longest optional field; of several equally long ones, the last.
    fn empty_the_longest(&mut self) {
        let longest = self
            .spare
            .iter()
            .enumerate()
            .max_by_key(|(_, range)| range.len())
            .map(|(i, _)| i);
        let gone = self
            .spare
            .remove(longest.expect("the fixed fields of every sentence fit"));
        self.body.replace_range(gone.clone(), "");
        for later in self
            .spare
            .iter_mut()
            .filter(|range| range.start > gone.start)
        {
            *later = later.start - gone.len()..later.end - gone.len();
        }
    }
}
