//! The sensor check before arming: which sentences a boat sends, how often, who commands it, and what is missing.

use crate::nmea::{ControlState, Counts, Date, Framer, Gga, M_S_PER_KN, Operator, ParseError, Sentence, TimeOfDay};
use game::SimTime;
use game::angle::wrap_pi;
use game::frame::LatLon;
use std::collections::BTreeMap;

/// Below this rate a sentence comes too seldom to drive a boat, 1/s.
const RATE_MIN_HZ: f64 = 1.0;
/// Compass and true heading that are nearer than this are the same, rad.
const SAME_HEADING_RAD: f64 = 0.02;
/// The course of a slower boat is not where it points, m/s.
const COURSE_MIN_M_S: f64 = 1.0;
/// The most positions that are kept.
const FIXES_MAX: usize = 20_000;
/// The most sentences that are counted by name.
const NAMES_MAX: usize = 64;

/// The sentences of one name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Received {
    /// How often.
    pub count: u64,
    /// Of those, how many could not be read; all, where the sentence is unknown.
    pub unreadable: u64,
    /// When first and last.
    pub between: Option<(SimTime, SimTime)>,
    /// The last of them, as received.
    pub last: String,
}

impl Received {
    /// How often a second it comes.
    #[must_use]
    pub fn rate_hz(&self) -> Option<f64> {
        let (first, last) = self.between?;
        let span_s = (last - first).as_s();
        (span_s > 0.0).then(|| (self.count - 1) as f64 / span_s)
    }
}

/// What a boat has sent so far.
#[derive(Clone, Debug, Default)]
pub struct SensorCheck {
    framer: Framer,
    received: BTreeMap<String, Received>,
    fix: Option<Gga>,
    /// Its positions, and when they came.
    fixes: Vec<(SimTime, LatLon)>,
    /// Course and speed over the ground, degrees and m/s.
    track: Option<(f64, f64)>,
    /// Time of day by the boat, and when it came.
    clock: Option<(SimTime, TimeOfDay)>,
    date: Option<Date>,
    compass_deg: Option<f64>,
    true_deg: Option<f64>,
    control: Option<ControlState>,
    volts: Option<f64>,
    error: Option<String>,
}

impl SensorCheck {
    /// Nothing received yet.
    #[must_use]
    pub fn new() -> SensorCheck {
        SensorCheck::default()
    }

    /// Takes bytes as they come.
    pub fn take(&mut self, now: SimTime, bytes: &[u8]) {
        let mut framer = std::mem::take(&mut self.framer);
        framer.push(bytes, &mut |body| self.note(now, body));
        self.framer = framer;
    }

    /// What was received, by name.
    #[must_use]
    pub fn received(&self) -> &BTreeMap<String, Received> {
        &self.received
    }

