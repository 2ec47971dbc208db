//! UTC by the host's clock: for time stamps of recordings, file names, and the date of the declination. No decision depends on it.

use crate::nmea::{Date, TimeOfDay};
use time::UtcDateTime;

/// Now, ns since 1970; 0 if the host's clock is before.
#[must_use]
pub fn now_ns() -> u64 {
    u64::try_from(UtcDateTime::now().unix_timestamp_nanos()).unwrap_or(0)
}

/// The date and time of day.
#[must_use]
pub fn now() -> (Date, TimeOfDay) {
    let now = UtcDateTime::now();
    let date = Date { year: u16::try_from(now.year()).unwrap_or(0), month: u8::from(now.month()), day: now.day() };
    let seconds = (u32::from(now.hour()) * 60 + u32::from(now.minute())) * 60 + u32::from(now.second());
    (date, TimeOfDay(seconds * 1000 + u32::from(now.millisecond())))
}

/// Now as part of a file's name: `20261120T150502Z`.
#[must_use]
pub fn name() -> String {
    let now = UtcDateTime::now();
    format!(
        "{:04}{:02}{:02}T{:02}{:02}{:02}Z",
        now.year(),
        u8::from(now.month()),
        now.day(),
        now.hour(),
        now.minute(),
        now.second()
    )
}
