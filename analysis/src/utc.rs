//! Moments of the day as texts, UTC.

use time::UtcDateTime;

/// The first three letters of weekdays from Monday on, and of months.
const DAYS: [&str; 7] = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
const MONTHS: [&str; 12] = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

fn moment(utc_ns: u64) -> UtcDateTime {
    UtcDateTime::from_unix_timestamp_nanos(i128::from(utc_ns)).unwrap_or(UtcDateTime::UNIX_EPOCH)
}

/// For people: `2026-11-21 22:20:00 UTC`.
#[must_use]
pub fn text(utc_ns: u64) -> String {
    let at = moment(utc_ns);
    let (year, month, day) = (at.year(), u8::from(at.month()), at.day());
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02} UTC", at.hour(), at.minute(), at.second())
}

/// As C's `ctime` has it: `Sat Nov 21 22:20:00 2026`.
#[must_use]
pub fn ctime(utc_ns: u64) -> String {
    let at = moment(utc_ns);
    let day = DAYS[usize::from(at.weekday().number_days_from_monday())];
    let month = MONTHS[usize::from(u8::from(at.month())) - 1];
    let (of_month, year) = (at.day(), at.year());
    format!("{day} {month} {of_month:>2} {:02}:{:02}:{:02} {year}", at.hour(), at.minute(), at.second())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moment_has_its_date() {
        for (utc_s, want, want_ctime) in [
            (0, "1970-01-01 00:00:00 UTC", "Thu Jan  1 00:00:00 1970"),
            (1_700_000_000, "2023-11-14 22:13:20 UTC", "Tue Nov 14 22:13:20 2023"),
            (1_709_164_800, "2024-02-29 00:00:00 UTC", "Thu Feb 29 00:00:00 2024"),
        ] {
            let utc_ns = utc_s * 1_000_000_000;
            assert_eq!((text(utc_ns).as_str(), ctime(utc_ns).as_str()), (want, want_ctime));
        }
    }
}
