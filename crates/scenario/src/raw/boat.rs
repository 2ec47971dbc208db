//! A boat file as written.

use crate::boat::{Autopilot, Flaws, Hold, Hull, Kinematic, Propeller, Windage};
use crate::sensor::Sensors;
use schemars::JsonSchema;
use serde::Deserialize;

/// A kind of boat. The origin is amidships: x ahead, y to starboard, yaw clockwise.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("x-drawn" = true))]
pub struct Boat {
    /// Length overall, m.
    #[schemars(range(min = 0.1, max = 100))]
    pub(crate) length_m: f64,
    /// Beam overall, m.
    #[schemars(range(min = 0.05, max = 50))]
    pub(crate) beam_m: f64,
    /// Draught, m. Default: `crossflow_draught_m` of the hull, or L / 12.
    #[schemars(range(min = 0.01, max = 20))]
    pub(crate) draught_m: Option<f64>,
    /// Inertia and resistance.
    pub(crate) hull: Hull<Option<f64>>,
    /// Wind force.
    pub(crate) windage: Windage<Option<f64>>,
    /// The two thrusters. Required unless the boat is kinematic.
    pub(crate) thruster: Option<Thruster>,
    /// Heading and speed loops of the front seat. Required unless the boat is kinematic.
    pub(crate) autopilot: Option<Autopilot>,
    /// Instead of thruster and autopilot: the point boat of MOOS, which ignores waves and wind.
    pub(crate) kinematic: Option<Kinematic>,
    /// What the boat does without an order, while out of action, or on a hold order.
    #[schemars(extend("default" = "drifts"))]
    pub(crate) hold: Hold,
    #[serde(flatten)]
    pub(crate) sensors: Sensors,
}

/// Two fixed thrusters, one on each side, with either `propeller` or `table_pct_newton`.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Thruster {
    /// Distance of each thruster from the centreline, m.
    #[schemars(range(min = 0.01, max = 25))]
    pub(crate) arm_m: f64,
    /// Propeller with thrust k n |n|.
    pub(crate) propeller: Option<Propeller<Option<f64>>>,
    /// Pairs of setting (-100 to 100 %) and thrust of one thruster (N), both ascending, including
    /// [0, 0].
    pub(crate) table_pct_newton: Option<Vec<SettingAndThrust>>,
    /// Time constant of the response, s.
    #[schemars(range(min = 0, max = 60), extend("default" = 0.2))]
    pub(crate) lag_s: f64,
    /// Maximum rate of change of the commanded setting, fractions of full ahead per second.
    #[schemars(range(min = 0.001, max = 1000), extend("default" = 10))]
    pub(crate) slew_per_s: f64,
    /// Commands below this fraction of full ahead have no effect.
    #[schemars(range(min = 0, max = 0.9), extend("default" = 0))]
    pub(crate) deadband: f64,
    #[serde(flatten)]
    pub(crate) flaws: Flaws,
}

/// A setting in per cent and its thrust in newtons.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct SettingAndThrust(
    #[schemars(range(min = -100, max = 100))] pub(crate) f64,
    #[schemars(range(min = -1000000, max = 1000000))] pub(crate) f64,
);
