//! The kinematic boat as typed.

use super::{At, Pair};
use schemars::JsonSchema;
use serde::Deserialize;

/// The point boat of MOOS (uSimMarine under pMarinePID), with its own constants.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Kinematic")]
pub(in crate::scenario) struct RawKinematic {
    /// Highest speed, m/s: 0.1 to 60. Required.
    pub(in crate::scenario) speed_max_m_s: Option<At<f64>>,
    /// Thrust in per cent and speed in m/s, both rising, with [0, 0]. Required.
    pub(in crate::scenario) thrust_map: Option<At<Vec<At<Pair>>>>,
    /// Largest thrust, per cent: 1 to 100. Default 100.
    pub(in crate::scenario) thrust_max: Option<At<f64>>,
    /// Largest rudder, per cent: 1 to 100. Default 100.
    pub(in crate::scenario) rudder_max: Option<At<f64>>,
    /// Degrees a second at full rudder and half thrust: 0 to 1000. Required.
    pub(in crate::scenario) turn_rate: Option<At<f64>>,
    /// Share of the speed that full rudder costs: 0 to 1. Default 0.85.
    pub(in crate::scenario) turn_loss: Option<At<f64>>,
    /// Bias of the turn, degrees a second: -90 to 90. Default 0.
    pub(in crate::scenario) rotate_deg_s: Option<At<f64>>,
    /// Acceleration limit, m/s²; the boat does half of it: 0 (none) to 100. Default 0.
    pub(in crate::scenario) acceleration_max_m_s2: Option<At<f64>>,
    /// Deceleration limit, m/s²; the boat does half of it: 0 (none) to 100. Default 0.5.
    pub(in crate::scenario) deceleration_max_m_s2: Option<At<f64>>,
    /// Thrust over desired speed, per cent per m/s: 0 (use the speed loop) to 1000. Default 0.
    pub(in crate::scenario) speed_factor: Option<At<f64>>,
    /// The speed loop. Required, unless speed_factor is given.
    pub(in crate::scenario) speed_pid: Option<RawPid>,
    /// The heading loop. Required.
    pub(in crate::scenario) heading_pid: Option<RawPid>,
}

/// Gains of a loop.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Pid")]
pub(in crate::scenario) struct RawPid {
    /// Proportional: -1000 to 1000. Default 0.
    pub(in crate::scenario) p: Option<At<f64>>,
    /// Integral: -1000 to 1000. Default 0.
    pub(in crate::scenario) i: Option<At<f64>>,
    /// Derivative: -1000 to 1000. Default 0.
    pub(in crate::scenario) d: Option<At<f64>>,
    /// Limit of the integral: 0 to 1000. Default 0.
    pub(in crate::scenario) i_limit: Option<At<f64>>,
}