    /// What the framer counted.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.framer.counts()
    }

    /// The last fix.
    #[must_use]
    pub fn fix(&self) -> Option<&Gga> {
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

    /// Mode, who commands the boat, and its thrust.
    #[must_use]
    pub fn control(&self) -> Option<&ControlState> {
        self.control.as_ref()
    }

    /// The battery, V.
    #[must_use]
    pub fn volts(&self) -> Option<f64> {
        self.volts
    }

    /// The last error code.
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
        if let Some(fix @ Gga { at, quality, hdop, .. }) = &self.fix {
            let place = at.map_or("no position".to_owned(), |at| format!("{:.6}, {:.6}", at.lat_deg, at.lon_deg));
            let hdop = hdop.map_or(String::new(), |hdop| format!(", dilution {hdop}"));
            found.push(format!("position: {place} (fix quality {quality}: {}{hdop})", fix.quality_in_words()));
        }
        found.extend(self.heading());
        if let Some(ControlState { mode, operator, .. }) = &self.control {
            let who = operator
                .map_or("it does not report by whom".to_owned(), |operator| format!("commanded by {operator:?}"));
            found.push(format!("control: mode {} ({mode:?}), {who}", mode.letter()));
        }
        found.extend(self.volts.map(|volts| format!("battery: {volts} V")));
        found.extend(self.error.as_ref().map(|code| format!("error code: {code}")));
        if let Some(behind_s) = self.clock_behind_s(now, host) {
            let date = self
                .date
                .map_or("it sends no date".to_owned(), |d| format!("date {}-{:02}-{:02}", d.year, d.month, d.day));
            let side = if behind_s < 0.0 { "AHEAD of" } else { "behind" };
            let note = if (-1.0..=5.0).contains(&behind_s) { "" } else { ": one of the two is wrong" };
            let off_s = behind_s.abs();
            found.push(format!("clock: fixes are {off_s:.2} s {side} this host's clock{note}; {date}"));
        }
        found
    }

    /// Its headings, in words.
    pub(crate) fn heading(&self) -> Option<String> {
        let compass_deg = self.compass_deg?;
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
        let mut missing = Vec::new();
        let mut need = |kinds: &[&str], why: &str| {
            let best = self.received.iter().filter(|(name, _)| kinds.iter().any(|kind| name.ends_with(kind)));
            let rate = best.filter_map(|(_, received)| received.rate_hz()).fold(0.0, f64::max);
            let name = kinds.join(" or ");
            if rate == 0.0 {
                missing.push(format!("{name}: {why}"));
            } else if rate < RATE_MIN_HZ {
                missing.push(format!("{name} comes only {rate:.2} times a second: {why}"));
            }
        };
        need(&["GGA", "RMC"], "without a fix it cannot be driven");
        need(&["PSEAA", "HDT"], "without a heading it cannot be driven");
        need(&["PSEAD"], "it is not known who commands it: it can only be armed with control.assumed = true");
        need(&["VTG", "RMC"], "its velocity would be computed from its positions");
        need(&["PSEAB"], "its battery would not be monitored");
        if let Some(operator) = self.control.as_ref().and_then(|state| state.operator)
            && operator != Operator::Secondary
        {
            missing.push("secondary control: the operator ashore has to enable it".to_owned());
        }
        if let Some(Gga { at: None, quality, .. }) = &self.fix {
            missing.push(format!("a position: its fix is of quality {quality}"));
        }
        missing
    }

    fn note(&mut self, now: SimTime, body: &str) {
        let name = body.split(',').next().unwrap_or_default();
        let room = self.received.len() < NAMES_MAX || self.received.contains_key(name);
        let received = self.received.entry(if room { name } else { "others" }.to_owned()).or_default();
        received.count += 1;
        let first = received.between.map_or(now, |(first, _)| first);
        received.between = Some((first, now));
        body.clone_into(&mut received.last);
        match Sentence::parse(body) {
            Ok(sentence) => self.apply(now, sentence),
            Err(ParseError::Unknown { .. } | ParseError::Field { .. } | ParseError::TooFew { .. }) => {
                received.unreadable += 1;
            }
        }
    }

    fn apply(&mut self, now: SimTime, sentence: Sentence) {
        match sentence {
            Sentence::Gga(gga) => {
                self.clock = gga.time.map(|time| (now, time)).or(self.clock);
                if let Some(at) = gga.at
                    && self.fixes.len() < FIXES_MAX
                {
                    self.fixes.push((now, at));
                }
                self.fix = Some(gga);
            }
            Sentence::Rmc(rmc) => self.date = rmc.date.or(self.date),
            Sentence::Vtg(vtg) => {
                let speed_m_s = vtg.speed_kn.map(|speed_kn| speed_kn * M_S_PER_KN);
                self.track = vtg.course_true_deg.zip(speed_m_s);
            }
            Sentence::Zda(zda) => self.date = zda.date.or(self.date),
            Sentence::Attitude(attitude) => self.compass_deg = attitude.heading_deg.or(self.compass_deg),
            Sentence::Hdt(hdt) => self.true_deg = hdt.heading_deg.or(self.true_deg),
            Sentence::ControlState(state) => self.control = Some(state),
            Sentence::Battery(battery) => self.volts = battery.volts.or(self.volts),
            Sentence::BoatError(error) => self.error = Some(error.code),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TELEMETRY: &str = "$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62\r\n\
        $PSEAA,-2.2,0.7,222.6,,47.8,-0.04,-0.01,-1.00,-0.01*7A\r\n\
        $PSEAD,T,58.7,20,-10,,T,2,1*7A\r\n\
        $PTQM0,1*35\r\n";

    fn checked(text: &str, hz: f64) -> SensorCheck {
        let mut check = SensorCheck::new();
        for i in 0..10 {
            check.take(SimTime::from_s(f64::from(i) / hz), text.as_bytes());
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
            "position: 42.358436, -71.087448 (fix quality 2: DGPS, dilution 0.98)",
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
