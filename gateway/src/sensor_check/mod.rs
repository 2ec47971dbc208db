//! The sensor check before arming: what a boat sends, how often, who commands it, and what is
//! missing.

mod need;
#[cfg(test)]
mod tests;

use crate::config::{BoatProtocol, Gateway};
use crate::mavlink;
use crate::mavlink::dialect::{HEARTBEAT_DATA, MavMessage};
use crate::nav_estimate::HEADINGS_DEG;
use crate::nmea::{
    self, Date, FixQuality, Mode, Operator, ParseError, Sentence, TimeOfDay, date_and_time,
};
use crate::protocol::{ControlReport, Fix, Heading, North, Power, Protocol, Report};
use ::mavlink::Message;
use need::Usable;
use primitives::SimTime;
use primitives::angle::{compass_deg_from_rad, wrap_pi};
use primitives::frame::LatLon;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum difference (rad) at which compass and true heading count as equal.
const SAME_HEADING_RAD: f64 = 0.02;
/// Minimum speed (m/s) at which the course indicates the heading.
const COURSE_MIN_M_S: f64 = 1.0;
/// Maximum number of positions stored.
const FIXES_MAX: usize = 20_000;
/// Maximum number of names counted.
const NAMES_MAX: usize = 64;
/// Maximum number of vehicles listed if none of them is the boat.
const HEARD_MAX: usize = 8;

/// Allowed error of the boat's clock relative to this machine's, s: fixes arrive shortly after the
/// time stated in them.
// An offset of half a minute is not latency: one of the clocks is wrong, and recordings cannot be
// compared.
const CLOCK_BEHIND_S: std::ops::RangeInclusive<f64> = -1.0..=5.0;
/// The days in 1024 weeks, less one for the time of day.
const GPS_WEEKS_DAYS: i64 = 7167;

/// A moment by both the check's clock and the host's clock. Reading them at different times would
/// look like a fault of the boat's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostTime {
    /// The moment, by the check's clock.
    pub now: SimTime,
    /// The same moment by the host's clock, UTC in ns since 1970.
    pub utc_ns: u64,
}

impl HostTime {
    /// The host's time at an earlier moment.
    fn utc_ns_at(self, came: SimTime) -> u64 {
        self.utc_ns
            .saturating_add_signed(came.0.saturating_sub(self.now.0))
    }
}

/// The received sentences or messages with the same name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Received {
    /// The number received.
    pub count: u64,
    /// The number of unreadable ones; all of them if the name is unknown.
    pub unreadable: u64,
    /// Why the first unreadable one could not be read, unless its name is unknown.
    pub why_unreadable: Option<String>,
    /// When the first and the last one arrived.
    pub between: Option<(SimTime, SimTime)>,
    /// The last one: a sentence as received, or the fields of a message.
    pub last: String,
}

impl Received {
    /// The rate, 1/s.
    pub fn rate_hz(&self) -> Option<f64> {
        let (first, last) = self.between?;
        let span_s = (last - first).as_s();
        // Count intervals, not messages: there is one interval between two messages.
        (span_s > 0.0).then(|| (self.count - 1) as f64 / span_s)
    }

    fn note(&mut self, now: SimTime) {
        self.count += 1;
        let first = self.between.map_or(now, |(first, _)| first);
        self.between = Some((first, now));
    }
}

/// Splits a boat's data into named sentences or messages.
#[derive(Clone, Debug)]
enum Framer {
    Nmea(Box<nmea::Framer>),
    Mavlink(mavlink::Framer),
}

