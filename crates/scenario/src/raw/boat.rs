//! A boat file as typed.

use crate::boat::{Autopilot, Flaws, Hold, Hull, Kinematic, Propeller, Windage};
use crate::sensor::Sensors;
use schemars::JsonSchema;
use serde::Deserialize;

/// A kind of boat: hull, thrusters and front seat, in surge, sway and yaw. The origin is midships; x
/// ahead, y to starboard, yaw clockwise. Any number may be drawn for every game.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("x-drawn" = true))]
pub struct Boat {
    /// Length over all, m.
    #[schemars(range(min = 0.1, max = 100))]
    pub(crate) length_m: f64,
    /// Beam over all, m.
    #[schemars(range(min = 0.05, max = 50))]
    pub(crate) beam_m: f64,
    /// Draught, m. Default the hull's crossflow_draught_m, or L / 12.
    #[schemars(range(min = 0.01, max = 20))]
    pub(crate) draught_m: Option<f64>,
    /// Inertia and resistance.
    pub(crate) hull: Hull,
    /// What the wind gets hold of.
    pub(crate) windage: Windage,
    /// The two thrusters. Required, unless the boat is kinematic.
    pub(crate) thruster: Option<Thruster>,
    /// The front seat's heading and speed loops. Required, unless the boat is kinematic.
    pub(crate) autopilot: Option<Autopilot>,
    /// Instead of thruster and autopilot: the point boat of MOOS, for parity. Waves and wind do nothing to it.
    pub(crate) kinematic: Option<Kinematic>,
    /// What it does when it holds.
    #[schemars(extend("default" = "drifts"))]
    pub(crate) hold: Hold,
    #[serde(flatten)]
    pub(crate) sensors: Sensors,
}

/// Two fixed thrusters, one each side: `propeller` or `table_pct_newton` says what they push.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Thruster {
    /// Distance of each thruster from the centre line, m.
    #[schemars(range(min = 0.01, max = 25))]
    pub(crate) arm_m: f64,
    /// A propeller with thrust k n |n|.
    pub(crate) propeller: Option<Propeller>,
    /// Setting in per cent and thrust of one thruster in newton, from -100 to 100, both rising, with [0, 0].
    pub(crate) table_pct_newton: Option<Vec<SettingAndThrust>>,
    /// Time constant with which a setting is taken up, s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.2))]
    pub(crate) lag_s: f64,
    /// Fastest change of the commanded setting, shares of full ahead a second.
    #[schemars(range(min = 0.001, max = 1000), extend("default" = 10))]
    pub(crate) slew_per_s: f64,
    /// Commands smaller than this share of full ahead give nothing.
    #[schemars(range(min = 0, max = 0.9), extend("default" = 0))]
    pub(crate) deadband: f64,
    #[serde(flatten)]
    pub(crate) flaws: Flaws,
}

/// A setting in per cent, and the thrust in newton that it gives.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct SettingAndThrust(
    #[schemars(range(min = -100, max = 100))] pub(crate) f64,
    #[schemars(range(min = -1000000, max = 1000000))] pub(crate) f64,
);
