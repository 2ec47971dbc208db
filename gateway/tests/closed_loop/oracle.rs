//! The test oracle: checks every sent sentence against the safety rules, independently of the
//! implementation.

use gateway::nmea::{FixQuality, Operator, Sentence};
use primitives::SimTime;

/// Maximum age of orders, navigation and control reports, s: the values of the default file.
const TTL_S: f64 = 1.0;
const NAV_AGE_MAX_S: f64 = 1.5;
const CONTROL_AGE_MAX_S: f64 = 2.0;

/// The gateway's state as seen from outside.
#[derive(Debug, Default)]
pub(crate) struct Oracle {
    /// Extra time for which data may have waited, beyond the assumed limits, s.
    pub(crate) waited_s: f64,
    /// When the last order arrived that was valid and newer than its predecessor.
    pub(crate) ordered: Option<SimTime>,
    /// Arrival times of the last valid fix, of the last heading, and of the boat's last report that
    /// we command it.
    pub(crate) fixed: Option<SimTime>,
    pub(crate) headed: Option<SimTime>,
    pub(crate) granted: Option<SimTime>,
    pub(crate) other_operator: bool,
    /// E-stops in force: boat, fleet.
    pub(crate) stops: [bool; 2],
    pub(crate) armed: bool,
    /// Time after a stop for lack of orders within which the gateway may arm the boat itself (s),
    /// and when the boat was last stopped for that reason.
    pub(crate) rearm_within_s: f64,
    pub(crate) starved: Option<SimTime>,
    pub(crate) link_up: bool,
    /// Number of driving sentences, and of all sentences.
    pub(crate) driving: u64,
    pub(crate) all: u64,
    pub(crate) last: String,
    /// An incomplete sentence from the boat.
    pub(crate) partial: String,
}

/// The time since a given moment, s; infinite if that moment has not come.
pub(crate) fn age_s(now: SimTime, since: Option<SimTime>) -> f64 {
    since.map_or(f64::INFINITY, |since| (now - since).as_s())
}

impl Oracle {
    /// Resets what is known about the boat, for a new link.
    pub(crate) fn forget(&mut self) {
        self.partial.clear();
        (self.fixed, self.headed, self.granted) = (None, None, None);
    }

    /// Records bytes from the boat: only complete sentences with valid checksums count.
    pub(crate) fn note(&mut self, now: SimTime, piece: &[u8]) {
        self.partial += &String::from_utf8_lossy(piece);
        while let Some((line, rest)) = self.partial.split_once(['\r', '\n']) {
            let line = line.to_owned();
            let rest = rest.to_owned();
            self.partial = rest;
            let Some((body, sum)) = line
                .rsplit('$')
                .next()
                .and_then(|line| line.split_once('*'))
            else {
                continue;
            };
            if u8::from_str_radix(sum, 16) == Ok(body.bytes().fold(0, |a, b| a ^ b)) {
                self.note_sentence(now, body);
            }
        }
    }

    fn note_sentence(&mut self, now: SimTime, body: &str) {
        match Sentence::parse(body) {
            Ok(Sentence::Gga(gga))
                if FixQuality::from_gga(gga.quality).is_fix() && gga.at.is_some() =>
            {
                self.fixed = Some(now)
            }
            Ok(Sentence::Attitude(attitude)) if attitude.heading_deg.is_some() => {
                self.headed = Some(now)
            }
            Ok(Sentence::ControlState(state)) => {
                self.other_operator = state.operator != Some(Operator::Secondary);
                if !self.other_operator {
                    self.granted = Some(now);
                }
            }
            _ => {}
        }
    }

    /// Checks bytes from the gateway to the boat.
    pub(crate) fn judge(&mut self, now: SimTime, bytes: &[u8]) {
        let text = std::str::from_utf8(bytes).expect("what is sent is text");
        for line in text.split_inclusive("\r\n") {
            assert!(
                line.len() <= 82 && line.starts_with('$') && line.ends_with("\r\n"),
                "{line:?}"
            );
            self.judge_line(now, line);
        }
    }

    fn judge_line(&mut self, now: SimTime, line: &str) {
        self.all += 1;
        assert!(self.link_up, "at {now}: {line:?} into a link that is down");
        self.last = line.to_owned();
        let fields: Vec<&str> = line.split(['$', ',', '*']).collect();
        if fields[1] != "PSEAC" {
            return;
        }
        let number = |i: usize| fields[i].parse::<f64>().unwrap_or(0.0);
        let drives = match fields[2] {
            "T" => number(4) != 0.0 || number(5) != 0.0,
            "G" => number(4) != 0.0,
            "L" | "F" => false,
            // The boat's own controller, requested by an operator.
            "R" | "H" | "W" | "C" | "N" | "I" | "3" | "D" | "S" => {
                self.is_fit(now, line);
                assert!((0.0..=70.0).contains(&number(4)), "at {now}: {line:?}");
                return;
            }
            other => panic!("at {now}: mode {other} is never sent"),
        };
        if !drives {
            return;
        }
        self.driving += 1;
        self.is_fit(now, line);
        let age_s = age_s(now, self.ordered);
        assert!(
            age_s <= TTL_S + self.waited_s + 1e-6,
            "at {now}: {line:?} for an order {age_s} s old"
        );
        assert!(
            self.armed,
            "at {now}: {line:?} from a gateway that is not armed"
        );
        assert!(number(4).abs() + number(5).abs() <= 100.0, "{line:?}");
    }

    fn is_fit(&self, now: SimTime, line: &str) {
        for (what, since, most_s) in [
            ("fix", self.fixed, NAV_AGE_MAX_S),
            ("heading", self.headed, NAV_AGE_MAX_S),
            ("control state", self.granted, CONTROL_AGE_MAX_S),
        ] {
            let age_s = age_s(now, since);
            assert!(
                age_s <= most_s + self.waited_s + 1e-6,
                "at {now}: {line:?} with a {what} {age_s} s old"
            );
        }
        assert!(
            !self.other_operator,
            "at {now}: {line:?} while another controller commands the boat"
        );
        assert!(
            self.stops == [false; 2],
            "at {now}: {line:?} under an E-stop"
        );
    }
}
