//! A gateway file as typed.

use super::ThrustAndSpeed;
use crate::gateway::{
    BatteryWatch, CompassFrame, ControlWatch, Drive, Geofence, Halt, Limits, NavWatch, SURVEYOR_THRUST_MAP,
};
use schemars::JsonSchema;
use serde::Deserialize;

/// How a gateway drives a real boat, and when it stops it. The defaults are for the SeaRobotics Surveyor, and careful.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Gateway {
    /// Whose heading and speed loops steer.
    #[schemars(extend("default" = "thrust"))]
    pub(crate) drive: Drive,
    /// East of true north, degrees. Default by the World Magnetic Model, at the field and today.
    #[schemars(range(min = -180, max = 180))]
    pub(crate) declination_deg: Option<f64>,
    /// What the boat's headings count from.
    #[schemars(extend("default" = "magnetic"))]
    pub(crate) compass: CompassFrame,
    /// How often the boat hears from us at least, 1/s.
    #[schemars(range(min = 1, max = 20), extend("default" = 10))]
    pub(crate) rate_hz: f64,
    /// How old an order may grow before the boat is stopped, s.
    #[schemars(range(min = 0.1, max = 10), extend("default" = 1))]
    pub(crate) order_ttl_s: f64,
    /// Time between two lines of a mission that is taken up, s.
    #[schemars(range(min = 0.005, max = 5), extend("default" = 0.1))]
    pub(crate) upload_gap_s: f64,
    /// How much may be asked of the boat.
    pub(crate) limits: Limits,
    /// What navigation must be like.
    pub(crate) nav: NavWatch,
    /// Where the boat must not be, nor be unable to stop before.
    pub(crate) geofence: Geofence,
    /// When another real boat is too near: the boat stops until it is clear.
    pub(crate) halt: Halt,
    /// When the battery is low, and what then.
    pub(crate) battery: BatteryWatch,
    /// How we know that the boat listens to us.
    pub(crate) control: ControlWatch,
    /// Our own heading and speed loops, where `drive` is "thrust".
    pub(crate) loops: Loops,
}

/// Our own heading and speed loops.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Loops {
    /// Pairs of thrust in per cent and the speed in m/s that it gives, both rising.
    #[schemars(extend("default" = SURVEYOR_THRUST_MAP))]
    pub(crate) thrust_map: Vec<ThrustAndSpeed>,
    /// Thrust for a speed error, per cent per m/s.
    #[schemars(range(min = 0, max = 1000), extend("default" = 15))]
    pub(crate) speed_pct_per_m_s: f64,
    /// Integral time of the speed loop, s.
    #[schemars(range(min = 0.1, max = 1000), extend("default" = 5))]
    pub(crate) speed_integral_s: f64,
    /// Thrust difference for a heading error, per cent per degree.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.9))]
    pub(crate) heading_pct_per_deg: f64,
    /// Thrust difference against a rate of turn, per cent per degree a second.
    #[schemars(range(min = 0, max = 100), extend("default" = 1.4))]
    pub(crate) turn_pct_per_deg_s: f64,
}
