//! How a gateway drives a real boat, and when it stops the boat.
//!
//! Units are SI, except where the boat's sentences use others: thrust is in per cent of full ahead.
//! These types also declare the keys of gateway files, like those in [`scenario::boat`].

mod check;

use crate::nmea::FixQuality;
use scenario::boat::ThrustAndSpeed;
use scenario::{Document, ScenarioFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a gateway drives a real boat, and when it stops the boat. The defaults are conservative, for
/// the SeaRobotics Surveyor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gateway {
    /// The file's stem.
    #[schemars(skip)]
    pub name: String,
    /// The boat's protocol.
    #[schemars(extend("default" = "surveyor"))]
    pub protocol: BoatProtocol,
    /// Whose heading and speed loops control the boat.
    #[schemars(extend("default" = "thrust"))]
    pub drive: Drive,
    /// Magnetic declination, rad, positive east. Default: World Magnetic Model at the field, today.
    #[schemars(
        description = "Magnetic declination, degrees, positive east. Default: World Magnetic Model at the field, today."
    )]
    #[schemars(rename = "declination_deg", range(min = -180, max = 180), extend("x-field" = "declination_rad"))]
    pub declination_rad: Option<f64>,
    /// North reference of a Surveyor's headings.
    #[schemars(extend("default" = "magnetic"))]
    pub compass: CompassFrame,
    /// Minimum rate of messages to the boat, 1/s.
    #[schemars(range(min = 1, max = 20), extend("default" = 10))]
    pub rate_hz: f64,
    /// Maximum age of an order before the boat stops, s.
    #[schemars(range(min = 0.1, max = 10), extend("default" = 1))]
    pub order_ttl_s: f64,
    /// Limits on set-points.
    pub limits: Limits,
    /// Requirements for navigation data; a violation stops the boat.
    pub nav: NavWatch,
    /// The area that the boat must not leave.
    pub geofence: Geofence,
    /// The box ahead of the boat; another real boat inside it stops this one.
    pub halt: Halt,
    /// When the battery counts as low.
    pub battery: BatteryWatch,
    /// Currents that raise alarms, without stopping the boat.
    pub currents: CurrentWatch,
    /// What the boat does after a failsafe.
    pub failsafe: FailsafeActions,
    /// How the gateway verifies that it controls the boat.
    pub control: ControlWatch,
    /// Whether arming requires a pre-flight check.
    pub preflight: PreflightRule,
    /// The gateway's heading and speed loops, for `drive` "thrust".
    pub loops: Loops,
    /// Switch commands, sent once in this order after each connection, when the gateway has
    /// control.
    #[schemars(length(max = 6))]
    pub startup_words: Vec<SwitchWord>,
    /// Time between two lines of a mission upload, s.
    #[schemars(range(min = 0.005, max = 5), extend("default" = 0.1))]
    pub upload_gap_s: f64,
    /// Settings for MAVLink.
    pub mavlink: Mavlink,
}

impl ScenarioFile for Gateway {
    type Keys = Gateway;
    const NAME: &'static str = "gateway";
    const FOLDER: &'static str = "gateways";

    fn check(document: &Document<Gateway>) -> Option<Gateway> {
        check::gateway(document)
    }
}

/// The gateway that an empty file describes.
///
/// # Panics
/// Never: every key has a default.
pub fn default_gateway() -> Gateway {
    scenario::default_of().expect("every key has a default")
}

/// A boat's protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BoatProtocol {
    /// NMEA sentences of a SeaRobotics Surveyor.
    Surveyor,
    /// MAVLink, as in ArduPilot Rover; headings are true.
    Mavlink,
}

/// Identities on a MAVLink network, and the meaning of a thrust difference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mavlink {
    /// The boat's system ID, 1 to 255; 0: first boat heard.
    #[schemars(range(min = 0, max = 255), extend("default" = 0))]
    pub boat_system: u8,
    /// The gateway's system ID, which ArduPilot's ground station failsafe watches.
    #[schemars(range(min = 1, max = 255), extend("default" = 255))]
    pub system: u8,
    /// The gateway's component ID.
    #[schemars(range(min = 1, max = 255), extend("default" = 190))]
    pub component: u8,
    /// Rate of turn for a thrust difference of 100 %, rad/s.
    #[schemars(description = "Rate of turn for a thrust difference of 100 %, degrees/s.")]
    #[schemars(rename = "turn_rate_max_deg_s", range(min = 1, max = 360))]
    #[schemars(extend("x-field" = "turn_rate_max_rad_s", "default" = 90))]
    pub turn_rate_max_rad_s: f64,
}

/// Whose loops control the boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// The gateway's: the boat receives thrust and thrust difference, PSEAC mode T (MAVLink:
    /// SET_ATTITUDE_TARGET).
    Thrust,
    /// The boat's: it receives heading and speed, PSEAC mode G (MAVLink:
    /// SET_POSITION_TARGET_LOCAL_NED).
    Speed,
}

