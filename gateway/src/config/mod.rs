//! How a gateway drives a real boat, and when it stops it.
//!
//! Everything is SI but for what the boat's own sentences count in: thrust is in per cent of full ahead. These
//! types also declare the keys of gateway files, as those in [`scenario::boat`] do.

mod check;

use crate::nmea::FixQuality;
use scenario::boat::ThrustAndSpeed;
use scenario::{Diagnostics, Document, ScenarioFile};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a gateway drives a real boat, and when it stops it. The defaults are for the SeaRobotics Surveyor, and careful.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gateway {
    /// The file's stem.
    #[schemars(skip)]
    pub name: String,
    /// What the boat speaks.
    #[schemars(extend("default" = "surveyor"))]
    pub protocol: BoatProtocol,
    /// Whose heading and speed loops steer.
    #[schemars(extend("default" = "thrust"))]
    pub drive: Drive,
    /// East of true north, rad. Default by the World Magnetic Model, at the field and today.
    #[schemars(
        description = "East of true north, degrees. Default by the World Magnetic Model, at the field and today."
    )]
    #[schemars(rename = "declination_deg", range(min = -180, max = 180), extend("x-field" = "declination_rad"))]
    pub declination_rad: Option<f64>,
    /// What a Surveyor's headings count from.
    #[schemars(extend("default" = "magnetic"))]
    pub compass: CompassFrame,
    /// How often the boat hears from us at least, 1/s.
    #[schemars(range(min = 1, max = 20), extend("default" = 10))]
    pub rate_hz: f64,
    /// How old an order may grow before the boat is stopped, s.
    #[schemars(range(min = 0.1, max = 10), extend("default" = 1))]
    pub order_ttl_s: f64,
    /// How much may be asked of the boat.
    pub limits: Limits,
    /// What navigation must be like.
    pub nav: NavWatch,
    /// Where the boat must not be, nor be unable to stop before.
    pub geofence: Geofence,
    /// When another real boat is too near: the boat stops until it is clear.
    pub halt: Halt,
    /// When the battery is low.
    pub battery: BatteryWatch,
    /// Currents that are no good: an alarm each, which stops nothing.
    pub currents: CurrentWatch,
    /// What a boat does after a failsafe, by its cause; after one that is not named here, it stops.
    pub failsafe: FailsafeActions,
    /// How we know that the boat listens to us.
    pub control: ControlWatch,
    /// Whether the boat is armed without a pre-flight check.
    pub preflight: PreflightRule,
    /// Our own heading and speed loops, where `drive` is "thrust".
    pub loops: Loops,
    /// What is switched on and off, in this order, each time that the boat's link is up and we have control.
    #[schemars(length(max = 6))]
    pub startup_words: Vec<SwitchWord>,
    /// Time between two lines of a mission that is taken up, s.
    #[schemars(range(min = 0.005, max = 5), extend("default" = 0.1))]
    pub upload_gap_s: f64,
    /// For a boat that speaks MAVLink.
    pub mavlink: Mavlink,
}

impl ScenarioFile for Gateway {
    type Keys = Gateway;
    const NAME: &'static str = "gateway";
    const FOLDER: &'static str = "gateways";

    fn check(diagnostics: &mut Diagnostics, document: &Document<Gateway>) -> Option<Gateway> {
        check::gateway(diagnostics, document)
    }
}

/// The gateway of a file that says nothing.
///
/// # Panics
/// Never: every key has a default.
#[must_use]
pub fn default_gateway() -> Gateway {
    scenario::default_of().expect("every key has a default")
}

/// What a boat speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BoatProtocol {
    /// The sentences of a SeaRobotics Surveyor.
    Surveyor,
    /// MAVLink, as ArduPilot's Rover and boats speak it; headings are true.
    Mavlink,
}

/// Who is who on a MAVLink network, and what a thrust difference means there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mavlink {
    /// The boat's system, 1 to 255; at 0, the first boat that is heard.
    #[schemars(range(min = 0, max = 255), extend("default" = 0))]
    pub boat_system: u8,
    /// Our own system. ArduPilot's failsafe for a lost ground station watches the one that its parameter for that names, 255 by default.
    #[schemars(range(min = 1, max = 255), extend("default" = 255))]
    pub system: u8,
    /// Our own component.
    #[schemars(range(min = 1, max = 255), extend("default" = 190))]
    pub component: u8,
    /// Rate of turn that a thrust difference of 100 % asks for, rad/s.
    #[schemars(description = "Rate of turn that a thrust difference of 100 % asks for, degrees a second.")]
    #[schemars(rename = "turn_rate_max_deg_s", range(min = 1, max = 360))]
    #[schemars(extend("x-field" = "turn_rate_max_rad_s", "default" = 90))]
    pub turn_rate_max_rad_s: f64,
}

