//! Date and time of day as they appear in sentences.

use primitives::SimTime;
use serde::{Deserialize, Serialize};
use time::{Month, UtcDateTime};

/// Milliseconds in a day without a leap second.
const DAY_MS: u32 = 86_400_000;

/// A time of day, UTC, in milliseconds since midnight.
///
/// Written to two decimal places, or three if the milliseconds need them. A leap second is 86 400
/// 000 to 86 400 999; larger values are written as an empty field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct TimeOfDay(pub u32);

impl TimeOfDay {
    /// Parses a field `hhmmss`, with or without decimal places.
    pub(super) fn parse(text: &str) -> Option<TimeOfDay> {
        let (clock, decimals) = text.split_once('.').unwrap_or((text, "0"));
        let [hour, minute, second] = pairs(clock)?.map(u32::from);
        if decimals.is_empty() || !decimals.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        // Truncate to milliseconds: rounding could carry into the next second.
        let digit = |i: usize| u32::from(decimals.as_bytes().get(i).map_or(0, |byte| byte - b'0'));
        let ms = digit(0) * 100 + digit(1) * 10 + digit(2);
        // Leap seconds are inserted at the end of a UTC day only.
        let seconds_max = if (hour, minute) == (23, 59) { 60 } else { 59 };
        let known = hour < 24 && minute < 60 && second <= seconds_max;
        known.then_some(TimeOfDay(((hour * 60 + minute) * 60 + second) * 1000 + ms))
    }

    /// The contents of the field; `None` for a time beyond the end of the day.
    pub(super) fn text(self) -> Option<String> {
        let ms = Some(self.0).filter(|ms| *ms < DAY_MS + 1000)?;
        // A leap second extends the last minute.
        let (minute, ms) = if ms < DAY_MS {
            (ms / 60_000, ms % 60_000)
        } else {
            (1439, ms - DAY_MS + 60_000)
        };
        let clock = format!("{:02}{:02}{:02}", minute / 60, minute % 60, ms / 1000);
        Some(match ms % 1000 {
            ms if ms % 10 == 0 => format!("{clock}.{:02}", ms / 10),
            ms => format!("{clock}.{ms:03}"),
        })
    }

    /// Adds an interval, wrapping at midnight.
    pub fn later(self, by: SimTime) -> TimeOfDay {
        let ms = i64::from(self.0) + (by.as_s() * 1000.0).round() as i64;
        TimeOfDay(ms.rem_euclid(i64::from(DAY_MS)) as u32)
    }

    /// The time from `other` to this time, s, the shorter way around the clock; negative if this
    /// time is earlier.
    pub fn since_s(self, other: TimeOfDay) -> f64 {
        let day_s = f64::from(DAY_MS) * 1e-3;
        let apart_s = (f64::from(self.0) - f64::from(other.0)) * 1e-3;
        // Take the shorter way across midnight: without a date the day is unknown.
        apart_s - day_s * (apart_s / day_s).round()
    }
}

/// The date and time of day for a UTC time, ns since 1970.
pub fn date_and_time(utc_ns: u64) -> (Date, TimeOfDay) {
    let at = UtcDateTime::from_unix_timestamp_nanos(i128::from(utc_ns))
        .unwrap_or(UtcDateTime::UNIX_EPOCH);
    let date = Date {
        year: u16::try_from(at.year()).unwrap_or(0),
        month: u8::from(at.month()),
        day: at.day(),
    };
    (
        date,
        TimeOfDay((utc_ns / 1_000_000 % u64::from(DAY_MS)) as u32),
    )
}

/// A date of the Gregorian calendar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Date {
    /// The year, all four digits.
    pub year: u16,
    /// The month, 1 to 12.
    pub month: u8,
    /// The day, 1 to 31.
    pub day: u8,
}

impl Date {
    /// Parses a field `ddmmyy`; years 00 to 79 belong to this century.
    pub(super) fn parse(text: &str) -> Option<Date> {
        let [day, month, year] = pairs(text)?;
        // GPS began in 1980.
        let century = if year < 80 { 2000 } else { 1900 };
        Some(Date {
            year: century + u16::from(year),
            month,
            day,
        })
        .filter(|date| date.is_valid())
    }

    /// The contents of the field `ddmmyy`; `None` for a date that a two-digit year cannot express.
    pub(super) fn text(self) -> Option<String> {
        let known = self.is_valid() && (1980..2080).contains(&self.year);
        known.then(|| format!("{:02}{:02}{:02}", self.day, self.month, self.year % 100))
    }

    /// Whether the date exists in the calendar.
    pub fn is_valid(self) -> bool {
        self.in_calendar().is_some()
    }

    /// The days from `other` to this date; negative if this date is earlier.
    pub fn days_since(self, other: Date) -> i64 {
        let day = |date: Date| {
            date.in_calendar()
                .map_or(0, |date| i64::from(date.to_julian_day()))
        };
        day(self) - day(other)
    }

    fn in_calendar(self) -> Option<time::Date> {
        let month = Month::try_from(self.month).ok()?;
        time::Date::from_calendar_date(i32::from(self.year), month, self.day).ok()
    }
}

/// Three numbers of two digits each.
fn pairs(text: &str) -> Option<[u8; 3]> {
    let digits = <[u8; 6]>::try_from(text.as_bytes())
        .ok()
        .filter(|digits| digits.iter().all(u8::is_ascii_digit))?;
    let pair = |i: usize| (digits[i] - b'0') * 10 + digits[i + 1] - b'0';
    Some([pair(0), pair(2), pair(4)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_day_go_round_the_clock() {
        let evening = TimeOfDay(86_399_500);
        let morning = TimeOfDay(700);
        assert_eq!(evening.later(SimTime::from_s(1.2)), morning);
        assert_eq!(morning.later(SimTime::from_s(-1.2)), evening);
        assert!(
            (morning.since_s(evening) - 1.2).abs() < 1e-9
                && (evening.since_s(morning) + 1.2).abs() < 1e-9
        );
    }

    #[test]
    fn february_has_29_days_every_fourth_year_but_for_three_centuries_in_four() {
        for (year, month, day, valid) in [
            (2024, 2, 29, true),
            (2026, 2, 29, false),
            (2000, 2, 29, true),
            (2100, 2, 29, false),
            (2026, 4, 31, false),
            (2026, 12, 31, true),
            (2026, 13, 1, false),
            (2026, 0, 1, false),
            (2026, 1, 0, false),
        ] {
            assert_eq!(
                Date { year, month, day }.is_valid(),
                valid,
                "{year}-{month}-{day}"
            );
        }
    }
}
