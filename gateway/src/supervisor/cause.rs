//! The cause of a failsafe or of a refusal to arm, with its texts for operators.

use super::{State, Task};
use std::fmt;
use thiserror::Error;

/// The cause of a failsafe; for a boat that is not driven, of a refusal to arm.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Cause {
    /// No order came for longer than its time to live.
    #[error("no fresh order")]
    OrderStale,
    /// Navigation cannot be relied on.
    #[error("navigation: {0}")]
    Nav(NavFault),
    /// The boat was outside of the geofence, or could not have stopped inside.
    #[error("outside of the geofence, or unable to stop inside")]
    Geofence,
    /// The battery was low.
    #[error("the battery is low")]
    BatteryLow,
    /// Another operator took it over: PSEAD's number.
    #[error("{} has taken over", operator(*.0))]
    TakenOver(u8),
    /// It no longer reported who commands it.
    #[error("the boat no longer reports who commands it")]
    ControlUnknown,
    /// It did not take up the mode that it was sent: this is the one it reported.
    #[error("the boat does not follow the commands it is sent: it is in mode {0}")]
    Disobeyed(char),
    /// The gateway itself did not run for this long, s, and its guard may have stopped the boat.
    #[error("the gateway hung for {0:.1} s, and its guard may have stopped the boat")]
    Hung(f64),
    /// The link broke.
    #[error("the link is lost")]
    LinkLost,
}

/// What is wrong with navigation.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NavFault {
    /// No game has said where the field is.
    #[error("no game yet, and so no field and no geofence")]
    NoField,
    /// There was no fix yet.
    #[error("no fix yet")]
    NoFix,
    /// There was no heading yet.
    #[error("no heading yet")]
    NoHeading,
    /// The last fix is this old, s.
    #[error("the last fix is {0:.1} s old")]
    FixStale(f64),
    /// The last heading is this old, s.
    #[error("the last heading is {0:.1} s old")]
    HeadingStale(f64),
    /// The receiver says that its fix is of this quality.
    #[error("the fix is of quality {0}")]
    Quality(u8),
    /// The dilution of precision is this large.
    #[error("the horizontal dilution of precision is {0}")]
    Dilution(f64),
    /// The position is 0° N, 0° E: what receivers send that know nothing.
    #[error("the position is 0 N 0 E")]
    ZeroZero,
    /// The position jumped this far, m.
    #[error("the position jumped by {0:.0} m")]
    Jump(f64),
    /// The position has been the same to the last digit for this long though the boat is driven, s.
    #[error("the position has not changed for {0:.1} s under thrust")]
    Frozen(f64),
    /// The compass has shown the same to the last digit while the course turned this far, degrees.
    #[error("the compass shows the same while the course turned by {0:.0} degrees")]
    CompassFrozen(f64),
    /// The reported speed is less than that of the positions, which is this, m/s.
    #[error("the reported speed is less than that of the positions, {0:.1} m/s")]
    SpeedTooLow(f64),
}

impl Cause {
    /// What is missing for arming while this is so, in words.
    #[must_use]
    pub fn missing(self) -> String {
        match self {
            Cause::Hung(_) => "a gateway that does not hang".to_owned(),
            Cause::LinkLost => "the link to the boat".to_owned(),
            Cause::TakenOver(by) => format!("secondary control: {} commands the boat", operator(by)),
            Cause::ControlUnknown | Cause::Disobeyed(_) => {
                "secondary control: the boat does not report that we command it".to_owned()
            }
            Cause::Nav(fault) => format!("navigation: {fault}"),
            Cause::Geofence => "a position inside of the geofence, and room to stop".to_owned(),
            Cause::BatteryLow => "a charged battery".to_owned(),
            Cause::OrderStale => "a fresh order".to_owned(),
        }
    }
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