/// Whose loops steer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Ours: the boat is sent thrust and thrust difference, PSEAC mode T (MAVLink: SET_ATTITUDE_TARGET).
    Thrust,
    /// The boat's: it is sent heading and speed, PSEAC mode G (MAVLink: SET_POSITION_TARGET_LOCAL_NED).
    Speed,
}

/// A switch of the boat, as the fifth field of PSEAC has it.
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
    /// As it is sent.
    #[must_use]
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

/// What headings count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CompassFrame {
    /// Magnetic north.
    Magnetic,
    /// True north.
    True,
}

/// How much may be asked of the boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Limits {
    /// Highest speed, m/s.
    #[schemars(range(min = 0.1, max = 20), extend("default" = 3))]
    pub speed_max_m_s: f64,
    /// Largest thrust, per cent.
    #[schemars(range(min = 1, max = 100), extend("default" = 70))]
    pub thrust_max_pct: f64,
    /// Largest thrust difference, per cent.
    #[schemars(range(min = 1, max = 100), extend("default" = 50))]
    pub difference_max_pct: f64,
    /// Fastest growth of either, per cent a second. To zero they go at once.
    #[schemars(range(min = 1, max = 10000), extend("default" = 100))]
    pub slew_pct_s: f64,
}

/// The most corners of a polygon of a geofence: all of them travel with every status.
const CORNERS_MAX: usize = 100;

/// What navigation must be like; what is not makes the boat stop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NavWatch {
    /// Oldest fix and heading, s.
    #[schemars(range(min = 0.1, max = 10), extend("default" = 1.5))]
    pub age_max_s: f64,
    /// Lowest fix quality of GGA, from worst to best: 1 GPS, 2 differential or 3 PPS, 5 RTK float, 4 RTK fixed.
    #[schemars(with = "u8", range(min = 1, max = 5), extend("default" = 1))]
    pub quality_min: FixQuality,
    /// Largest horizontal dilution of precision, where it is told.
    #[schemars(range(min = 0.5, max = 50), extend("default" = 5))]
    pub hdop_max: f64,
    /// A fix farther from the one before than the boat can sail in between, and this, is a jump, m.
    #[schemars(range(min = 0.5, max = 100), extend("default" = 5))]
    pub jump_m: f64,
    /// A position that stays the same to the last digit for this long under thrust is frozen, s.
    #[schemars(range(min = 0.5, max = 60), extend("default" = 3))]
    pub frozen_s: f64,
}

/// The geofence: a boat outside, or unable to stop inside, is stopped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Geofence {
    /// Its corners in order, either way round, with no two sides crossing: [latitude, longitude], degrees. Default: the
    /// field's rectangle, and the margin round it.
    #[schemars(length(min = 3, max = CORNERS_MAX), inner(inner(range(min = -180, max = 180))))]
    pub polygon: Option<Vec<[f64; 2]>>,
    /// Polygons within it where the boat must not be either, nor be unable to stop before; each like `polygon`.
    #[schemars(length(max = 50))]
    #[schemars(inner(length(min = 3, max = CORNERS_MAX), inner(inner(range(min = -180, max = 180)))))]
    pub keep_out: Vec<Vec<[f64; 2]>>,
    /// How far outside of the field it lies without a `polygon`, m.
    #[schemars(range(min = 0, max = 10000), extend("default" = 30))]
    pub margin_m: f64,
    /// Measured distances to rest at zero thrust: pairs of speed through the water in m/s and distance in m. With them,
    /// `deceleration_m_s2` does not count.
    #[schemars(with = "Vec<SpeedAndDistance>", length(max = 50), extend("default" = Vec::<f64>::new()))]
    pub coast_m: Vec<(f64, f64)>,
    /// How hard the boat slows down with thrust at zero, m/s². The boat file's resistance counts where it stops it later.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 0.25))]
    pub deceleration_m_s2: f64,
    /// Time until it begins to slow down, s; at least `debounce_s` and half a second.
    #[schemars(range(min = 0, max = 10), extend("default" = 1))]
    pub reaction_s: f64,
    /// It must be so for this long, s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.5))]
    pub debounce_s: f64,
}

/// A speed, m/s, and the distance in which the boat comes to rest from it, m.
#[derive(JsonSchema)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema of a pair")]
struct SpeedAndDistance(#[schemars(range(min = 0.1, max = 60))] f64, #[schemars(range(min = 0.1, max = 10000))] f64);

/// A box about the bow, as long as the boat is fast, in which no other real boat may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Halt {
    /// Its length at 2 m/s, from midships, m (no such watch at 0).
    #[schemars(range(min = 0, max = 100), extend("default" = 7))]
    pub ahead_m: f64,
    /// Its width, m.
    #[schemars(range(min = 0.5, max = 100), extend("default" = 3))]
    pub width_m: f64,
    /// It must be empty for this long before the boat goes on, s.
    #[schemars(range(min = 0, max = 60), extend("default" = 1))]
    pub clear_s: f64,
}

