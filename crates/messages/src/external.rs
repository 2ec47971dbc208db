//! The messages between the sim, the gateway of a real boat, and its operators.
//!
//! A vehicle with `source = "external"` has no physics. Its gateway reports its navigation
//! ([`NavReport`]). The sim knows whose orders count and what the referee allows, and sends the
//! effective command ([`ExternalOrder`]). Operator commands ([`OperatorCommand`]) and gateway
//! status ([`GatewayStatus`]) are JSON.

use crate::picture::Nav;
use crate::{Message, Stamp, VehicleOrder};
use primitives::codec;
use primitives::frame::Ned;
use primitives::id::VehicleId;
use primitives::time::SimTime;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Navigation of a real boat, reported by its gateway.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavReport {
    /// Game time last received by the gateway, and the report's sequence number.
    pub stamp: Stamp,
    /// The ticket from the sim's join reply.
    pub ticket: u64,
    /// The reported boat.
    pub vehicle: VehicleId,
    /// Whether the fix is reliable. If not, `nav` is the last known navigation.
    pub valid: bool,
    /// Age of the fix when sent, ns.
    pub age_ns: i64,
    /// Position, heading and velocity.
    pub nav: Nav,
}

/// The effective command for a real boat, from the sim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExternalOrder {
    /// Time and decision of the game.
    pub stamp: Stamp,
    /// Time of the picture that the agent answered. It advances only as long as the agent answers
    /// new pictures.
    pub given_ns: SimTime,
    /// The order, limited by the referee.
    pub order: VehicleOrder,
    /// Positions of the other real boats: north and east of each, m.
    pub others_m: Vec<f64>,
}

impl Message for NavReport {
    const SCHEMA: &'static str = "squall_msgs/msg/NavReport";
    const VERSION: u8 = 1;
}

impl Message for ExternalOrder {
    const SCHEMA: &'static str = "squall_msgs/msg/ExternalOrder";
    const VERSION: u8 = 3;
}

/// Bytes between a gateway and its boat.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LinkBytes {
    /// Game time last received by the gateway, and the message's sequence number.
    pub stamp: Stamp,
    /// The boat.
    pub vehicle: VehicleId,
    /// Whether the bytes go to the boat.
    pub outward: bool,
    /// The bytes.
    pub data: Vec<u8>,
}

impl Message for LinkBytes {
    const SCHEMA: &'static str = "squall_msgs/msg/LinkBytes";
    const VERSION: u8 = 1;
}

/// A gateway report for other nodes. The sim forwards it if it carries the ticket of the boat's
/// gateway. Only the sim may publish forwarded reports, so they cannot be forged and the ticket
/// stays secret.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, strum::Display)]
#[strum(serialize_all = "snake_case")]
pub enum Reported {
    /// [`GatewayStatus`], as JSON.
    Status,
    /// [`LinkBytes`].
    Link,
}

impl Reported {
    /// All kinds.
    pub const ALL: [Reported; 2] = [Reported::Status, Reported::Link];

    /// Encodes a report: the ticket (64 bits, little-endian), then the message.
    pub fn with_ticket(ticket: u64, message: &[u8]) -> Vec<u8> {
        [&ticket.to_le_bytes(), message].concat()
    }

    /// Splits a report into ticket and message; `None` if it is too short.
    pub fn split_ticket(report: &[u8]) -> Option<(u64, &[u8])> {
        let (ticket, message) = report.split_first_chunk()?;
        Some((u64::from_le_bytes(*ticket), message))
    }

    /// Whether this is a message of this kind about this boat.
    pub fn is_about(self, message: &[u8], vehicle: VehicleId, name: &str) -> bool {
        match self {
            Reported::Status => serde_json::from_slice::<GatewayStatus>(message)
                .is_ok_and(|status| status.vehicle == name),
            Reported::Link => {
                codec::decode::<LinkBytes>(message).is_ok_and(|bytes| bytes.vehicle == vehicle)
            }
        }
    }
}

/// An operator's command to a gateway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum OperatorCommand {
    /// Return the status.
    Status,
    /// Follow orders from now on, if every requirement is met.
    Arm,
    /// Stop following orders: standby.
    Disarm,
    /// Standby, and no other command until release.
    EStop,
    /// End the E-stop; the boat stays disarmed.
    Release,
    /// Hold position with the boat's own controller.
    StationKeep,
    /// Go to the emergency recovery point with the boat's own controller.
    GoToErp,
    /// Upload a mission and run it with the boat's own controller.
    Mission(Mission),
    /// Switch to a different mode of the boat's own controller.
    Mode(BoatMode),
}

/// A mode of a Surveyor's own controller beyond station keeping, recovery and missions. Only the
/// first is documented by the vendor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, strum::Display)]
#[serde(rename_all = "snake_case")]
#[strum(serialize_all = "snake_case")]
pub enum BoatMode {
    /// `C`: holds a heading at a thrust.
    #[strum(to_string = "heading {heading_deg:03.0} at {thrust_pct:.0} %")]
    Heading {
        /// True heading, degrees.
        heading_deg: f64,
        /// Thrust ahead, per cent.
        thrust_pct: f64,
    },
    /// `N`: river navigation.
    #[strum(to_string = "river navigation")]
    RiverNav,
    /// `I`: autopilot.
    Autopilot,
    /// `3`: calibration of the compass.
    #[strum(to_string = "compass calibration")]
    CompassCalibration,
    /// `D`: depth.
    Depth,
    /// `S`: direction of gravity.
    #[strum(to_string = "direction of gravity")]
    GravityVector,
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
    /// Whether the command requires the game's token. Status and stops do not.
    pub fn needs_token(&self) -> bool {
        !matches!(
            self,
            OperatorCommand::Status | OperatorCommand::Disarm | OperatorCommand::EStop
        )
    }
}

