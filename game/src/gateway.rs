//! How a gateway drives a real boat, and when it stops it.
//!
//! Everything is SI but for what the boat's own sentences count in: thrust is in per cent of full ahead.

use serde::{Deserialize, Serialize};

/// A gateway file, checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gateway {
    /// The file's stem.
    pub name: String,
    /// Whose heading and speed loops steer.
    pub drive: Drive,
    /// East of true north, rad; `None` asks the World Magnetic Model.
    pub declination_rad: Option<f64>,
    /// What the boat's headings count from.
    pub compass: CompassFrame,
    /// How often the boat hears from us at least, 1/s.
    pub rate_hz: f64,
    /// How old an order may grow, s.
    pub order_ttl_s: f64,
    /// How much may be asked of the boat.
    pub limits: Limits,
    /// What navigation must be like.
    pub nav: NavWatch,
    /// Where the boat must not be, nor be unable to stop before.
    pub fence: Geofence,
    /// When another real boat is too near.
    pub halt: Halt,
    /// When the battery is low, and what then.
    pub battery: BatteryWatch,
    /// How we know that the boat listens to us.
    pub control: ControlWatch,
    /// Our own heading and speed loops.
    pub loops: Loops,
    /// Time between two lines of a mission that is taken up, s.
    pub upload_gap_s: f64,
}

/// Whose heading and speed loops steer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Drive {
    /// Ours: the boat is sent thrust and thrust difference (mode T).
    Thrust,
    /// The boat's: it is sent heading and speed (mode G).
    Speed,
}

/// What a boat's headings count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CompassFrame {
    /// Magnetic north.
    Magnetic,
    /// True north.
    True,
}

/// How much may be asked of a boat.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Highest speed, m/s.
    pub speed_max_m_s: f64,
    /// Largest thrust either way, per cent.
    pub thrust_max_pct: f64,
    /// Largest thrust difference, per cent.
    pub difference_max_pct: f64,
    /// Fastest growth of either, per cent a second. To zero they go at once.
    pub slew_pct_s: f64,
}

/// What navigation must be like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NavWatch {
    /// Oldest fix and heading, s.
    pub age_max_s: f64,
    /// Lowest fix quality of GGA: 1 GPS, 2 differential, 4 and 5 RTK.
    pub quality_min: u8,
    /// Largest horizontal dilution of precision, where it is told.
    pub hdop_max: f64,
    /// A fix farther from the one before than the boat can sail in between, and this, is a jump, m.
    pub jump_m: f64,
    /// A position that stays the same to the last digit for this long under thrust is frozen, s.
    pub frozen_s: f64,
}

/// Where a boat must not be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Geofence {
    /// The fence lies this far outside of the field, m.
    pub margin_m: f64,
    /// How hard the boat slows down with thrust at zero, m/s²: v² / (2 a) is its way to rest.
    pub deceleration_m_s2: f64,
    /// Time until the boat begins to slow down, s.
    pub reaction_s: f64,
    /// It must be so for this long, s.
    pub debounce_s: f64,
}

/// When another real boat is too near: within a box about the bow that grows with speed, in which the boat would be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Halt {
    /// Length of the box at 2 m/s, from midships, m; 0 is no such watch.
    pub ahead_m: f64,
    /// Its width, m.
    pub width_m: f64,
    /// It must be empty for this long before the boat goes on, s.
    pub clear_s: f64,
}

/// When the battery is low.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatteryWatch {
    /// Lowest voltage, V; 0 is no such watch.
    pub volts_min: f64,
    /// It must be lower for this long, s.
    pub debounce_s: f64,
    /// What then.
    pub action: LowBattery,
}

/// What a boat with a low battery does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LowBattery {
    /// It stops.
    Standby,
    /// It keeps its station by its own means.
    StationKeep,
    /// It goes to its emergency recovery point by its own means.
    GoToErp,
}

/// How we know that a boat listens to us.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlWatch {
    /// For boats that never say who is in control: take it that we are.
    pub assumed: bool,
    /// How old the boat's word on it may grow, s.
    pub age_max_s: f64,
    /// A command that the boat has not shown after this time is not obeyed, s.
    pub echo_s: f64,
}

/// The Surveyor's thrust map, by the West Point missions of 2024: thrust in per cent, speed in m/s.
pub const SURVEYOR_THRUST_MAP: [(f64, f64); 7] =
    [(-100.0, -2.0), (0.0, 0.0), (20.0, 1.0), (40.0, 1.5), (60.0, 2.0), (70.0, 2.25), (100.0, 3.0)];

/// Our own heading and speed loops, for [`Drive::Thrust`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Loops {
    /// Thrust (per cent) and the speed (m/s) that it gives, both rising.
    pub thrust_map: Vec<(f64, f64)>,
    /// Thrust for a speed error, per cent per m/s.
    pub speed_pct_per_m_s: f64,
    /// Integral time of the speed loop, s.
    pub speed_integral_s: f64,
    /// Thrust difference for a heading error, per cent per rad.
    pub heading_pct_per_rad: f64,
    /// Thrust difference against a rate of turn, per cent per rad/s.
    pub turn_pct_per_rad_s: f64,
}