/// The battery.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BatteryWatch {
    /// Lowest voltage, V (no such watch at 0).
    #[schemars(range(min = 0, max = 1000), extend("default" = 22))]
    pub volts_min: f64,
    /// It must be lower for this long, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 5))]
    pub debounce_s: f64,
}

/// The currents that a boat reports. None of these stops it: how exact they are is not published.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurrentWatch {
    /// Highest current of a thruster, A (no such watch at 0): a line in the propeller draws more.
    #[schemars(range(min = 0, max = 1000), extend("default" = 45))]
    pub thruster_max_a: f64,
    /// Lowest current of a thruster while it is ordered 20 % or more, and the other one draws more than this, A (no such watch at 0).
    #[schemars(range(min = 0, max = 1000), extend("default" = 0.5))]
    pub thruster_min_a: f64,
    /// From this current on a bilge pump runs, A (no such watch at 0): the boat takes in water.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0.1))]
    pub bilge_a: f64,
    /// It must be so for this long, s.
    #[schemars(range(min = 0, max = 600), extend("default" = 3))]
    pub debounce_s: f64,
}

/// What a boat does after a failsafe, by its cause. Those after which it cannot be told anything, does not know where it is or points, or
/// is not moved by its thrusters, are not here: it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FailsafeActions {
    /// No fresh order came.
    #[schemars(extend("default" = "standby"))]
    pub order_stale: FailsafeAction,
    /// It is outside of the geofence, or unable to stop inside.
    #[schemars(extend("default" = "standby"))]
    pub geofence: FailsafeAction,
    /// Its battery is low.
    #[schemars(extend("default" = "standby"))]
    pub battery_low: FailsafeAction,
    /// The gateway hung.
    #[schemars(extend("default" = "standby"))]
    pub hung: FailsafeAction,
}

/// What a boat does after a failsafe, as far as it can: else it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FailsafeAction {
    /// It stops.
    Standby,
    /// It keeps its station by its own means.
    StationKeep,
    /// It goes to its emergency recovery point by its own means, if the gateway uploaded one inside of the geofence.
    GoToErp,
}

/// How we know that the boat listens to us.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ControlWatch {
    /// For boats that never say who is in control: take it that we are.
    #[schemars(extend("default" = false))]
    pub assumed: bool,
    /// How old the boat's word on it may grow, s.
    #[schemars(range(min = 0.1, max = 30), extend("default" = 2))]
    pub age_max_s: f64,
    /// A command that the boat does not show after this time is not followed, s.
    #[schemars(range(min = 0.2, max = 30), extend("default" = 1.5))]
    pub echo_s: f64,
    /// How far the thrust that the boat shows may be from what it was sent, per cent (no such watch at 200).
    #[schemars(range(min = 1, max = 200), extend("default" = 2))]
    pub echo_thrust_pct: f64,
}

/// Whether a boat is armed without a pre-flight check.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PreflightRule {
    /// Arming is refused without the report of a passed one.
    #[schemars(extend("default" = false))]
    pub required: bool,
    /// How old the report may grow, h.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 24))]
    pub age_max_h: f64,
}

/// The Surveyor's thrust map, by the West Point missions of 2024: thrust in per cent, speed in m/s.
pub const SURVEYOR_THRUST_MAP: [(f64, f64); 7] =
    [(-100.0, -2.0), (0.0, 0.0), (20.0, 1.0), (40.0, 1.5), (60.0, 2.0), (70.0, 2.25), (100.0, 3.0)];

/// Our own heading and speed loops.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Loops {
    /// Pairs of thrust in per cent and the speed in m/s that it gives, both rising.
    #[schemars(with = "Vec<ThrustAndSpeed>", extend("default" = SURVEYOR_THRUST_MAP))]
    pub thrust_map: Vec<(f64, f64)>,
    /// Thrust for a speed error, per cent per m/s.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub speed_pct_per_m_s: f64,
    /// Integral time of the speed loop, s.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 5))]
    pub speed_integral_s: f64,
    /// Thrust difference for a heading error, per cent per rad.
    #[schemars(description = "Thrust difference for a heading error, per cent per degree.")]
    #[schemars(rename = "heading_pct_per_deg", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "heading_pct_per_rad", "default" = 0.9))]
    pub heading_pct_per_rad: f64,
    /// Thrust difference against a rate of turn, per cent per rad/s.
    #[schemars(description = "Thrust difference against a rate of turn, per cent per degree a second.")]
    #[schemars(rename = "turn_pct_per_deg_s", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "turn_pct_per_rad_s", "default" = 1.4))]
    pub turn_pct_per_rad_s: f64,
}
