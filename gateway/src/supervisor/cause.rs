//! The cause of a failsafe, and what is missing for arming, with their texts for operators.

use super::{Control, Refusal, State, Task};
use std::fmt;

/// The cause of a failsafe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// No order came for longer than its time to live.
    OrderStale,
    /// Navigation cannot be relied on.
    Nav(NavFault),
    /// The boat was outside of the geofence, or could not have stopped inside.
    Geofence,
    /// The battery was low.
    BatteryLow,
    /// Another operator took it over: PSEAD's number.
    TakenOver(u8),
    /// It no longer reported who commands it.
    ControlUnknown,
    /// It did not take up the mode that it was sent: this is the one it reported.
    Disobeyed(char),
    /// The link broke.
    LinkLost,
}

/// What is wrong with navigation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NavFault {
    /// There was no fix yet.
    NoFix,
    /// There was no heading yet.
    NoHeading,
    /// The last fix is this old, s.
    FixStale(f64),
    /// The last heading is this old, s.
    HeadingStale(f64),
    /// The receiver says that its fix is of this quality.
    Quality(u8),
    /// The dilution of precision is this large.
    Dilution(f64),
    /// The position is 0° N, 0° E: what receivers send that know nothing.
    ZeroZero,
    /// The position jumped this far, m.
    Jump(f64),
    /// The position has been the same to the last digit for this long though the boat is driven, s.
    Frozen(f64),
}

/// What is missing for arming.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Missing {
    /// The link is down.
    Link,
    /// The boat does not report that we command it.
    Control(Control),
    /// Navigation is not sound.
    Nav(NavFault),
    /// It is outside of the geofence.
    Inside,
    /// The battery is low.
    Battery,
    /// There is no fresh order.
    Order,
}

/// PSEAD's number of the operator in words.
fn operator(number: u8) -> String {
    match number {
        1 => "the primary operator".to_owned(),
        3 => "the primary operator's backup link".to_owned(),
        5 => "the remote control".to_owned(),
        6 => "the obstacle avoidance".to_owned(),
        other => format!("operator {other}"),
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::OrderStale => f.write_str("no fresh order"),
            Cause::Nav(fault) => write!(f, "navigation: {fault}"),
            Cause::Geofence => f.write_str("outside of the geofence, or unable to stop inside"),
            Cause::BatteryLow => f.write_str("the battery is low"),
            Cause::TakenOver(by) => write!(f, "{} has taken over", operator(*by)),
            Cause::ControlUnknown => f.write_str("the boat no longer reports who commands it"),
            Cause::Disobeyed(mode) => {
                write!(f, "the boat does not follow the commands it is sent: it is in mode {mode}")
            }
            Cause::LinkLost => f.write_str("the link is lost"),
        }
    }
}

impl fmt::Display for NavFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NavFault::NoFix => f.write_str("no fix yet"),
            NavFault::NoHeading => f.write_str("no heading yet"),
            NavFault::FixStale(age_s) => write!(f, "the last fix is {age_s:.1} s old"),
            NavFault::HeadingStale(age_s) => write!(f, "the last heading is {age_s:.1} s old"),
            NavFault::Quality(quality) => write!(f, "the fix is of quality {quality}"),
            NavFault::Dilution(hdop) => write!(f, "the horizontal dilution of precision is {hdop}"),
            NavFault::ZeroZero => f.write_str("the position is 0 N 0 E"),
            NavFault::Jump(by_m) => write!(f, "the position jumped by {by_m:.0} m"),
            NavFault::Frozen(for_s) => write!(f, "the position has not changed for {for_s:.1} s under thrust"),
        }
    }
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Missing::Link => f.write_str("the link to the boat"),
            Missing::Control(Control::Other(by)) => write!(f, "secondary control: {} commands the boat", operator(*by)),
            Missing::Control(_) => f.write_str("secondary control: the boat does not report that we command it"),
            Missing::Nav(fault) => write!(f, "navigation: {fault}"),
            Missing::Inside => f.write_str("a position inside of the geofence, and room to stop"),
            Missing::Battery => f.write_str("a charged battery"),
            Missing::Order => f.write_str("a fresh order"),
        }
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            State::Safed => f.write_str("safed"),
            State::Armed => f.write_str("armed"),
            State::Failsafe(cause) => write!(f, "failsafe: {cause}"),
            State::Delegated(Task::StationKeep) => f.write_str("delegated: station keeping"),
            State::Delegated(Task::GoToErp) => f.write_str("delegated: to the emergency recovery point"),
            State::Delegated(Task::Mission) => f.write_str("delegated: mission"),
            State::EStopped => f.write_str("e-stopped"),
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::EStopped => f.write_str("an E-stop is in force"),
            Refusal::NotReady(missing) => {
                let missing: Vec<String> = missing.iter().map(ToString::to_string).collect();
                write!(f, "missing: {}", missing.join("; "))
            }
        }
    }
}
