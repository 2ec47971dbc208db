//! The cause of a failsafe or of a refusal to arm, with its texts for operators.

use super::{State, Task};
use crate::nmea::FixQuality;
use crate::thrust_check::ThrustFault;
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
    /// It did not do what the orders that it was sent should have done.
    #[error("{0}")]
    Thrust(ThrustFault),
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
    /// It shows a command that others have followed since: it talks and does not listen.
    #[error("the boat does not follow the commands it is sent: it shows older ones")]
    Deaf,
    /// It shows a command that we have not sent.
    #[error("the boat gets orders that are not ours: another gateway may be at work")]
    ForeignOrders,
    /// The boat has no recovery point that we know of.
    #[error("the boat has no recovery point that was uploaded here, seen taken, and lies inside of the geofence")]
    NoRecoveryPoint,
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
    Quality(FixQuality),
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
    /// The compass is off by this much, degrees, by the course over the ground on several headings.
    #[error("the compass is off by {:.0} degrees, by the course over the ground", .0.abs())]
    CompassOff(f64),
    /// The reported speed is less than that of the positions, which is this, m/s.
    #[error("the reported speed is less than that of the positions, {0:.1} m/s")]
    SpeedTooLow(f64),
}

impl Cause {
    /// Whether the boat can still be told what to do, knows where it is and points, and is moved by its thrusters.
    #[must_use]
    pub fn leaves_control(self) -> bool {
        // Only for these may a file name a task after a failsafe. A table of every cause with
        // every action would let somebody keep station on a lost fix.
        matches!(self, Cause::OrderStale | Cause::BatteryLow | Cause::Geofence | Cause::Hung(_))
    }

    /// Of the causes that leave control, the graver one decides what the boat does.
    pub(super) fn gravity(self) -> u8 {
        match self {
            Cause::Geofence => 2,
            Cause::BatteryLow => 1,
            _ => 0,
        }
    }

    /// What is missing for arming while this is so, in words.
    #[must_use]
    pub fn missing(self) -> String {
        match self {
            Cause::Hung(_) => "a gateway that does not hang".to_owned(),
            Cause::LinkLost => "the link to the boat".to_owned(),
            Cause::TakenOver(by) => format!("secondary control: {} commands the boat", operator(by)),
            Cause::ForeignOrders => "a boat that gets no orders but ours".to_owned(),
            Cause::NoRecoveryPoint => {
                "a recovery point inside of the geofence that was uploaded here and that the boat took (mission)"
                    .to_owned()
            }
            Cause::ControlUnknown | Cause::Disobeyed(_) | Cause::Deaf => {
                "secondary control: the boat does not report that we command it".to_owned()
            }
            Cause::Nav(fault) => format!("navigation: {fault}"),
            Cause::Thrust(fault) => format!("a boat that does as it is ordered: {fault}"),
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

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Task::StationKeep => "station keeping",
            Task::GoToErp => "to the emergency recovery point",
            Task::Mission => "mission",
            Task::Mode(mode) => return mode.fmt(f),
        })
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            State::Safed => f.write_str("safed"),
            State::Armed => f.write_str("armed"),
            State::Failsafe { cause, task: None } => write!(f, "failsafe: {cause}"),
            State::Failsafe { cause, task: Some(task) } => write!(f, "failsafe: {cause}; {task}"),
            State::Delegated(task) => write!(f, "delegated: {task}"),
            State::EStopped => f.write_str("e-stopped"),
        }
    }
}