/// A switch command: the fifth field of PSEAC.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
pub enum SwitchWord {
    /// Thrusters on.
    ThrOn,
    /// Thrusters off.
    ThrOff,
    /// Satellite receiver on.
    GpsOn,
    /// Satellite receiver off.
    GpsOff,
    /// Sonar on.
    SonarOn,
    /// Sonar off.
    SonarOff,
}

impl SwitchWord {
    /// The word as sent.
    pub fn text(self) -> &'static str {
        match self {
            SwitchWord::ThrOn => "THR_ON",
            SwitchWord::ThrOff => "THR_OFF",
            SwitchWord::GpsOn => "GPS_ON",
            SwitchWord::GpsOff => "GPS_OFF",
            SwitchWord::SonarOn => "SONAR_ON",
            SwitchWord::SonarOff => "SONAR_OFF",
        }
    }
}

/// The north reference of headings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CompassFrame {
    /// Magnetic north.
    Magnetic,
    /// True north.
    True,
}

/// Limits on set-points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Limits {
    /// Maximum speed, m/s.
    #[schemars(range(min = 0.1, max = 20), extend("default" = 3))]
    pub speed_max_m_s: f64,
    /// Maximum thrust, %.
    #[schemars(range(min = 1, max = 100), extend("default" = 70))]
    pub thrust_max_pct: f64,
    /// Maximum thrust difference, %.
    #[schemars(range(min = 1, max = 100), extend("default" = 50))]
    pub difference_max_pct: f64,
    /// Maximum rate of increase of thrust and difference, %/s; decreases are immediate.
    #[schemars(range(min = 1, max = 10000), extend("default" = 100))]
    pub slew_pct_s: f64,
}

/// Maximum number of corners of a geofence polygon: every status contains all of them.
const CORNERS_MAX: usize = 100;

/// Requirements for navigation data; a violation stops the boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NavWatch {
    /// Maximum age of fix and heading, s.
    #[schemars(range(min = 0.1, max = 10), extend("default" = 1.5))]
    pub age_max_s: f64,
    /// Minimum GGA fix quality, from worst to best: 1 GPS, 2 differential or 3 PPS, 5 RTK float, 4
    /// RTK fixed.
    #[schemars(with = "u8", range(min = 1, max = 5), extend("default" = 1))]
    pub quality_min: FixQuality,
    /// Maximum horizontal dilution of precision, if reported.
    #[schemars(range(min = 0.5, max = 50), extend("default" = 5))]
    pub hdop_max: f64,
    /// A position jumps if it moves farther than the boat can between two fixes, plus this
    /// distance, m.
    #[schemars(range(min = 0.5, max = 100), extend("default" = 5))]
    pub jump_m: f64,
    /// Time after which a position with identical digits under thrust counts as frozen, s.
    #[schemars(range(min = 0.5, max = 60), extend("default" = 3))]
    pub frozen_s: f64,
}

/// The geofence stops a boat that is outside, or unable to stop inside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Geofence {
    /// Corners [latitude, longitude] in order, either way round, degrees; sides must not cross.
    /// Default: the field's rectangle plus `margin_m`.
    #[schemars(length(min = 3, max = CORNERS_MAX), inner(inner(range(min = -180, max = 180))))]
    pub polygon: Option<Vec<[f64; 2]>>,
    /// Polygons inside the geofence that the boat must not enter; it must be able to stop before
    /// reaching them.
    #[schemars(length(max = 50))]
    #[schemars(inner(length(min = 3, max = CORNERS_MAX), inner(inner(range(min = -180, max = 180)))))]
    pub keep_out: Vec<Vec<[f64; 2]>>,
    /// Margin around the field, m; for a geofence without `polygon`.
    #[schemars(range(min = 0, max = 10000), extend("default" = 30))]
    pub margin_m: f64,
    /// Measured stopping distances at zero thrust: pairs of speed through water (m/s) and distance
    /// (m). They replace `deceleration_m_s2`.
    #[schemars(with = "Vec<SpeedAndDistance>", length(max = 50), extend("default" = Vec::<f64>::new()))]
    pub coast_m: Vec<(f64, f64)>,
    /// Deceleration at zero thrust, m/s². The resistance in the boat file is used instead where it
    /// gives a longer distance.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 0.25))]
    pub deceleration_m_s2: f64,
    /// Time before deceleration starts, s; if lower, `debounce_s` plus 0.5 s is used.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub reaction_s: f64,
    /// How long a violation must last before it counts, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.5))]
    pub debounce_s: f64,
}

/// A speed, m/s, and the stopping distance from it, m.
#[derive(JsonSchema)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema of a pair")]
struct SpeedAndDistance(
    #[schemars(range(min = 0.1, max = 60))] f64,
    #[schemars(range(min = 0.1, max = 10000))] f64,
);

/// A box ahead of the boat; its length is proportional to the speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Halt {
    /// Length at 2 m/s, from midships, m; 0: off.
    #[schemars(range(min = 0, max = 100), extend("default" = 7))]
    pub ahead_m: f64,
    /// Width, m.
    #[schemars(range(min = 0.5, max = 100), extend("default" = 3))]
    pub width_m: f64,
    /// Time the box must be empty before the boat continues, s.
    #[schemars(range(min = 0, max = 60), extend("default" = 1))]
    pub clear_s: f64,
}