/// A command to all boats at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FleetCommand {
    /// Stop, and stay stopped.
    EStop,
    /// End the stop.
    Release,
}

/// A request to the control port of a gateway.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GatewayCommand {
    /// A command for one boat.
    Boat {
        /// The boat's name; gateways of other boats refuse.
        name: String,
        /// The command.
        command: OperatorCommand,
    },
    /// A command for all boats, including this gateway's.
    Fleet(FleetCommand),
}

impl GatewayCommand {
    /// A command for the boat with this name.
    pub fn boat(name: &str, command: OperatorCommand) -> GatewayCommand {
        let name = name.to_owned();
        GatewayCommand::Boat { name, command }
    }

    /// Whether the command only queries a boat's status.
    pub fn is_status(&self) -> bool {
        matches!(self, GatewayCommand::Boat { command, .. } if *command == OperatorCommand::Status)
    }

    /// Whether the command requires the game's token.
    pub fn needs_token(&self) -> bool {
        match self {
            GatewayCommand::Boat { command, .. } => command.needs_token(),
            GatewayCommand::Fleet(command) => *command != FleetCommand::EStop,
        }
    }
}

/// A mission that a boat's own controller runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mission {
    /// Throttle, per cent.
    pub throttle_pct: f64,
    /// The emergency recovery point: latitude and longitude, degrees.
    pub erp: [f64; 2],
    /// The waypoints, as pairs of latitude and longitude, degrees.
    pub waypoints: Vec<[f64; 2]>,
}

/// A gateway's reply to an operator.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OperatorReply {
    /// Why the command was refused.
    pub refused: Option<String>,
    /// The current status.
    pub status: GatewayStatus,
}

/// The status of a gateway and its boat.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GatewayStatus {
    /// The boat.
    pub vehicle: String,
    /// Address and port of its control port; absent in earlier versions.
    #[serde(default)]
    pub control: Option<String>,
    /// Time since the gateway's start, s.
    pub at_s: f64,
    /// The link to the boat: `up`, or the reason why it is down.
    pub link: String,
    /// The supervisor's state.
    pub state: String,
    /// Unmet requirements for arming, in plain words.
    pub missing: Vec<String>,
    /// Current alarms of the boat, in plain words: error code, leak, currents; absent in earlier
    /// versions.
    #[serde(default)]
    pub alarms: Vec<String>,
    /// The failsafes so far, newest last. Recordings of earlier versions call them trips.
    #[serde(alias = "trips")]
    pub failsafes: Vec<FailsafeReport>,
    /// Control mode reported by the boat: the Surveyor's letter.
    pub mode: Option<char>,
    /// Operator in control, as reported by the boat.
    pub operator: Option<String>,
    /// Navigation, if there is any.
    pub nav: Option<Nav>,
    /// Age of the last good fix, s.
    pub nav_age_s: Option<f64>,
    /// The geofence, once a game defines the field; absent in earlier versions.
    #[serde(default)]
    pub geofence: Option<GeofenceReport>,
    /// Age of mode and operator, s; absent in earlier versions.
    #[serde(default)]
    pub mode_age_s: Option<f64>,
    /// Battery, V.
    pub battery_v: Option<f64>,
    /// Charge left, per cent: reported by the boat, or else estimated from the voltage; absent in
    /// earlier versions.
    #[serde(default)]
    pub battery_pct: Option<f64>,
    /// Age of voltage and charge, s; absent in earlier versions.
    #[serde(default)]
    pub battery_age_s: Option<f64>,
    /// The last sentence sent to the boat.
    pub last_sent: String,
    /// In a dry run, the last sentence that would have been sent. The gateway sends standby
    /// instead.
    #[serde(default)]
    pub would_send: Option<String>,
    /// All counters, by name.
    pub counts: Vec<(String, u64)>,
    /// Median and 99th percentile of two latencies in µs: from incoming sentence to published
    /// topic, and from incoming order to outgoing sentence. Missing until measured.
    pub latency_us: [Option<[f64; 2]>; 2],
}

/// A boat's geofence, and the boat's distance from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GeofenceReport {
    /// The corners of the permitted water, in order.
    pub outline: Vec<Ned>,
    /// The corners of each keep-out.
    pub keep_out: Vec<Vec<Ned>>,
    /// Distance to the nearest edge of the geofence or of a keep-out, m; negative outside the
    /// permitted water.
    pub clearance_m: Option<f64>,
    /// Stopping distance for the current motion, m.
    pub stopping_m: Option<f64>,
    /// Predicted stopping position.
    pub stops_at: Option<Ned>,
}

/// A failsafe event: the supervisor stopped the boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailsafeReport {
    /// Time since the gateway's start, s.
    pub at_s: f64,
    /// The cause, in plain words.
    pub cause: String,
}
