//! A gateway file as typed.

use super::{At, Pair};
use crate::gateway::{CompassFrame, Drive, LowBattery};
use schemars::JsonSchema;
use serde::Deserialize;

/// How a gateway drives a real boat, and when it stops it. The defaults are for the SeaRobotics Surveyor, and careful.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall gateway")]
pub(in crate::scenario) struct RawGateway {
    /// Another gateway file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Whose heading and speed loops steer. Default "thrust".
    pub(in crate::scenario) drive: Option<RawDrive>,
    /// East of true north, degrees: -180 to 180. Default by the World Magnetic Model, at the field and today.
    pub(in crate::scenario) declination_deg: Option<At<f64>>,
    /// What the boat's headings count from. Default "magnetic".
    pub(in crate::scenario) compass: Option<RawCompassFrame>,
    /// How often the boat hears from us at least, 1/s: 1 to 20. Default 10.
    pub(in crate::scenario) rate_hz: Option<At<f64>>,
    /// How old an order may grow before the boat is stopped, s: 0.1 to 10. Default 1.
    pub(in crate::scenario) order_ttl_s: Option<At<f64>>,
    /// Time between two lines of a mission that is taken up, s: 0.005 to 5. Default 0.1.
    pub(in crate::scenario) upload_gap_s: Option<At<f64>>,
    /// How much may be asked of the boat.
    pub(in crate::scenario) limits: Option<RawLimits>,
    /// What navigation must be like.
    pub(in crate::scenario) nav: Option<RawNavWatch>,
    /// Where the boat must not be, nor be unable to stop before.
    pub(in crate::scenario) fence: Option<RawGeofence>,
    /// When another real boat is too near: the boat stops until it is clear.
    pub(in crate::scenario) halt: Option<RawHalt>,
    /// When the battery is low, and what then.
    pub(in crate::scenario) battery: Option<RawBatteryWatch>,
    /// How we know that the boat listens to us.
    pub(in crate::scenario) control: Option<RawControlWatch>,
    /// Our own heading and speed loops, where `drive` is "thrust".
    pub(in crate::scenario) loops: Option<RawLoops>,
}

/// Whose loops steer.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Drive")]
pub(in crate::scenario) enum RawDrive {
    /// Ours: the boat is sent thrust and thrust difference, PSEAC mode T.
    Thrust,
    /// The boat's: it is sent heading and speed, PSEAC mode G.
    Speed,
}

/// What headings count from.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "CompassFrame")]
pub(in crate::scenario) enum RawCompassFrame {
    /// Magnetic north.
    Magnetic,
    /// True north.
    True,
}

/// How much may be asked of the boat.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Limits")]
pub(in crate::scenario) struct RawLimits {
    /// Highest speed, m/s: 0.1 to 20. Default 3.
    pub(in crate::scenario) speed_max_m_s: Option<At<f64>>,
    /// Largest thrust, per cent: 1 to 100. Default 70.
    pub(in crate::scenario) thrust_max_pct: Option<At<f64>>,
    /// Largest thrust difference, per cent: 1 to 100. Default 50.
    pub(in crate::scenario) difference_max_pct: Option<At<f64>>,
    /// Fastest growth of either, per cent a second: 1 to 10000. Default 100. To zero they go at once.
    pub(in crate::scenario) slew_pct_s: Option<At<f64>>,
}

/// What navigation must be like; what is not makes the boat stop.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "NavWatch")]
pub(in crate::scenario) struct RawNavWatch {
    /// Oldest fix and heading, s: 0.1 to 10. Default 1.5.
    pub(in crate::scenario) age_max_s: Option<At<f64>>,
    /// Lowest fix quality of GGA (1 GPS, 2 differential, 4 and 5 RTK): 1 to 8. Default 1.
    pub(in crate::scenario) quality_min: Option<At<i64>>,
    /// Largest horizontal dilution of precision, where it is told: 0.5 to 50. Default 5.
    pub(in crate::scenario) hdop_max: Option<At<f64>>,
    /// A fix farther from the one before than the boat can sail in between, and this, is a jump, m: 0.5 to 100. Default 5.
    pub(in crate::scenario) jump_m: Option<At<f64>>,
    /// A position that stays the same to the last digit for this long under thrust is frozen, s: 0.5 to 60. Default 3.
    pub(in crate::scenario) frozen_s: Option<At<f64>>,
}

