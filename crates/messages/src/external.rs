//! The messages between the sim, the gateway of a real boat, and its operators.
//!
//! A vehicle whose scenario says `source = "external"` has no physics: its gateway reports where it is
//! ([`NavReport`]), and the sim, which knows whose orders count and what the referee lets the boat do, sends the effective
//! command ([`ExternalOrder`]). Commands of operators ([`OperatorCommand`]) and the status of a gateway
//! ([`GatewayStatus`]) are JSON.

use crate::picture::Nav;
use crate::{Message, Stamp, VehicleOrder};
use primitives::codec;
use primitives::frame::Ned;
use primitives::id::VehicleId;
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Where a real boat is, from its gateway.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavReport {
    /// Time: that of the game as the gateway last received it. Number: counts the reports.
    pub stamp: Stamp,
    /// The ticket that the sim gave when the gateway joined.
    pub ticket: u64,
    /// Whose navigation it is.
    pub vehicle: VehicleId,
    /// Whether it can be relied on; what is not valid is where the boat last was.
    pub valid: bool,
    /// How old the fix was when this was sent, ns.
    pub age_ns: i64,
    /// Position, heading and velocity.
    pub nav: Nav,
}

/// What a real boat is to do, from the sim.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExternalOrder {
    /// Time and decision of the game.
    pub stamp: Stamp,
    /// The time of the picture that the agent answered with this: it grows as long as the agent decides.
    pub given_ns: SimTime,
    /// The order, as far as the referee lets the boat follow it.
    pub order: VehicleOrder,
}

impl Message for NavReport {
    const SCHEMA: &'static str = "squall_msgs/msg/NavReport";
    const VERSION: u8 = 1;
}

impl Message for ExternalOrder {
    const SCHEMA: &'static str = "squall_msgs/msg/ExternalOrder";
    const VERSION: u8 = 2;
}

/// Bytes between a gateway and its boat.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkBytes {
    /// Time: that of the game as the gateway last received it. Number: counts these messages.
    pub stamp: Stamp,
    /// The boat.
    pub vehicle: VehicleId,
    /// Whether they go to the boat.
    pub outward: bool,
    /// The bytes.
    pub data: Vec<u8>,
}

impl Message for LinkBytes {
    const SCHEMA: &'static str = "squall_msgs/msg/LinkBytes";
    const VERSION: u8 = 1;
}

/// What a gateway reports for others. The sim passes it on if it comes with the ticket of the boat's gateway, and nobody else
/// may publish it: so nobody forges it, and nobody hears the ticket.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reported {
    /// [`GatewayStatus`], as JSON.
    Status,
    /// [`LinkBytes`].
    Link,
}

impl Reported {
    /// All kinds.
    pub const ALL: [Reported; 2] = [Reported::Status, Reported::Link];

    /// A report as it travels: the ticket, 64 bits, little-endian, then the message as it is passed on.
    #[must_use]
    pub fn with_ticket(ticket: u64, message: &[u8]) -> Vec<u8> {
        [&ticket.to_le_bytes(), message].concat()
    }

    /// The ticket of a report and the message, if it is long enough to have one.
    #[must_use]
    pub fn split_ticket(report: &[u8]) -> Option<(u64, &[u8])> {
        let (ticket, message) = report.split_first_chunk()?;
        Some((u64::from_le_bytes(*ticket), message))
    }

    /// Whether this is a message of this kind about this boat.
    #[must_use]
    pub fn is_about(self, message: &[u8], vehicle: VehicleId, name: &str) -> bool {
        match self {
            Reported::Status => {
                serde_json::from_slice::<GatewayStatus>(message).is_ok_and(|status| status.vehicle == name)
            }
            Reported::Link => codec::decode::<LinkBytes>(message).is_ok_and(|bytes| bytes.vehicle == vehicle),
        }
    }
}

impl fmt::Display for Reported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Reported::Status => "status",
            Reported::Link => "link",
        })
    }
}

/// An operator's command to a gateway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OperatorCommand {
    /// Return the status.
    Status,
    /// Follow orders from now on, if everything that this needs is there.
    Arm,
    /// Do not follow orders any more: standby.
    Disarm,
    /// Standby, and nothing else until this is released.
    EStop,
    /// The E-stop is over; the boat stays safed.
    Release,
    /// Hold the position by the boat's own controller.
    StationKeep,
    /// Go to the emergency recovery point by the boat's own controller.
    GoToErp,
    /// Upload a mission and sail it by the boat's own controller.
    Mission(Mission),
    /// Another mode of the boat's own controller.
    Mode(BoatMode),
}

/// A mode of a Surveyor's own controller beyond station keeping, recovery and missions. What it does in all but the first is not
/// published.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BoatMode {
    /// `C`: holds a heading at a thrust.
    Heading {
        /// True heading, degrees.
        heading_deg: f64,
        /// Thrust ahead, per cent.
        thrust_pct: f64,
    },
    /// `N`: river navigation.
    RiverNav,
    /// `I`: autopilot.
    Autopilot,
    /// `3`: calibration of the compass.
    CompassCalibration,
    /// `D`: depth.
    Depth,
    /// `S`: direction of gravity.
    GravityVector,
}

