//! The sensor check before arming: what a boat sends, how often, who commands it, and what is missing.

use crate::config::{BoatProtocol, Gateway};
use crate::mavlink;
use crate::mavlink::dialect::MavMessage;
use crate::nmea::{self, Date, FixQuality, Mode, Operator, Sentence, TimeOfDay, date_and_time};
use crate::protocol::{ControlReport, Fix, Heading, North, Power, Protocol, Report};
use ::mavlink::Message;
use primitives::angle::{compass_deg_from_rad, wrap_pi};
use primitives::frame::LatLon;
use primitives::{SimTime, math};
use std::collections::BTreeMap;

/// Below this rate something comes too seldom to drive a boat, 1/s: what comes once a second may come a little late.
const RATE_MIN_HZ: f64 = 0.9;
/// Compass and true heading that are nearer than this are the same, rad.
const SAME_HEADING_RAD: f64 = 0.02;
/// The course of a slower boat is not where it points, m/s.
const COURSE_MIN_M_S: f64 = 1.0;
/// The most positions that are kept.
const FIXES_MAX: usize = 20_000;
/// The most names that are counted.
const NAMES_MAX: usize = 64;

/// What driving a boat needs: one of these sentences or messages, and why.
type Need = (&'static [&'static str], &'static str);

const FOR_A_FIX: &str = "without a fix it cannot be driven";
const FOR_A_HEADING: &str = "without a heading it cannot be driven";
const FOR_ITS_BATTERY: &str = "its battery would not be monitored";
const SURVEYOR_NEEDS: [Need; 5] = [
    (&["GGA", "RMC"], FOR_A_FIX),
    (&["PSEAA", "HDT"], FOR_A_HEADING),
    (&["PSEAD"], "it is not known who commands it: it can only be armed with control.assumed = true"),
    (&["VTG", "RMC"], "its velocity would be computed from its positions"),
    (&["PSEAB"], FOR_ITS_BATTERY),
];
const MAVLINK_NEEDS: [Need; 5] = [
    (&["GLOBAL_POSITION_INT"], FOR_A_FIX),
    (&["GPS_RAW_INT"], "without the quality of its fix it cannot be driven"),
    (&["ATTITUDE", "GLOBAL_POSITION_INT"], FOR_A_HEADING),
    (&["HEARTBEAT"], "it is not known who commands it"),
    (&["SYS_STATUS", "BATTERY_STATUS"], FOR_ITS_BATTERY),
];

/// The sentences or messages of one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Received {
    /// How often.
    pub count: u64,
    /// Of those, how many could not be read; all, where the sentence is unknown.
    pub unreadable: u64,
    /// When first and last.
    pub between: Option<(SimTime, SimTime)>,
    /// The last of them: a sentence as received, of a message its fields.
    pub last: String,
}

impl Received {
    /// How often a second it comes.
    #[must_use]
    pub fn rate_hz(&self) -> Option<f64> {
        let (first, last) = self.between?;
        let span_s = (last - first).as_s();
        // Intervals, not messages: of two that came within a second there is one interval.
        (span_s > 0.0).then(|| (self.count - 1) as f64 / span_s)
    }
}

/// Cuts what a boat sends into what has a name.
#[derive(Clone, Debug)]
enum Framer {
    Nmea(Box<nmea::Framer>),
    Mavlink(mavlink::Framer),
}

/// What a boat has sent so far.
#[derive(Clone, Debug)]
pub struct SensorCheck {
    framer: Framer,
    received: BTreeMap<String, Received>,
    protocol: Protocol,
    fix: Option<Fix>,
    /// Its positions, and when they came.
    fixes: Vec<(SimTime, LatLon)>,
    /// Course and speed over the ground, degrees and m/s.
    track: Option<(f64, f64)>,
    /// Time of day by the boat, and when it came.
    clock: Option<(SimTime, TimeOfDay)>,
    date: Option<Date>,
    compass_deg: Option<f64>,
    true_deg: Option<f64>,
    control: Option<ControlReport>,
    power: Power,
    error: Option<String>,
}