/// The data that a boat has sent so far.
#[derive(Clone, Debug)]
pub struct SensorCheck {
    framer: Framer,
    /// The received data by name.
    pub received: BTreeMap<String, Received>,
    /// Number of bytes received.
    bytes: usize,
    /// Whether lines of the received bytes begin like NMEA sentences.
    has_sentences: bool,
    /// The data that the gateway could use.
    usable: BTreeMap<Usable, Received>,
    /// The MAVLink vehicles whose heartbeats were received, as strings.
    heard: BTreeSet<String>,
    protocol: Protocol,
    /// The last fix with a reported quality.
    pub(crate) fix: Option<Fix>,
    /// The receiver's time of the last position.
    time_of_position: Option<TimeOfDay>,
    /// The positions so far, with their arrival times.
    pub fixes: Vec<(SimTime, LatLon)>,
    /// Course and speed over the ground, degrees and m/s.
    track: Option<(f64, f64)>,
    /// The boat's time of day, and when it arrived.
    clock: Option<(SimTime, TimeOfDay)>,
    /// The boat's date, and when it arrived.
    date: Option<(SimTime, Date)>,
    /// Compass heading, degrees.
    pub compass_deg: Option<f64>,
    true_deg: Option<f64>,
    /// Mode, operator and thrust.
    pub control: Option<ControlReport>,
    /// The battery and its loads.
    pub(crate) power: Power,
    /// The fault that the boat reports, if any.
    pub(crate) error: Option<String>,
}

impl SensorCheck {
    /// An empty check for a boat with this protocol.
    pub fn new(gateway: &Gateway) -> SensorCheck {
        let framer = match gateway.protocol {
            BoatProtocol::Surveyor => Framer::Nmea(Box::default()),
            BoatProtocol::Mavlink => Framer::Mavlink(mavlink::Framer::default()),
        };
        SensorCheck {
            framer,
            received: BTreeMap::new(),
            bytes: 0,
            has_sentences: false,
            usable: BTreeMap::new(),
            heard: BTreeSet::new(),
            protocol: Protocol::new(gateway),
            fix: None,
            time_of_position: None,
            fixes: vec![],
            track: None,
            clock: None,
            date: None,
            compass_deg: None,
            true_deg: None,
            control: None,
            power: Power::default(),
            error: None,
        }
    }

    /// Accepts bytes, however they are split.
    pub fn receive(&mut self, now: SimTime, bytes: &[u8]) {
        // A separate framer counts by name. The reports come from the gateway's own codec, so that
        // the check judges the data that the gateway would use.
        self.bytes += bytes.len();
        self.has_sentences |=
            bytes.starts_with(b"$") || bytes.windows(3).any(|part| part == b"\r\n$");
        self.count(now, bytes);
        let mut reports = vec![];
        self.protocol
            .read(now, bytes, &mut |report| reports.push(report));
        reports
            .into_iter()
            .for_each(|report| self.apply(now, report));
    }

    /// Appends the requests that make a boat send data: none for a Surveyor; for MAVLink, its
    /// telemetry.
    pub fn write_questions(&mut self, now: SimTime, out: &mut Vec<u8>) {
        self.protocol.keep_up(now, out);
    }

    /// The counters of the link by name.
    pub fn counts(&self) -> Vec<(String, u64)> {
        let [known, _] = self.protocol.counts();
        known
    }

    /// A true heading for comparison, degrees: as reported, or the course if the boat makes way.
    pub fn true_deg(&self) -> Option<f64> {
        let course = || {
            self.track
                .filter(|(_, speed_m_s)| *speed_m_s >= COURSE_MIN_M_S)
                .map(|(course_deg, _)| course_deg)
        };
        self.true_deg.or_else(course)
    }

    /// The heading that the gateway would use, degrees.
    pub(crate) fn heading_deg(&self) -> Option<f64> {
        self.compass_deg.or(self.true_deg)
    }

    /// How far the boat's clock is behind the host's, s.
    pub(crate) fn clock_behind_s(&self, host: HostTime) -> Option<f64> {
        self.clock
            .map(|(came, time)| date_and_time(host.utc_ns_at(came)).1.since_s(time))
    }