/// When the battery counts as low.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BatteryWatch {
    /// Minimum voltage, V; 0: off.
    #[schemars(range(min = 0, max = 1000), extend("default" = 22))]
    pub volts_min: f64,
    /// How long the voltage must stay below `volts_min` to count as low, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 5))]
    pub debounce_s: f64,
    /// Lithium cells in series, to estimate the charge from the voltage; 0: unknown.
    #[schemars(range(min = 0, max = 200), extend("default" = 7))]
    pub cells: u8,
}

/// Currents reported by the boat. They only raise alarms: their accuracy is unpublished.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurrentWatch {
    /// Maximum thruster current, A; 0: off. A fouled propeller draws more.
    #[schemars(range(min = 0, max = 1000), extend("default" = 45))]
    pub thruster_max_a: f64,
    /// Minimum current of a thruster, A, if both are ordered to 20 % or more and the other one
    /// draws more than this; 0: off.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0.5))]
    pub thruster_min_a: f64,
    /// Current from which a bilge pump counts as running, A; 0: off.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0.1))]
    pub bilge_a: f64,
    /// How long a current must last before it counts, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 3))]
    pub debounce_s: f64,
}

/// What the boat does after a failsafe for one of these causes; any other cause stops it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FailsafeActions {
    /// No fresh order.
    #[schemars(extend("default" = "standby"))]
    pub order_stale: FailsafeAction,
    /// Outside the geofence, or unable to stop inside.
    #[schemars(extend("default" = "standby"))]
    pub geofence: FailsafeAction,
    /// Low battery.
    #[schemars(extend("default" = "standby"))]
    pub battery_low: FailsafeAction,
    /// The gateway hung.
    #[schemars(extend("default" = "standby"))]
    pub hung: FailsafeAction,
    /// Time after a failsafe for lack of fresh orders within which the boat may rearm itself, s,
    /// once orders have been fresh for 1 s and the boat is ready; 0: never.
    #[schemars(range(min = 0, max = 600), extend("default" = 0))]
    pub rearm_within_s: f64,
}

/// What a boat does after a failsafe; it stops if it cannot do this.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FailsafeAction {
    /// It stops.
    Standby,
    /// It keeps station on its own.
    StationKeep,
    /// It drives to its emergency recovery point on its own, if the gateway uploaded one inside the
    /// geofence.
    GoToErp,
}

/// How the gateway verifies that it controls the boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ControlWatch {
    /// Whether to assume control, for boats that never report who has it.
    #[schemars(extend("default" = false))]
    pub assumed: bool,
    /// Maximum age of the boat's report of who is in control, s.
    #[schemars(range(min = 0.1, max = 30), extend("default" = 2))]
    pub age_max_s: f64,
    /// Time within which the boat must echo a command, s.
    #[schemars(range(min = 0.2, max = 30), extend("default" = 1.5))]
    pub echo_s: f64,
    /// Maximum difference between echoed and sent thrust, %; 200: off.
    #[schemars(range(min = 1, max = 200), extend("default" = 2))]
    pub echo_thrust_pct: f64,
}

/// Whether arming requires a pre-flight check.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PreflightRule {
    /// Whether arming requires the report of a passed check.
    #[schemars(extend("default" = false))]
    pub required: bool,
    /// Maximum age of the report, h.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 24))]
    pub age_max_h: f64,
}

/// The Surveyor's thrust map, from the 2024 West Point missions: thrust in per cent, speed in m/s.
pub const SURVEYOR_THRUST_MAP: [(f64, f64); 7] = [
    (-100.0, -2.0),
    (0.0, 0.0),
    (20.0, 1.0),
    (40.0, 1.5),
    (60.0, 2.0),
    (70.0, 2.25),
    (100.0, 3.0),
];

/// The gateway's heading and speed loops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loops {
    /// Pairs of thrust (%) and resulting speed (m/s), both ascending.
    #[schemars(with = "Vec<ThrustAndSpeed>", extend("default" = SURVEYOR_THRUST_MAP))]
    pub thrust_map: Vec<(f64, f64)>,
    /// Thrust per speed error, % per m/s.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub speed_pct_per_m_s: f64,
    /// Integral time of the speed loop, s.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 5))]
    pub speed_integral_s: f64,
    /// Thrust difference per heading error, % per rad.
    #[schemars(description = "Thrust difference per heading error, % per degree.")]
    #[schemars(rename = "heading_pct_per_deg", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "heading_pct_per_rad", "default" = 0.9))]
    pub heading_pct_per_rad: f64,
    /// Thrust difference opposing the rate of turn, % per rad/s.
    #[schemars(description = "Thrust difference opposing the rate of turn, % per degree/s.")]
    #[schemars(rename = "turn_pct_per_deg_s", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "turn_pct_per_rad_s", "default" = 1.4))]
    pub turn_pct_per_rad_s: f64,
}
