//! Logs of NMEA 0183 sentences. The time of a sentence is its time of receipt, if the line begins
//! with one. Otherwise it is the time in the newest sentence that contains one.

use crate::csv::time_of;
use crate::{Found, ImportError, Quantity, bytes_of};
use gateway::nmea::{Date, FixQuality, Framer, M_S_PER_KN, Mode, Sentence, TimeOfDay};
use primitives::math::sin_cos_deg;
use std::path::Path;

/// The first day of UNIX time.
const UNIX_EPOCH: Date = Date {
    year: 1970,
    month: 1,
    day: 1,
};
const DAY_S: f64 = 86_400.0;

pub(crate) fn read(path: &Path, boat: &str) -> Result<Found, ImportError> {
    let bytes = bytes_of(path)?;
    let mut found = Found::default();
    let mut sentences = Sentences::new(boat);
    let mut has_receiver_times = true;
    for line in bytes.split_inclusive(|byte| *byte == b'\n') {
        let Some(start) = line.iter().position(|byte| *byte == b'$') else {
            continue;
        };
        let text = String::from_utf8_lossy(&line[..start]);
        let text = text.trim_matches(|c: char| c.is_whitespace() || ",;:[]<>\"".contains(c));
        let receiver_s = time_of(text);
        has_receiver_times &= receiver_s.is_some();
        sentences.push(&mut found, receiver_s, &line[start..]);
    }
    // Times of receipt may also count from the logger's start.
    found.has_utc = has_receiver_times && sentences.is_utc;
    if !has_receiver_times && let Some(midnight_s) = sentences.midnight_s {
        found.logs.shift(midnight_s);
        found.positions.shift(midnight_s);
        found.has_utc = true;
    }
    if let Some(rejected) = sentences.framer.rejected() {
        let counts = sentences.framer.counts();
        let note = format!(
            "{} sentences rejected; the last, {:?}: {}",
            counts.bad_checksum + counts.overlong + counts.broken,
            rejected.line,
            rejected.why
        );
        found.notes.push(note);
    }
    if !found.has_utc {
        found
            .notes
            .push("no date found; times are not in UTC".to_owned());
    }
    if sentences.is_magnetic {
        let note = "magnetic headings without variation are used as true headings";
        found.notes.push(note.to_owned());
    }
    Ok(found)
}

/// Reads the sentences of one boat in order.
pub(crate) struct Sentences {
    boat: String,
    framer: Framer,
    /// The newest time of day in a sentence, and the corresponding time in the log, s.
    last: Option<(TimeOfDay, f64)>,
    /// UNIX time of the midnight from which times in the log count, s; `None` until a date is
    /// known.
    midnight_s: Option<f64>,
    is_magnetic: bool,
    is_utc: bool,
}

impl Sentences {
    pub(crate) fn new(boat: &str) -> Sentences {
        Sentences {
            boat: boat.to_owned(),
            framer: Framer::new(),
            last: None,
            midnight_s: None,
            is_magnetic: false,
            is_utc: true,
        }
    }

    /// Adds bytes, with the time of their receipt if it is known.
    pub(crate) fn push(&mut self, found: &mut Found, receiver_s: Option<f64>, bytes: &[u8]) {
        let mut parsed = vec![];
        self.framer
            .push(bytes, &mut |body| parsed.extend(Sentence::parse(body)));
        for sentence in parsed {
            self.is_utc &= receiver_s.is_none_or(|at_s| at_s > 1e8);
            if let Some(at_s) = receiver_s.or_else(|| self.time(&sentence)) {
                self.add(found, at_s, sentence);
            }
        }
    }

    /// The time in a sentence, or else in the newest sentence with a time, s.
    fn time(&mut self, sentence: &Sentence) -> Option<f64> {
        let (time, date) = match sentence {
            Sentence::Rmc(rmc) => (rmc.time, rmc.date),
            Sentence::Zda(zda) => (zda.time, zda.date),
            Sentence::Gga(gga) => (gga.time, None),
            _ => (None, None),
        };
        if let Some(time) = time {
            let of_day_s = 1e-3 * f64::from(time.0);
            let at_s = self.last.map_or(of_day_s, |(before, before_s)| {
                before_s + time.since_s(before)
            });
            self.last = Some((time, at_s));
            if let (Some(date), None) = (date, self.midnight_s) {
                let days = date.days_since(UNIX_EPOCH) as f64;
                self.midnight_s = Some(DAY_S * days + of_day_s - at_s);
            }
        }
        self.last.map(|(_, at_s)| at_s)
    }

    fn add(&mut self, found: &mut Found, at_s: f64, sentence: Sentence) {
        let boat = self.boat.as_str();
        let logs = &mut found.logs;
        let mut push = |quantity, source, value: Option<f64>| {
            if let Some(value) = value.filter(|value| value.is_finite()) {
                logs.push(boat, quantity, source, (at_s, value));
            }
        };
        match sentence {
            Sentence::Gga(gga) if FixQuality::from_gga(gga.quality).is_fix() => {
                push(Quantity::Height, 0, gga.altitude_m);
                if let Some(at) = gga.at {
                    found.positions.push(boat, 0, at_s, at);
                }
            }
            Sentence::Rmc(rmc) if rmc.valid => {
                if let Some(at) = rmc.at {
                    found.positions.push(boat, 1, at_s, at);
                }
                let [north, east] = velocity(rmc.speed_kn, rmc.course_deg);
                push(Quantity::North, 1, north);
                push(Quantity::East, 1, east);
            }
            Sentence::Vtg(vtg) => {
                let [north, east] = velocity(vtg.speed_kn, vtg.course_true_deg);
                push(Quantity::North, 0, north);
                push(Quantity::East, 0, east);
            }
            Sentence::Hdt(hdt) => push(Quantity::Heading, 0, hdt.heading_deg),
            Sentence::Hdg(hdg) => {
                self.is_magnetic |= hdg.variation_deg.is_none();
                let east_deg = hdg.deviation_deg.unwrap_or(0.0) + hdg.variation_deg.unwrap_or(0.0);
                push(
                    Quantity::Heading,
                    1,
                    hdg.heading_deg.map(|deg| deg + east_deg),
                );
            }
            Sentence::Attitude(attitude) => {
                self.is_magnetic |= attitude.heading_deg.is_some();
                push(Quantity::Heading, 2, attitude.heading_deg);
                push(Quantity::YawRate, 0, attitude.yaw_rate_deg_s);
            }
            Sentence::Command(command) => {
                let sides = match command.mode {
                    Mode::Thruster => command.thrust.zip(command.difference),
                    mode if mode.is_set_point() => None,
                    // Standby and station keeping: the back seat commands no thrust.
                    _ => Some((0.0, 0.0)),
                };
                push(Quantity::Port, 0, sides.map(|(thrust, half)| thrust + half));
                push(
                    Quantity::Starboard,
                    0,
                    sides.map(|(thrust, half)| thrust - half),
                );
            }
            _ => {}
        }
    }
}

/// Velocity north and east, m/s. At rest, it is zero even without a course.
fn velocity(speed_kn: Option<f64>, course_deg: Option<f64>) -> [Option<f64>; 2] {
    let course_deg = course_deg.or(speed_kn.filter(|kn| *kn == 0.0));
    match speed_kn.zip(course_deg) {
        Some((kn, deg)) => {
            let (sin, cos) = sin_cos_deg(deg);
            [Some(M_S_PER_KN * kn * cos), Some(M_S_PER_KN * kn * sin)]
        }
        None => [None, None],
    }
}