    /// The fault of the boat's clock or date, or of the host's, if any.
    pub fn clock_fault(&self, host: HostTime) -> Option<String> {
        let off = self
            .clock_behind_s(host)
            .filter(|behind_s| !CLOCK_BEHIND_S.contains(behind_s));
        let days = self.date.map_or(0, |(came, date)| {
            let at = host.utc_ns_at(came);
            let ns = |s: f64| (s * 1e9) as u64;
            // Around midnight a fix may have the previous day's date.
            let about = [
                at.saturating_sub(ns(*CLOCK_BEHIND_S.end())),
                at + ns(-CLOCK_BEHIND_S.start()),
            ];
            if about.iter().any(|at| date_and_time(*at).0 == date) {
                0
            } else {
                date_and_time(at).0.days_since(date)
            }
        });
        if days != 0 {
            // A receiver counts weeks modulo 1024: after a rollover, its date is wrong by this
            // much.
            let rollover = if days >= GPS_WEEKS_DAYS {
                ", as after a GPS week rollover (7168 days)"
            } else {
                ""
            };
            let (days, side) = (days.abs(), side(days < 0));
            let unit = if days == 1 { "day" } else { "days" };
            return Some(format!(
                "the date is {days} {unit} {side} this host's{rollover}: one of the two is wrong"
            ));
        }
        off.map(|behind_s| format!("{}: one of the two is wrong", fixes_in_words(behind_s)))
    }

    /// The boat's reports as strings.
    pub fn findings(&self, host: HostTime) -> Vec<String> {
        let mut found = Vec::new();
        if let Some(Fix {
            at,
            quality: Some(quality),
            hdop,
            ..
        }) = self.fix
        {
            let place = at.map_or("no position".to_owned(), |at| {
                format!("{:.6}, {:.6}", at.lat_deg, at.lon_deg)
            });
            let hdop = hdop.map_or(String::new(), |hdop| format!(", dilution {hdop}"));
            found.push(format!("position: {place}, fix quality {quality}{hdop}"));
        }
        found.extend(self.heading());
        if let Some(ControlReport { shown, operator }) = &self.control {
            let who = operator.map_or(
                "it does not report who commands it".to_owned(),
                |operator| format!("commanded by {operator:?}"),
            );
            found.push(format!(
                "control: mode {}, {who}",
                self.mode_in_words(shown.mode)
            ));
        }
        found.extend(self.power.volts.map(|volts| format!("battery: {volts} V")));
        found.extend(self.error.as_ref().map(|error| format!("error: {error}")));
        if let Some(behind_s) = self.clock_behind_s(host) {
            let date = self.date.map_or("it sends no date".to_owned(), |(_, d)| {
                format!("date {}-{:02}-{:02}", d.year, d.month, d.day)
            });
            found.push(format!("clock: {}; {date}", fixes_in_words(behind_s)));
        }
        found.extend(
            self.clock_fault(host)
                .map(|fault| format!("clock: {fault}")),
        );
        found.extend(self.rejected());
        found
    }

    /// The name of a mode, with its letter if it has one.
    pub(crate) fn mode_in_words(&self, mode: Mode) -> String {
        match self.framer {
            Framer::Nmea(_) => format!("{} ({mode:?})", mode.letter()),
            Framer::Mavlink(_) => format!("{mode:?}"),
        }
    }

    /// The headings as a string.
    pub(crate) fn heading(&self) -> Option<String> {
        let Some(compass_deg) = self.compass_deg else {
            return self
                .true_deg
                .map(|true_deg| format!("heading: {true_deg:.1} true"));
        };
        Some(match self.true_deg {
            None => format!(
                "heading: {compass_deg:.1} by its compass; no true heading to compare it with"
            ),
            Some(true_deg) => {
                let apart_rad = wrap_pi((true_deg - compass_deg).to_radians());
                let frame = if apart_rad.abs() < SAME_HEADING_RAD {
                    "its compass is relative to true north"
                } else {
                    "its compass is relative to magnetic north"
                };
                format!("heading: {compass_deg:.1} by its compass, {true_deg:.1} true: {frame}")
            }
        })
    }