impl fmt::Display for BoatMode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            BoatMode::Heading { heading_deg, thrust_pct } => {
                return write!(f, "heading {heading_deg:03.0} at {thrust_pct:.0} %");
            }
            BoatMode::RiverNav => "river navigation",
            BoatMode::Autopilot => "autopilot",
            BoatMode::CompassCalibration => "compass calibration",
            BoatMode::Depth => "depth",
            BoatMode::GravityVector => "direction of gravity",
        })
    }
}

impl fmt::Display for OperatorCommand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            OperatorCommand::Status => "status",
            OperatorCommand::Arm => "arm",
            OperatorCommand::Disarm => "disarm",
            OperatorCommand::EStop => "E-stop",
            OperatorCommand::Release => "release",
            OperatorCommand::StationKeep => "station keeping",
            OperatorCommand::GoToErp => "to the emergency recovery point",
            OperatorCommand::Mission(mission) => {
                return write!(f, "a mission of {} waypoints", mission.waypoints.len());
            }
            OperatorCommand::Mode(mode) => return mode.fmt(f),
        })
    }
}

impl OperatorCommand {
    /// Whether only who knows the game's token may give it: everybody may look and stop.
    #[must_use]
    pub fn needs_token(&self) -> bool {
        !matches!(self, OperatorCommand::Status | OperatorCommand::Disarm | OperatorCommand::EStop)
    }
}

/// A command to all boats at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FleetCommand {
    /// Stop, and stay stopped.
    EStop,
    /// The stop is over.
    Release,
}

/// What is asked at the control port of a gateway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GatewayCommand {
    /// A command for one boat.
    Boat {
        /// Its name: another boat's gateway refuses.
        name: String,
        /// The command.
        command: OperatorCommand,
    },
    /// A command for all boats, whichever this gateway's is.
    Fleet(FleetCommand),
}

impl GatewayCommand {
    /// Whether only who knows the game's token may give it.
    #[must_use]
    pub fn needs_token(&self) -> bool {
        match self {
            GatewayCommand::Boat { command, .. } => command.needs_token(),
            GatewayCommand::Fleet(command) => *command != FleetCommand::EStop,
        }
    }
}

/// A mission that a boat sails by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mission {
    /// Throttle, per cent.
    pub throttle_pct: f64,
    /// The emergency recovery point: latitude and longitude, degrees.
    pub erp: [f64; 2],
    /// The waypoints, each latitude and longitude, degrees.
    pub waypoints: Vec<[f64; 2]>,
}

/// A gateway's reply to an operator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperatorReply {
    /// Why the command was refused.
    pub refused: Option<String>,
    /// The status now.
    pub status: GatewayStatus,
}

/// The status of a gateway and its boat.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GatewayStatus {
    /// The boat.
    pub vehicle: String,
    /// Where its control port listens, an address and a port; earlier versions have none.
    #[serde(default)]
    pub control: Option<String>,
    /// Time since the gateway began, s.
    pub at_s: f64,
    /// The link to the boat: `up`, or why it is not.
    pub link: String,
    /// The supervisor's state.
    pub state: String,
    /// What is missing for arming, in words.
    pub missing: Vec<String>,
    /// What is wrong in the boat itself now, in words: error code, leak, currents; earlier versions have none.
    #[serde(default)]
    pub alarms: Vec<String>,
    /// The failsafes so far, newest last. Recordings of earlier versions call them trips.
    #[serde(alias = "trips")]
    pub failsafes: Vec<FailsafeReport>,
    /// The control mode that the boat reports: the Surveyor's letter.
    pub mode: Option<char>,
    /// Who the boat reports is in control.
    pub operator: Option<String>,
    /// Navigation, if there is any.
    pub nav: Option<Nav>,
    /// Age of the last good fix, s.
    pub nav_age_s: Option<f64>,
    /// Where the boat may be, once a game says where the field is; earlier versions have none.
    #[serde(default)]
    pub geofence: Option<GeofenceReport>,
    /// Age of mode and operator, s; earlier versions have none.
    #[serde(default)]
    pub mode_age_s: Option<f64>,
    /// Battery, V.
    pub battery_v: Option<f64>,
    /// Its age, s; earlier versions have none.
    #[serde(default)]
    pub battery_age_s: Option<f64>,
    /// The sentence that was sent last.
    pub last_sent: String,
    /// In a dry run, what would have been sent last, if anything: what is sent is standby.
    #[serde(default)]
    pub would_send: Option<String>,
    /// Counts of everything, by name.
    pub counts: Vec<(String, u64)>,
    /// Median and 99th percentile in µs of: sentence in to topic out, order in to sentence out. What was not measured
    /// yet is missing.
    pub latency_us: [Option<[f64; 2]>; 2],
}

/// The geofence of a boat, and how near the boat is to it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GeofenceReport {
    /// The corners of the water where the boat may be, in order.
    pub outline: Vec<Ned>,
    /// The corners of each part of it where the boat must not be.
    pub keep_out: Vec<Vec<Ned>>,
    /// The boat's distance to the nearest edge of either, m; negative where it must not be.
    pub clearance_m: Option<f64>,
    /// How far the boat would go if it were stopped now, m.
    pub stopping_m: Option<f64>,
    /// Where it would come to rest.
    pub stops_at: Option<Ned>,
}

/// A failsafe: the boat was stopped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailsafeReport {
    /// Time since the gateway began, s.
    pub at_s: f64,
    /// The cause, in words.
    pub cause: String,
}