/// The fence round the field: a boat outside, or unable to stop inside, is stopped.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Geofence")]
pub(in crate::scenario) struct RawGeofence {
    /// How far outside of the field it lies, m: 0 to 10000. Default 30.
    pub(in crate::scenario) margin_m: Option<At<f64>>,
    /// How hard the boat slows down with thrust at zero, m/s²: 0.01 to 10. Default 0.25.
    pub(in crate::scenario) deceleration_m_s2: Option<At<f64>>,
    /// Time until it begins to slow down, s: 0 to 10. Default 1.
    pub(in crate::scenario) reaction_s: Option<At<f64>>,
    /// It must be so for this long, s: 0 to 10. Default 0.5.
    pub(in crate::scenario) debounce_s: Option<At<f64>>,
}

/// A box about the bow, as long as the boat is fast, in which no other real boat may be.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Halt")]
pub(in crate::scenario) struct RawHalt {
    /// Its length at 2 m/s, from midships, m: 0 (no such watch) to 100. Default 7.
    pub(in crate::scenario) ahead_m: Option<At<f64>>,
    /// Its width, m: 0.5 to 100. Default 3.
    pub(in crate::scenario) width_m: Option<At<f64>>,
    /// It must be empty for this long before the boat goes on, s: 0 to 60. Default 1.
    pub(in crate::scenario) clear_s: Option<At<f64>>,
}

/// The battery.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "BatteryWatch")]
pub(in crate::scenario) struct RawBatteryWatch {
    /// Lowest voltage, V: 0 (no such watch) to 1000. Default 22.
    pub(in crate::scenario) volts_min: Option<At<f64>>,
    /// It must be lower for this long, s: 0 to 600. Default 5.
    pub(in crate::scenario) debounce_s: Option<At<f64>>,
    /// What then. Default "standby".
    pub(in crate::scenario) action: Option<RawLowBattery>,
}

/// What a boat with a low battery does.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "LowBattery")]
pub(in crate::scenario) enum RawLowBattery {
    /// It stops.
    Standby,
    /// It keeps its station by its own means.
    StationKeep,
    /// It goes to its emergency recovery point by its own means.
    GoToErp,
}

/// How we know that the boat listens to us.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "ControlWatch")]
pub(in crate::scenario) struct RawControlWatch {
    /// For boats that never say who is in control: take it that we are. Default false.
    pub(in crate::scenario) assumed: Option<At<bool>>,
    /// How old the boat's word on it may grow, s: 0.1 to 30. Default 2.
    pub(in crate::scenario) age_max_s: Option<At<f64>>,
    /// A command that the boat does not show after this time is not obeyed, s: 0.2 to 30. Default 1.5.
    pub(in crate::scenario) echo_s: Option<At<f64>>,
}

/// Our own heading and speed loops.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Loops")]
pub(in crate::scenario) struct RawLoops {
    /// Pairs of thrust in per cent and the speed in m/s that it gives, both rising. Default the Surveyor's, as published.
    pub(in crate::scenario) thrust_map: Option<At<Vec<At<Pair>>>>,
    /// Thrust for a speed error, per cent per m/s: 0 to 1000. Default 15.
    pub(in crate::scenario) speed_pct_per_m_s: Option<At<f64>>,
    /// Integral time of the speed loop, s: 0.1 to 1000. Default 5.
    pub(in crate::scenario) speed_integral_s: Option<At<f64>>,
    /// Thrust difference for a heading error, per cent per degree: 0 to 100. Default 0.9.
    pub(in crate::scenario) heading_pct_per_deg: Option<At<f64>>,
    /// Thrust difference against a rate of turn, per cent per degree a second: 0 to 100. Default 1.4.
    pub(in crate::scenario) turn_pct_per_deg_s: Option<At<f64>>,
}

impl From<RawDrive> for Drive {
    fn from(raw: RawDrive) -> Drive {
        match raw {
            RawDrive::Thrust => Drive::Thrust,
            RawDrive::Speed => Drive::Speed,
        }
    }
}

impl From<RawCompassFrame> for CompassFrame {
    fn from(raw: RawCompassFrame) -> CompassFrame {
        match raw {
            RawCompassFrame::Magnetic => CompassFrame::Magnetic,
            RawCompassFrame::True => CompassFrame::True,
        }
    }
}

impl From<RawLowBattery> for LowBattery {
    fn from(raw: RawLowBattery) -> LowBattery {
        match raw {
            RawLowBattery::Standby => LowBattery::Standby,
            RawLowBattery::StationKeep => LowBattery::StationKeep,
            RawLowBattery::GoToErp => LowBattery::GoToErp,
        }
    }
}