    /// Descriptions of the data that is missing for driving the boat.
    pub fn missing(&self) -> Vec<String> {
        let mut missing = self.unmet();
        if let Some(operator) = self.control.as_ref().and_then(|control| control.operator)
            // All data may be present, but a boat under other control follows nothing that we send.
            && operator != Operator::Secondary
        {
            missing.push(match self.framer {
                Framer::Nmea(_) => {
                    "secondary control: the operator ashore must enable it".to_owned()
                }
                Framer::Mavlink(_) => {
                    format!(
                        "control: {operator:?} has control, and the mode is neither GUIDED nor HOLD"
                    )
                }
            });
        }
        let no_fix = self.no_fix();
        missing.extend(no_fix.map(|quality| format!("a position: its fix has quality {quality}")));
        missing
    }

    /// The quality of the last fix if it means no fix: a receiver without a fix still sends its
    /// sentences at the full rate.
    fn no_fix(&self) -> Option<FixQuality> {
        let Fix { at, quality, .. } = self.fix?;
        quality.filter(|quality| at.is_none() || !quality.is_fix())
    }

    /// A description of the received data if none of it could be read, with the reason.
    pub fn unread(&self) -> String {
        let lines = match &self.framer {
            Framer::Nmea(framer) => framer.rejected().map(|last| {
                let nmea::Counts { bad_checksum, overlong, broken, .. } = framer.counts();
                let count = bad_checksum + overlong + broken;
                format!("received {count} lines, none of them a valid sentence: {} {}", last.line, last.why)
            }),
            Framer::Mavlink(_) => self.has_sentences.then(|| {
                format!("received {} bytes of NMEA sentences, expected MAVLink: choose the boat's --config", self.bytes)
            }),
        };
        match lines {
            Some(lines) => lines,
            None if self.bytes == 0 => "received nothing".to_owned(),
            None => {
                format!(
                    "received {} bytes, none of them readable: check the protocol and the baud rate",
                    self.bytes
                )
            }
        }
    }

    /// The last rejected line, if any, with the reason.
    fn rejected(&self) -> Option<String> {
        let Framer::Nmea(framer) = &self.framer else {
            return None;
        };
        framer
            .rejected()
            .map(|last| format!("rejected: {} {}", last.line, last.why))
    }

    /// Counts sentences or messages by name.
    fn count(&mut self, now: SimTime, bytes: &[u8]) {
        let SensorCheck {
            framer,
            received,
            date,
            heard,
            ..
        } = self;
        match framer {
            Framer::Nmea(framer) => framer.push(bytes, &mut |body| {
                let sentence = Sentence::parse(body);
                let name = body.split(',').next().unwrap_or_default();
                note(
                    received,
                    now,
                    name,
                    (body.to_owned(), sentence.as_ref().err()),
                );
                let sent = match sentence {
                    Ok(Sentence::Rmc(rmc)) => rmc.date,
                    Ok(Sentence::Zda(zda)) => zda.date,
                    _ => None,
                };
                *date = sent.map(|date| (now, date)).or(*date);
            }),
            Framer::Mavlink(framer) => {
                framer.push(bytes, &mut |mavlink::Received {
                                             system, message, ..
                                         }| {
                    note(
                        received,
                        now,
                        message.message_name(),
                        (mavlink::message_text(&message), None),
                    );
                    match &message {
                        MavMessage::SYSTEM_TIME(time) if time.time_unix_usec > 0 => {
                            *date = Some((
                                now,
                                date_and_time(time.time_unix_usec.saturating_mul(1000)).0,
                            ));
                        }
                        MavMessage::HEARTBEAT(heartbeat) if heard.len() < HEARD_MAX => {
                            heard.insert(vehicle_in_words(system, heartbeat));
                        }
                        _ => {}
                    }
                })
            }
        }
    }