impl SensorCheck {
    /// Nothing received yet of a boat that is driven like this.
    #[must_use]
    pub fn new(gateway: &Gateway) -> SensorCheck {
        let framer = match gateway.protocol {
            BoatProtocol::Surveyor => Framer::Nmea(Box::default()),
            BoatProtocol::Mavlink => Framer::Mavlink(mavlink::Framer::default()),
        };
        SensorCheck {
            framer,
            received: BTreeMap::new(),
            protocol: Protocol::new(gateway),
            fix: None,
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

    /// Takes bytes as they come.
    pub fn receive(&mut self, now: SimTime, bytes: &[u8]) {
        // Counted by name with a framer of its own; what is reported comes from the gateway's
        // codec, so that the check goes by what the gateway would.
        self.count(now, bytes);
        let mut reports = vec![];
        self.protocol.read(now, bytes, &mut |report| reports.push(report));
        reports.into_iter().for_each(|report| self.apply(now, report));
    }

    /// Appends what a boat must be asked for before it sends anything: nothing for a Surveyor, its telemetry by MAVLink.
    pub fn write_questions(&mut self, now: SimTime, out: &mut Vec<u8>) {
        self.protocol.keep_up(now, out);
    }

    /// What was received, by name.
    #[must_use]
    pub fn received(&self) -> &BTreeMap<String, Received> {
        &self.received
    }

    /// What was counted on the link, by name.
    #[must_use]
    pub fn counts(&self) -> Vec<(String, u64)> {
        let [known, _] = self.protocol.counts();
        known
    }

    /// The last fix of which the quality was told.
    #[must_use]
    pub fn fix(&self) -> Option<&Fix> {
        self.fix.as_ref()
    }

    /// The positions so far, and when they came.
    #[must_use]
    pub fn fixes(&self) -> &[(SimTime, LatLon)] {
        &self.fixes
    }

    /// Heading by the compass, degrees.
    #[must_use]
    pub fn compass_deg(&self) -> Option<f64> {
        self.compass_deg
    }

    /// A true heading to compare it with, degrees: as reported, or the course of a boat that makes way.
    #[must_use]
    pub fn true_deg(&self) -> Option<f64> {
        let course =
            || self.track.filter(|(_, speed_m_s)| *speed_m_s >= COURSE_MIN_M_S).map(|(course_deg, _)| course_deg);
        self.true_deg.or_else(course)
    }

    /// The heading that the gateway would go by, degrees.
    #[must_use]
    pub fn heading_deg(&self) -> Option<f64> {
        self.compass_deg.or(self.true_deg)
    }

    /// Mode, who commands the boat, and its thrust.
    #[must_use]
    pub fn control(&self) -> Option<&ControlReport> {
        self.control.as_ref()
    }

    /// The battery, and who draws from it.
    #[must_use]
    pub fn power(&self) -> Power {
        self.power
    }

    /// What the boat says is wrong with it, if anything.
    #[must_use]
    pub fn error(&self) -> Option<&str> {
        self.error.as_deref()
    }

    /// How far the boat's clock is behind the host's, s; `host` is the host's time of day at `now`.
    #[must_use]
    pub fn clock_behind_s(&self, now: SimTime, host: TimeOfDay) -> Option<f64> {
        self.clock.map(|(came, time)| host.later(came - now).since_s(time))
    }

    /// What the boat reports of itself, in words; `host` is the host's time of day at `now`.
    #[must_use]
    pub fn findings(&self, now: SimTime, host: TimeOfDay) -> Vec<String> {
        let mut found = Vec::new();
        if let Some(Fix { at, quality: Some(quality), hdop, .. }) = self.fix {
            let place = at.map_or("no position".to_owned(), |at| format!("{:.6}, {:.6}", at.lat_deg, at.lon_deg));
            let hdop = hdop.map_or(String::new(), |hdop| format!(", dilution {hdop}"));
            found.push(format!("position: {place}, fix quality {quality}{hdop}"));
        }
        found.extend(self.heading());
        if let Some(ControlReport { shown, operator }) = &self.control {
            let who = operator
                .map_or("it does not report by whom".to_owned(), |operator| format!("commanded by {operator:?}"));
            found.push(format!("control: mode {}, {who}", self.mode_in_words(shown.mode)));
        }
        found.extend(self.power.volts.map(|volts| format!("battery: {volts} V")));
        found.extend(self.error.as_ref().map(|error| format!("error: {error}")));
        if let Some(behind_s) = self.clock_behind_s(now, host) {
            let date = self
                .date
                .map_or("it sends no date".to_owned(), |d| format!("date {}-{:02}-{:02}", d.year, d.month, d.day));
            let side = if behind_s < 0.0 { "AHEAD of" } else { "behind" };
            // A fix is some time on its way, so a little behind is as it should be; ahead can
            // only be a clock that is wrong.
            let note = if (-1.0..=5.0).contains(&behind_s) { "" } else { ": one of the two is wrong" };
            let off_s = behind_s.abs();
            found.push(format!("clock: fixes are {off_s:.2} s {side} this host's clock{note}; {date}"));
        }
        found
    }

    /// A mode by its name, and where it is one by its letter.
    pub(crate) fn mode_in_words(&self, mode: Mode) -> String {
        match self.framer {
            Framer::Nmea(_) => format!("{} ({mode:?})", mode.letter()),
            Framer::Mavlink(_) => format!("{mode:?}"),
        }
    }

    /// Its headings, in words.
    pub(crate) fn heading(&self) -> Option<String> {
        let Some(compass_deg) = self.compass_deg else {
            return self.true_deg.map(|true_deg| format!("heading: {true_deg:.1} true"));
        };
        Some(match self.true_deg {
            None => format!("heading: {compass_deg:.1} by its compass; nothing true to compare it with"),
            Some(true_deg) => {
                let apart_rad = wrap_pi((true_deg - compass_deg).to_radians());
                let frame = if apart_rad.abs() < SAME_HEADING_RAD {
                    "its compass counts from true north"
                } else {
                    "its compass counts from magnetic north"
                };
                format!("heading: {compass_deg:.1} by its compass, {true_deg:.1} true: {frame}")
            }
        })
    }

    /// What is missing for driving the boat.
    #[must_use]
    pub fn missing(&self) -> Vec<String> {
        let needs = match self.framer {
            Framer::Nmea(_) => &SURVEYOR_NEEDS,
            Framer::Mavlink(_) => &MAVLINK_NEEDS,
        };
        let mut missing: Vec<String> = needs.iter().filter_map(|need| self.lacks(*need)).collect();
        if let Some(operator) = self.control.as_ref().and_then(|control| control.operator)
            // Everything else may be there: a boat that somebody else commands follows nothing
            // that we send.
            && operator != Operator::Secondary
        {
            missing.push(match self.framer {
                Framer::Nmea(_) => "secondary control: the operator ashore has to enable it".to_owned(),
                Framer::Mavlink(_) => {
                    format!("control: {operator:?} has the boat, in a mode that is not GUIDED or HOLD")
                }
            });
        }
        // A receiver without a fix still sends its sentences, at the full rate.
        if let Some(Fix { at, quality: Some(quality), .. }) = self.fix
            && (at.is_none() || !quality.is_fix())
        {
            missing.push(format!("a position: its fix is of quality {quality}"));
        }
        missing
    }

    fn lacks(&self, (kinds, why): Need) -> Option<String> {
        // By the ending, for talkers differ (GPGGA, GNGGA).
        let best = self.received.iter().filter(|(name, _)| kinds.iter().any(|kind| name.ends_with(kind)));
        let rate_hz = best.filter_map(|(_, received)| received.rate_hz()).fold(0.0, f64::max);
        let name = kinds.join(" or ");
        match rate_hz {
            0.0 => Some(format!("{name}: {why}")),
            _ if rate_hz < RATE_MIN_HZ => Some(format!("{name} comes only {rate_hz:.2} times a second: {why}")),
            _ => None,
        }
    }

    /// Counts sentences or messages by name.
    fn count(&mut self, now: SimTime, bytes: &[u8]) {
        let SensorCheck { framer, received, date, .. } = self;
        match framer {
            Framer::Nmea(framer) => framer.push(bytes, &mut |body| {
                let sentence = Sentence::parse(body);
                let name = body.split(',').next().unwrap_or_default();
                note(received, now, name, (body.to_owned(), sentence.is_ok()));
                *date = match sentence {
                    Ok(Sentence::Rmc(rmc)) => rmc.date.or(*date),
                    Ok(Sentence::Zda(zda)) => zda.date.or(*date),
                    _ => *date,
                };
            }),
            Framer::Mavlink(framer) => framer.push(bytes, &mut |mavlink::Received { message, .. }| {
                note(received, now, message.message_name(), (mavlink::message_text(&message), true));
                if let MavMessage::SYSTEM_TIME(time) = &message
                    && time.time_unix_usec > 0
                {
                    *date = Some(date_and_time(time.time_unix_usec.saturating_mul(1000)).0);
                }
            }),
        }
    }

    fn apply(&mut self, now: SimTime, report: Report) {
        match report {
            // RMC says no more than whether there is one.
            Report::Fix(fix) if fix.quality.is_some() => {
                if let Some(at) = fix.at
                    && fix.quality.is_some_and(FixQuality::is_fix)
                    // The first ones are kept: their scatter is judged over the time from the
                    // first to the last.
                    && self.fixes.len() < FIXES_MAX
                {
                    self.fixes.push((now, at));
                }
                self.fix = Some(fix);
            }
            Report::Clock(time) => self.clock = Some((now, time)),
            Report::Velocity(velocity) => {
                let course_deg = compass_deg_from_rad(math::atan2(velocity.east, velocity.north));
                self.track = Some((course_deg, velocity.length()));
            }
            Report::Heading(Heading { deg, north: North::Compass, .. }) => self.compass_deg = Some(deg),
            Report::Heading(Heading { deg, north: North::True, .. }) => self.true_deg = Some(deg),
            Report::Control(control) => self.control = Some(control),
            Report::Power(power) => self.power = Power { volts: power.volts.or(self.power.volts), ..power },
            Report::Error(error) => self.error = error,
            Report::Notice(text) => self.error = Some(text),
            Report::Fix(_) | Report::Home(_) | Report::ForeignOrder | Report::Station(_) => {}
        }
    }
}

/// Notes something that came: its text, and whether it could be read.
fn note(received: &mut BTreeMap<String, Received>, now: SimTime, name: &str, (text, is_readable): (String, bool)) {
    let room = received.len() < NAMES_MAX || received.contains_key(name);
    let received = received.entry(if room { name } else { "others" }.to_owned()).or_default();
    received.count += 1;
    received.unreadable += u64::from(!is_readable);
    let first = received.between.map_or(now, |(first, _)| first);
    received.between = Some((first, now));
    received.last = text;
}

#[cfg(test)]
mod tests {
    use super::*;

    const TELEMETRY: &str = "$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62\r\n\
        $PSEAA,-2.2,0.7,222.6,,47.8,-0.04,-0.01,-1.00,-0.01*7A\r\n\
        $PSEAD,T,58.7,20,-10,,T,2,1*7A\r\n\
        $PTQM0,1*35\r\n";

    fn checked(text: &str, hz: f64) -> SensorCheck {
        let mut check = SensorCheck::new(&crate::config::default_gateway());
        for i in 0..10 {
            check.receive(SimTime::from_s(f64::from(i) / hz), text.as_bytes());
        }
        check
    }

    #[test]
    fn sentences_are_counted_and_missing_ones_are_named() {
        let check = checked(TELEMETRY, 10.0);
        let gga = &check.received()["GPGGA"];
        assert_eq!((gga.count, gga.unreadable), (10, 0));
        assert!((gga.rate_hz().unwrap_or(0.0) - 10.0).abs() < 1e-9);
        assert_eq!(check.received()["PTQM0"].unreadable, 10);
        let missing = check.missing().join("\n");
        for want in ["VTG or RMC", "PSEAB", "the operator ashore has to enable it"] {
            assert!(missing.contains(want), "{missing}");
        }
        assert!(!missing.contains("GGA") && !missing.contains("PSEAA"), "{missing}");
    }

    #[test]
    fn findings_are_in_words() {
        let host = TimeOfDay(54_302_400);
        let findings = checked(TELEMETRY, 10.0).findings(SimTime::ZERO, host).join("\n");
        for want in [
            "position: 42.358436, -71.087448, fix quality 2 (DGPS), dilution 0.98",
            "heading: 222.6 by its compass; nothing true",
            "control: mode T (Thruster), commanded by Primary",
            "clock: fixes are 1.30 s behind this host's clock; it sends no date",
        ] {
            assert!(findings.contains(want), "{want} is not in\n{findings}");
        }
        let with_true = format!("{TELEMETRY}$GPHDT,209.1,T*3F\r\n");
        assert!(
            checked(&with_true, 10.0).findings(SimTime::ZERO, host).join("\n").contains("counts from magnetic north")
        );
    }

    #[test]
    fn a_low_rate_is_reported() {
        assert!(checked(TELEMETRY, 0.5).missing().join("\n").contains("GGA or RMC comes only 0.50 times a second"));
    }
}
