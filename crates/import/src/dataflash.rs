//! ArduPilot's on-board logs (`.bin`). Times count from boot; they are converted to UTC if the GPS
//! provides it.

use crate::servo::Servos;
use crate::{Found, ImportError, Quantity, file_error};
use ardupilot_binlog::{Entry, Reader};
use primitives::LatLon;
use primitives::math::sin_cos_deg;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Start of GPS time (6 January 1980) as UNIX time, s, and the leap seconds since then.
const GPS_EPOCH_S: f64 = 315_964_800.0;
const LEAP_S: f64 = 18.0;
const WEEK_S: f64 = 604_800.0;

/// A file that records whether it was read to its end.
struct Watched {
    file: File,
    is_at_end: bool,
}

impl Read for Watched {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let length = self.file.read(buffer)?;
        self.is_at_end |= length == 0 && !buffer.is_empty();
        Ok(length)
    }
}

/// Reads a log of one boat.
pub(crate) fn read(path: &Path, boat: &str) -> Result<Found, ImportError> {
    let file = primitives::input_file::open(path).map_err(|error| file_error(path, error))?;
    let mut watched = Watched {
        file,
        is_at_end: false,
    };
    let mut log = Log {
        boat,
        found: Found::default(),
        servos: Servos::default(),
        utc_offset_s: None,
    };
    for entry in &mut Reader::new(&mut watched) {
        log.add(&entry.map_err(|error| file_error(path, error))?);
    }
    let Log {
        mut found,
        servos,
        utc_offset_s,
        ..
    } = log;
    let offset_s = utc_offset_s.unwrap_or(0.0);
    found.has_utc = utc_offset_s.is_some();
    found.logs.shift(offset_s);
    found.positions.shift(offset_s);
    if !watched.is_at_end {
        found
            .notes
            .push("damaged: the rest of the log cannot be read".to_owned());
    }
    if !found.has_utc {
        let note = "the GPS provided no time; times count from boot";
        found.notes.push(note.to_owned());
    }
    if found.logs.series(boat, Quantity::Port).is_some() && !servos.are_known() {
        found.notes.push(Servos::UNKNOWN.to_owned());
    }
    Ok(found)
}

struct Log<'a> {
    boat: &'a str,
    found: Found,
    servos: Servos,
    /// UNIX time at boot, s; `None` until the GPS has provided it.
    utc_offset_s: Option<f64>,
}

impl Log<'_> {
    fn add(&mut self, entry: &Entry) {
        if entry.name == "PARM" {
            let name = entry.get_str("Name");
            if let Some((name, value)) = name.zip(entry.get_f64("Value")) {
                self.servos.set(name, value);
            }
            return;
        }
        let Some(at_us) = entry.timestamp_usec else {
            return;
        };
        let at_s = 1e-6 * at_us as f64;
        let number = |name: &str| {
            entry
                .get_f64(name)
                .filter(|number: &f64| number.is_finite())
        };
        // Of several sensors or filters, use the first.
        let is_first = ["I", "C"]
            .iter()
            .all(|key| number(key).is_none_or(|number| number == 0.0));
        if !is_first {
            return;
        }
        let position = number("Lat").zip(number("Lng"));
        let position = position.map(|(lat, lon)| LatLon {
            lat_deg: 1e-7 * lat,
            lon_deg: 1e-7 * lon,
        });
        let mut push = |quantity, source, value: Option<f64>| {
            if let Some(value) = value {
                let logs = &mut self.found.logs;
                logs.push(self.boat, quantity, source, (at_s, value));
            }
        };
        match entry.name.as_str() {
            "POS" => {
                if let Some(at) = position {
                    self.found.positions.push(self.boat, 0, at_s, at);
                }
            }
            // Status 3: a 3D fix.
            "GPS" if number("Status").is_some_and(|status| status >= 3.0) => {
                push(Quantity::Height, 0, number("Alt"));
                if let Some(at) = position {
                    self.found.positions.push(self.boat, 1, at_s, at);
                }
                if let Some((speed, course_deg)) = number("Spd").zip(number("GCrs")) {
                    let (sin, cos) = sin_cos_deg(course_deg);
                    push(Quantity::North, 1, Some(speed * cos));
                    push(Quantity::East, 1, Some(speed * sin));
                }
                if let (Some(week), Some(ms), None) =
                    (number("GWk"), number("GMS"), self.utc_offset_s)
                {
                    let utc_s = GPS_EPOCH_S + WEEK_S * week + 1e-3 * ms - LEAP_S;
                    self.utc_offset_s = (week > 0.0).then_some(utc_s - at_s);
                }
            }
            "XKF1" => {
                push(Quantity::North, 0, number("VN"));
                push(Quantity::East, 0, number("VE"));
            }
            "ATT" => push(Quantity::Heading, 0, number("Yaw")),
            "IMU" => push(Quantity::YawRate, 0, number("GyrZ").map(f64::to_degrees)),
            "RCOU" => {
                let outputs = (1..=16).map(|n| number(&format!("C{n}")).map_or(0, |us| us as u16));
                let outputs: Vec<u16> = outputs.collect();
                if let Some([port, starboard]) = self.servos.thrusts_pct(&outputs) {
                    push(Quantity::Port, 0, Some(port));
                    push(Quantity::Starboard, 0, Some(starboard));
                }
            }
            _ => {}
        }
    }
}
