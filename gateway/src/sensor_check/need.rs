//! The data needed to drive a boat, and why some of it is missing.

use super::{Framer, Received, SensorCheck};

/// Minimum rate of data to drive a boat, 1/s: data sent once a second may arrive a little late.
const RATE_MIN_HZ: f64 = 0.9;

/// Data that a boat must report, in a form that the gateway can use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Usable {
    /// A new position from a fix.
    Position,
    /// A fix, not only an estimate.
    Quality,
    Heading,
    /// The operator in control.
    Control,
    Velocity,
    /// A battery's voltage.
    Voltage,
}

/// One need: the data, the sentences or messages that carry it, and the consequence of its absence.
struct Need {
    usable: Usable,
    what: &'static str,
    kinds: &'static [&'static str],
    without: &'static str,
}

const fn need(
    usable: Usable,
    what: &'static str,
    kinds: &'static [&'static str],
    without: &'static str,
) -> Need {
    Need {
        usable,
        what,
        kinds,
        without,
    }
}

const FOR_A_FIX: &str = "the boat cannot be driven without a fix";
const FOR_A_HEADING: &str = "the boat cannot be driven without a heading";
const FOR_ITS_BATTERY: &str = "its battery would not be monitored";
const UNKNOWN_CONTROL: &str =
    "it is unknown who commands the boat, so it can be armed only with control.assumed = true";
const SURVEYOR_NEEDS: [Need; 5] = [
    need(Usable::Position, "a position", &["GGA", "RMC"], FOR_A_FIX),
    need(
        Usable::Heading,
        "a heading",
        &["PSEAA", "HDT"],
        FOR_A_HEADING,
    ),
    need(Usable::Control, "its operator", &["PSEAD"], UNKNOWN_CONTROL),
    need(
        Usable::Velocity,
        "a velocity",
        &["VTG", "RMC"],
        "its velocity would be computed from its positions",
    ),
    need(Usable::Voltage, "a voltage", &["PSEAB"], FOR_ITS_BATTERY),
];
const MAVLINK_NEEDS: [Need; 5] = [
    need(
        Usable::Position,
        "a position",
        &["GLOBAL_POSITION_INT"],
        FOR_A_FIX,
    ),
    need(
        Usable::Quality,
        "a fix",
        &["GPS_RAW_INT"],
        "the boat cannot be driven without a fix quality",
    ),
    need(
        Usable::Heading,
        "a heading",
        &["ATTITUDE", "GLOBAL_POSITION_INT"],
        FOR_A_HEADING,
    ),
    need(
        Usable::Control,
        "its mode",
        &["HEARTBEAT"],
        "it is unknown who commands the boat",
    ),
    need(
        Usable::Voltage,
        "a voltage",
        &["SYS_STATUS", "BATTERY_STATUS"],
        FOR_ITS_BATTERY,
    ),
];

impl SensorCheck {
    /// The needs that the received data does not meet.
    pub(super) fn unmet(&self) -> Vec<String> {
        let needs = match self.framer {
            Framer::Nmea(_) => &SURVEYOR_NEEDS,
            Framer::Mavlink(_) if self.usable.is_empty() && !self.received.is_empty() => {
                return vec![self.no_boat()];
            }
            Framer::Mavlink(_) => &MAVLINK_NEEDS,
        };
        needs.iter().filter_map(|need| self.lacks(need)).collect()
    }

    /// Whether usable data is missing, regardless of names: a sentence may be unreadable or empty.
    fn lacks(&self, need: &Need) -> Option<String> {
        let Need {
            usable,
            what,
            kinds,
            without,
        } = need;
        let rate_hz = self
            .usable
            .get(usable)
            .and_then(Received::rate_hz)
            .unwrap_or(0.0);
        if rate_hz >= RATE_MIN_HZ {
            return None;
        }
        // Match the ending, because talkers differ (GPGGA, GNGGA).
        let named = self
            .received
            .iter()
            .filter(|(name, _)| kinds.iter().any(|kind| name.ends_with(kind)));
        let named: Vec<_> = named.collect();
        let names = kinds.join(" or ");
        if *usable == Usable::Position && self.no_fix().is_some() {
            // The fix quality is reported instead.
            return None;
        }
        let lost = named
            .iter()
            .find_map(|(_, received)| received.why_unreadable.as_ref());
        Some(match (named.first(), lost) {
            (None, _) => format!("{names}: {without}"),
            (_, Some(why)) if !self.usable.contains_key(usable) => format!("{what}: {why}"),
            (Some((name, _)), _) if !self.usable.contains_key(usable) => {
                format!("{what}: missing in {name}; {without}")
            }
            _ => {
                format!("{names} bring new data only {rate_hz:.2} times a second: {without}")
            }
        })
    }

    fn no_boat(&self) -> String {
        let heard: Vec<String> = self.heard.iter().cloned().collect();
        let heard = if heard.is_empty() {
            "received no HEARTBEAT".to_owned()
        } else {
            heard.join(", ")
        };
        format!("a boat: all messages are from other systems ({heard})")
    }
}
