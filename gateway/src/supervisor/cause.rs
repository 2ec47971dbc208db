//! The cause of a failsafe or of a refusal to arm, with messages for operators.

use super::{State, Task};
use crate::nmea::FixQuality;
use crate::thrust_check::ThrustFault;
use std::fmt;
use thiserror::Error;

/// The cause of a failsafe or, for a boat that is not driven, of a refusal to arm.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Cause {
    /// No order arrived within the time to live of the last one.
    #[error("no fresh order")]
    OrderStale,
    /// Navigation is unreliable.
    #[error("navigation: {0}")]
    Nav(NavFault),
    /// The boat was outside the geofence, or could not have stopped inside it.
    #[error("outside the geofence, or unable to stop inside")]
    Geofence,
    /// The boat did not respond to its orders as expected.
    #[error("{0}")]
    Thrust(ThrustFault),
    /// The battery voltage was low.
    #[error("the battery is low")]
    BatteryLow,
    /// This gateway did not have sole control of the boat.
    #[error("{0}")]
    Control(ControlFault),
    /// The boat has no known recovery point.
    #[error(
        "no recovery point inside the geofence, uploaded by this gateway and confirmed by the boat"
    )]
    NoRecoveryPoint,
    /// The gateway was not running for this time (s), and its guard may have stopped the boat.
    #[error("the gateway hung for {0:.1} s, and its guard may have stopped the boat")]
    Hung(f64),
    /// The link broke.
    #[error("the link is lost")]
    LinkLost,
}

/// Why this gateway does not command the boat, according to the boat's own reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ControlFault {
    /// Another operator took over. This is the operator number in PSEAD.
    #[error("{} has taken over", operator(*.0))]
    TakenOver(u8),
    /// The boat no longer reported who commands it.
    #[error("the boat no longer reports who commands it")]
    Unknown,
    /// The boat did not enter the mode that was sent, but reported this one.
    #[error("the boat does not follow its commands: it is in mode {0}")]
    Disobeyed(char),
    /// The boat still echoes an outdated command: it transmits but does not listen.
    #[error("the boat does not follow its commands: it still shows an older command")]
    Deaf,
    /// The boat echoes a command that we did not send.
    #[error("the boat receives orders that are not ours: another gateway may be active")]
    ForeignOrders,
}

/// A navigation fault.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum NavFault {
    /// No game has defined the field yet.
    #[error("no game yet, so no field and no geofence")]
    NoField,
    /// No fix received yet.
    #[error("no fix yet")]
    NoFix,
    /// No heading received yet.
    #[error("no heading yet")]
    NoHeading,
    /// Age of the last fix, s.
    #[error("the last fix is {0:.1} s old")]
    FixStale(f64),
    /// Age of the last heading, s.
    #[error("the last heading is {0:.1} s old")]
    HeadingStale(f64),
    /// The fix quality that the receiver reports.
    #[error("the fix has quality {0}")]
    Quality(FixQuality),
    /// The dilution of precision.
    #[error("the horizontal dilution of precision is {0}")]
    Dilution(f64),
    /// The position is 0° N, 0° E, which receivers without a fix send.
    #[error("the position is 0 N 0 E")]
    ZeroZero,
    /// The position jumped this far, m.
    #[error("the position jumped by {0:.0} m")]
    Jump(f64),
    /// Time without a change in any digit of the position while the boat was driven, s.
    #[error("the position has not changed for {0:.1} s under thrust")]
    Frozen(f64),
    /// Turn of the course without a change in any digit of the compass, degrees.
    #[error("the compass reading did not change while the course changed by {0:.0} degrees")]
    CompassFrozen(f64),
    /// Deviation of the compass from the course over ground on several headings, degrees.
    #[error("the compass is off by {:.0} degrees, compared with the course over the ground", .0.abs())]
    CompassOff(f64),
    /// The reported speed is below the speed computed from positions (m/s).
    #[error("the reported speed is lower than the speed implied by the positions, {0:.1} m/s")]
    SpeedTooLow(f64),
}

impl Cause {
    /// Whether the boat still receives commands, knows its position and heading, and responds to
    /// thrust.
    pub(crate) fn leaves_control(self) -> bool {
        // Only for these causes may a file choose a task after a failsafe. Allowing any action for
        // every cause would let a boat keep station without a fix.
        matches!(
            self,
            Cause::OrderStale | Cause::BatteryLow | Cause::Geofence | Cause::Hung(_)
        )
    }

    /// Severity among the causes that leave the boat controllable: the most severe decides what the
    /// boat does.
    pub(super) fn gravity(self) -> u8 {
        match self {
            Cause::Geofence => 2,
            Cause::BatteryLow => 1,
            _ => 0,
        }
    }

    /// The condition that is missing for arming, as text for operators.
    pub(crate) fn missing(self) -> String {
        match self {
            Cause::Hung(_) => "a gateway that does not hang".to_owned(),
            Cause::LinkLost => "the link to the boat".to_owned(),
            Cause::Control(ControlFault::TakenOver(by)) => {
                format!("secondary control: {} commands the boat", operator(by))
            }
            Cause::Control(ControlFault::ForeignOrders) => "a boat that receives orders only from us".to_owned(),
            Cause::NoRecoveryPoint => {
                "a recovery point inside the geofence, uploaded by this gateway and confirmed by the boat (mission)"
                    .to_owned()
            }
            Cause::Control(ControlFault::Unknown | ControlFault::Disobeyed(_) | ControlFault::Deaf) => {
                "secondary control: the boat does not report that we command it".to_owned()
            }
            Cause::Nav(fault) => format!("navigation: {fault}"),
            Cause::Thrust(fault) => format!("a boat that follows its orders: {fault}"),
            Cause::Geofence => "a position inside the geofence, and room to stop".to_owned(),
            Cause::BatteryLow => "a charged battery".to_owned(),
            Cause::OrderStale => "a fresh order".to_owned(),
        }
    }
}

/// The name for an operator number in PSEAD.
fn operator(number: u8) -> String {
    match number {
        1 => "the primary operator".to_owned(),
        3 => "the primary operator's backup link".to_owned(),
        5 => "the remote control".to_owned(),
        6 => "obstacle avoidance".to_owned(),
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
            State::Disarmed => f.write_str("disarmed"),
            State::Armed => f.write_str("armed"),
            State::Failsafe { cause, task: None } => write!(f, "failsafe: {cause}"),
            State::Failsafe {
                cause,
                task: Some(task),
            } => write!(f, "failsafe: {cause}; {task}"),
            State::Delegated(task) => write!(f, "delegated: {task}"),
            State::EStopped => f.write_str("e-stopped"),
        }
    }
}