    /// Records data that the gateway can use.
    fn note_usable(&mut self, now: SimTime, report: &Report) {
        let usable = match report {
            Report::Fix(Fix {
                time, at: Some(at), ..
            }) if (at.lat_deg, at.lon_deg) != (0.0, 0.0) => {
                let is_new = time.is_none() || *time != self.time_of_position;
                self.time_of_position = *time;
                is_new.then_some(Usable::Position)
            }
            Report::Velocity(_) => Some(Usable::Velocity),
            Report::Heading(heading) => HEADINGS_DEG
                .contains(&heading.deg)
                .then_some(Usable::Heading),
            Report::Control(_) => Some(Usable::Control),
            Report::Power(power) => power.volts.map(|_| Usable::Voltage),
            _ => None,
        };
        let is_fix =
            matches!(report, Report::Fix(Fix { quality: Some(quality), .. }) if quality.is_fix());
        for usable in usable.into_iter().chain(is_fix.then_some(Usable::Quality)) {
            self.usable.entry(usable).or_default().note(now);
        }
    }

    fn apply(&mut self, now: SimTime, report: Report) {
        self.note_usable(now, &report);
        match report {
            // RMC reports no quality, only whether there is a fix.
            Report::Fix(fix) if fix.quality.is_some() => {
                if let Some(at) = fix.at
                    && fix.quality.is_some_and(FixQuality::is_fix)
                    // Keep the first ones: the scatter is judged over the time from the first to
                    // the last.
                    && self.fixes.len() < FIXES_MAX
                {
                    self.fixes.push((now, at));
                }
                self.fix = Some(fix);
            }
            Report::Clock(time) => self.clock = Some((now, time)),
            Report::Velocity(velocity) => {
                let course_deg = compass_deg_from_rad(velocity.direction_rad());
                self.track = Some((course_deg, velocity.length()));
            }
            Report::Heading(Heading {
                deg,
                north: North::Compass,
                ..
            }) => self.compass_deg = Some(deg),
            Report::Heading(Heading {
                deg,
                north: North::True,
                ..
            }) => self.true_deg = Some(deg),
            Report::Control(control) => self.control = Some(control),
            Report::Power(power) => {
                self.power = Power {
                    volts: power.volts.or(self.power.volts),
                    ..power
                }
            }
            Report::Error(error) => self.error = error,
            Report::Notice(text) => self.error = Some(text),
            Report::Fix(_)
            | Report::Tilt(_)
            | Report::Home(_)
            | Report::ForeignOrder
            | Report::Station(_) => {}
        }
    }
}

fn side(is_ahead: bool) -> &'static str {
    if is_ahead { "AHEAD of" } else { "behind" }
}

fn fixes_in_words(behind_s: f64) -> String {
    format!(
        "fixes are {:.2} s {} this host's clock",
        behind_s.abs(),
        side(behind_s < 0.0)
    )
}

/// Records received data: the message, and why it could not be read.
fn note(
    received: &mut BTreeMap<String, Received>,
    now: SimTime,
    name: &str,
    (text, error): (String, Option<&ParseError>),
) {
    let room = received.len() < NAMES_MAX || received.contains_key(name);
    let received = received
        .entry(if room { name } else { "others" }.to_owned())
        .or_default();
    received.note(now);
    received.unreadable += u64::from(error.is_some());
    if let (None, Some(error @ (ParseError::Field { .. } | ParseError::TooFew { .. }))) =
        (&received.why_unreadable, error)
    {
        received.why_unreadable = Some(error.to_string());
    }
    received.last = text;
}

/// The vehicle that sent a heartbeat, such as `a QUADROTOR is system 1`.
fn vehicle_in_words(system: u8, heartbeat: &HEARTBEAT_DATA) -> String {
    let [kind, autopilot] = [
        format!("{:?}", heartbeat.mavtype),
        format!("{:?}", heartbeat.autopilot),
    ];
    let kind = kind.trim_start_matches("MAV_TYPE_");
    match autopilot.trim_start_matches("MAV_AUTOPILOT_") {
        "ARDUPILOTMEGA" => format!("a {kind} is system {system}"),
        autopilot => format!("a {kind} with autopilot {autopilot} is system {system}"),
    }
}
