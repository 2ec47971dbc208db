//! Reads the fields of a sentence according to its layout; errors name the faulty field.

use super::ParseError;
use super::date_time::{Date, TimeOfDay};
use super::layout::{Field, Layout};
use super::mode::Mode;
use super::number::number;
use super::operator::Operator;
use super::position::{Axis, LATITUDE, LONGITUDE};
use super::talker::Talker;
use primitives::LatLon;
use std::str::FromStr;

/// A sentence's address, and its data fields, numbered from 1 as in manuals.
pub(super) struct Reader<'a> {
    pub(super) address: &'a str,
    data: Vec<&'a str>,
    /// The field read last.
    at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn of(body: &'a str) -> Reader<'a> {
        let mut parts = body.split(',');
        let address = parts.next().unwrap_or_default();
        Reader {
            address,
            data: parts.collect(),
            at: 0,
        }
    }

    /// Reads all fields of a layout.
    pub(super) fn read(mut self, layout: Layout<'_>) -> Result<(), ParseError> {
        // More fields than expected are accepted: drivers of real boats send PSEAC with four to
        // six.
        let found = self.data.len();
        let expected = layout.fields_min;
        if found < expected {
            return Err(ParseError::TooFew {
                address: self.address.to_owned(),
                found,
                expected,
            });
        }
        layout
            .fields
            .into_iter()
            .try_for_each(|field| self.read_field(field))
    }

    fn read_field(&mut self, field: Field<'_>) -> Result<(), ParseError> {
        match field {
            Field::Address(_) => {}
            // Accept any talker: the same sentence arrives as GP, GN or II, depending on the
            // receiver's manufacturer.
            Field::Standard(talker, _) => {
                *talker = Talker::split(self.address).map_or(*talker, |(talker, _)| talker)
            }
            Field::Constant(_) => self.at += 1,
            Field::Unit(letter) => self.unit(letter)?,
            Field::Optional(is_there, _) => {
                *is_there = self.data.len() > self.at;
                self.next();
            }
            Field::Number(number, _) | Field::ReadOnly(number) => *number = self.number()?,
            Field::Required(number, _, expected) => {
                *number = self.number()?.ok_or_else(|| self.wrong(expected))?
            }
            Field::East(number) => *number = self.east()?,
            Field::Whole(number, _) => *number = self.whole()?,
            Field::Quality(quality) => *quality = self.whole()?.unwrap_or_default(),
            Field::Index(index) => {
                *index = self
                    .whole()?
                    .ok_or_else(|| self.wrong("the waypoint's number"))?
            }
            Field::Text(text) => *text = self.next().to_owned(),
            Field::Letter(letter) => *letter = self.next().chars().next(),
            Field::Mode(mode) => *mode = self.mode()?,
            Field::Operator(operator) => *operator = self.whole()?.map(Operator::from_number),
            // Receivers also mark dead reckoning and manual input as valid, like a fix.
            Field::ValidFix(valid, ahead) => {
                *valid = self.valid()? && !matches!(self.peek(ahead), "E" | "M" | "S" | "N");
            }
            Field::Time(time) => {
                *time = self.parsed(TimeOfDay::parse, "a time hhmmss.ss or an empty field")?
            }
            Field::Date(date) => {
                *date = self.parsed(Date::parse, "a date ddmmyy or an empty field")?
            }
            Field::DayMonthYear(date) => *date = self.day_month_year()?,
            Field::Position(at, _) => *at = self.position()?,
            Field::Place(at, _) => {
                let latitude = self.at + 1;
                *at = self
                    .position()?
                    .ok_or_else(|| self.wrong_at(latitude, "a latitude"))?;
            }
        }
        Ok(())
    }

    /// The next field without surrounding spaces; empty if the sentence is shorter.
    fn next(&mut self) -> &'a str {
        self.at += 1;
        self.text(self.at)
    }

    /// The field `ahead` fields later, without consuming it.
    fn peek(&self, ahead: usize) -> &'a str {
        self.text(self.at + ahead)
    }

    // Real boats send a space for a field that they do not support.
    fn text(&self, at: usize) -> &'a str {
        self.data
            .get(at - 1)
            .map_or("", |text| text.trim_matches(' '))
    }

    /// The next field, parsed with `parse`; `None` if it is empty.
    fn parsed<T>(
        &mut self,
        parse: fn(&str) -> Option<T>,
        expected: &'static str,
    ) -> Result<Option<T>, ParseError> {
        match self.next() {
            "" => Ok(None),
            text => parse(text).map(Some).ok_or_else(|| self.wrong(expected)),
        }
    }

    /// The number in the next field, if any.
    fn number(&mut self) -> Result<Option<f64>, ParseError> {
        self.parsed(number, "a number or an empty field")
    }

    /// The whole number in the next field, if any.
    fn whole<T: FromStr>(&mut self) -> Result<Option<T>, ParseError> {
        // The standard library's parser accepts a plus sign, which in a sentence means that fields
        // have shifted.
        let whole = |text: &str| {
            text.parse()
                .ok()
                .filter(|_| text.bytes().all(|byte| byte.is_ascii_digit()))
        };
        self.parsed(whole, "a small whole number or an empty field")
    }

    fn mode(&mut self) -> Result<Mode, ParseError> {
        let mut letters = self.next().chars();
        let mode = letters
            .next()
            .and_then(Mode::from_letter)
            .filter(|_| letters.next().is_none());
        mode.ok_or_else(|| self.wrong("the letter of a control mode"))
    }

    /// The position in the next four fields, if any; an incomplete position is an error.
    fn position(&mut self) -> Result<Option<LatLon>, ParseError> {
        if self.peek(1).is_empty() && self.peek(3).is_empty() {
            self.at += 4;
            return Ok(None);
        }
        let lat_deg = self.coordinate(&LATITUDE)?;
        let lon_deg = self.coordinate(&LONGITUDE)?;
        Ok(Some(LatLon { lat_deg, lon_deg }))
    }

    fn coordinate(&mut self, axis: &Axis) -> Result<f64, ParseError> {
        let size_deg = axis
            .degrees(self.next())
            .ok_or_else(|| self.wrong(axis.expected))?;
        let sign = axis
            .sign(self.next())
            .ok_or_else(|| self.wrong(axis.expected_letter))?;
        Ok(sign * size_deg)
    }

    /// The date in the next three fields.
    fn day_month_year(&mut self) -> Result<Option<Date>, ParseError> {
        let first = self.at + 1;
        let date = match (self.whole()?, self.whole()?, self.whole()?) {
            (None, None, None) => return Ok(None),
            (Some(day), Some(month), Some(year)) => Date { year, month, day },
            _ => return Err(self.wrong_at(first, "day, month and year, or three empty fields")),
        };
        if date.is_valid() {
            Ok(Some(date))
        } else {
            Err(self.wrong_at(first, "a valid date"))
        }
    }

    /// Reads a validity field. `A` (data valid) and `D` (with differential corrections) mean valid;
    /// `V` and an empty field mean invalid.
    fn valid(&mut self) -> Result<bool, ParseError> {
        match self.next() {
            "A" | "D" => Ok(true),
            "V" | "" => Ok(false),
            _ => Err(self.wrong("A, D, V or an empty field")),
        }
    }

    /// Reads the unit `letter` or an empty field. Any other unit means a different layout, and is
    /// rejected.
    fn unit(&mut self, letter: &'static str) -> Result<(), ParseError> {
        let text = self.next();
        if text.is_empty() || text == letter {
            Ok(())
        } else {
            Err(self.wrong(letter))
        }
    }

    fn east(&mut self) -> Result<Option<f64>, ParseError> {
        match (self.number()?, self.next()) {
            (None, "" | "E" | "W") => Ok(None),
            (Some(size), "E") => Ok(Some(size)),
            (Some(size), "W") => Ok(Some(-size)),
            (Some(size), "") if size == 0.0 => Ok(Some(size)),
            _ => Err(self.wrong("E or W")),
        }
    }

    /// The error that the last field read does not match `expected`.
    fn wrong(&self, expected: &'static str) -> ParseError {
        self.wrong_at(self.at, expected)
    }

    /// The error that the given field does not match `expected`.
    fn wrong_at(&self, field: usize, expected: &'static str) -> ParseError {
        let found = self
            .data
            .get(field - 1)
            .copied()
            .unwrap_or_default()
            .to_owned();
        ParseError::Field {
            address: self.address.to_owned(),
            field,
            found,
            expected,
        }
    }
}
