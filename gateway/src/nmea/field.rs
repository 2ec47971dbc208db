//! The fields of a sentence that was read, by number, with errors that say which one is wrong.

use super::ParseError;

/// A sentence's address, and its data fields counted from 1 as manuals do.
pub(super) struct Fields<'a> {
    address: &'a str,
    data: Vec<&'a str>,
}

impl<'a> Fields<'a> {
    pub(super) fn of(body: &'a str) -> Fields<'a> {
        let mut parts = body.split(',');
        let address = parts.next().unwrap_or_default();
        Fields { address, data: parts.collect() }
    }

    pub(super) fn address(&self) -> &'a str {
        self.address
    }

    pub(super) fn len(&self) -> usize {
        self.data.len()
    }

    /// Refuses a sentence with fewer than `expected` data fields.
    pub(super) fn at_least(&self, expected: usize) -> Result<(), ParseError> {
        let found = self.len();
        if found >= expected {
            return Ok(());
        }
        Err(ParseError::TooFew { address: self.address.to_owned(), found, expected })
    }

    /// The text of field `at` without the spaces around it; nothing where the sentence is shorter.
    pub(super) fn text(&self, at: usize) -> &'a str {
        self.data.get(at - 1).map_or("", |text| text.trim_matches(' '))
    }

    /// The number in field `at`, if any.
    pub(super) fn number(&self, at: usize) -> Result<Option<f64>, ParseError> {
        match self.text(at) {
            "" => Ok(None),
            text => number(text).map(Some).ok_or_else(|| self.wrong(at, "a number or nothing")),
        }
    }

    /// The whole number in field `at`, if any.
    pub(super) fn whole<T: std::str::FromStr>(&self, at: usize) -> Result<Option<T>, ParseError> {
        let text = self.text(at);
        if text.is_empty() {
            return Ok(None);
        }
        let number = if text.bytes().all(|byte| byte.is_ascii_digit()) { text.parse().ok() } else { None };
        number.map(Some).ok_or_else(|| self.wrong(at, "a small whole number or nothing"))
    }

    /// Whether the letter in field `at` is `A` (data valid) or `D` (with differential corrections); `V` and nothing
    /// are not.
    pub(super) fn valid(&self, at: usize) -> Result<bool, ParseError> {
        match self.text(at) {
            "A" | "D" => Ok(true),
            "V" | "" => Ok(false),
            _ => Err(self.wrong(at, "A, D, V or nothing")),
        }
    }

    /// Refuses a field `at` that has text other than the unit `letter`: the layout is not the one thought.
    pub(super) fn unit(&self, at: usize, letter: &'static str) -> Result<(), ParseError> {
        let text = self.text(at);
        if text.is_empty() || text == letter { Ok(()) } else { Err(self.wrong(at, letter)) }
    }

    /// The size in field `at` with the sign of the letter after it: `E` positive, `W` negative.
    pub(super) fn east(&self, at: usize) -> Result<Option<f64>, ParseError> {
        let size = self.number(at)?;
        match (size, self.text(at + 1)) {
            (None, "" | "E" | "W") => Ok(None),
            (Some(size), "E") => Ok(Some(size)),
            (Some(size), "W") => Ok(Some(-size)),
            (Some(size), "") if size == 0.0 => Ok(Some(size)),
            _ => Err(self.wrong(at + 1, "E or W")),
        }
    }

    /// The error that field `at` is not what was `expected`.
    pub(super) fn wrong(&self, at: usize, expected: &'static str) -> ParseError {
        let found = self.data.get(at - 1).copied().unwrap_or_default().to_owned();
        ParseError::Field { address: self.address.to_owned(), field: at, found, expected }
    }
}

/// A finite number of the form `[+-]digits[.digits]`: no exponent, no `nan`, no `inf`.
pub(super) fn number(text: &str) -> Option<f64> {
    let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
    let (whole, decimals) = unsigned.split_once('.').unwrap_or((unsigned, "0"));
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let number = if digits(whole) && digits(decimals) { text.parse::<f64>().ok() } else { None };
    number.filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_digits_with_a_sign_and_a_point_at_most() {
        for (text, want) in [
            ("0", Some(0.0)),
            ("000", Some(0.0)),
            ("-33.2", Some(-33.2)),
            ("+1.5", Some(1.5)),
            ("012.70", Some(12.7)),
            ("", None),
            ("-", None),
            (".5", None),
            ("5.", None),
            ("1e3", None),
            ("1_000", None),
            ("nan", None),
            ("NaN", None),
            ("inf", None),
            ("-infinity", None),
            ("--1", None),
            ("1.2.3", None),
            ("0x10", None),
            ("١", None),
        ] {
            assert_eq!(number(text), want, "{text:?}");
        }
        assert_eq!(number(&"9".repeat(400)), None, "a number past every f64");
    }
}
