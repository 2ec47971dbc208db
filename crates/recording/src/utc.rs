//! UTC: the host's clock as a string, for stamps and names only. No decision of a game or gateway
//! depends on it.

use time::UtcDateTime;

/// Three-letter abbreviations of the weekdays from Monday on, and of the months.
const DAYS: [&str; 7] = ["Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun"];
const MONTHS: [&str; 12] = [
    "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
];

/// The current time, ns since 1970; 0 if the host's clock is earlier than that.
pub fn now_ns() -> u64 {
    u64::try_from(UtcDateTime::now().unix_timestamp_nanos()).unwrap_or(0)
}

/// Year, month, day, and hour, minute, second.
fn parts(utc_ns: u64) -> (UtcDateTime, [u32; 6]) {
    let at = UtcDateTime::from_unix_timestamp_nanos(i128::from(utc_ns))
        .unwrap_or(UtcDateTime::UNIX_EPOCH);
    let year = u32::try_from(at.year()).unwrap_or(0);
    (
        at,
        [
            year,
            u8::from(at.month()).into(),
            at.day().into(),
            at.hour().into(),
            at.minute().into(),
            at.second().into(),
        ],
    )
}

/// Format for file names: `20261121T222000Z`.
pub fn file_stamp(utc_ns: u64) -> String {
    let (_, [year, month, day, hour, minute, second]) = parts(utc_ns);
    format!("{year:04}{month:02}{day:02}T{hour:02}{minute:02}{second:02}Z")
}

/// Format for display: `2026-11-21 22:20:00 UTC`.
pub fn text(utc_ns: u64) -> String {
    let (_, [year, month, day, hour, minute, second]) = parts(utc_ns);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

/// Format of C's `ctime`: `Sat Nov 21 22:20:00 2026`.
pub fn ctime(utc_ns: u64) -> String {
    let (at, [year, month, day, hour, minute, second]) = parts(utc_ns);
    let weekday = DAYS[usize::from(at.weekday().number_days_from_monday())];
    let month = MONTHS[month as usize - 1];
    format!("{weekday} {month} {day:>2} {hour:02}:{minute:02}:{second:02} {year}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_its_date() {
        for (utc_s, want, want_ctime, want_stamp) in [
            (
                0,
                "1970-01-01 00:00:00 UTC",
                "Thu Jan  1 00:00:00 1970",
                "19700101T000000Z",
            ),
            (
                1_700_000_000,
                "2023-11-14 22:13:20 UTC",
                "Tue Nov 14 22:13:20 2023",
                "20231114T221320Z",
            ),
            (
                1_709_164_800,
                "2024-02-29 00:00:00 UTC",
                "Thu Feb 29 00:00:00 2024",
                "20240229T000000Z",
            ),
        ] {
            let utc_ns = utc_s * 1_000_000_000;
            assert_eq!(
                [text(utc_ns), ctime(utc_ns), file_stamp(utc_ns)],
                [want, want_ctime, want_stamp]
            );
        }
    }
}
