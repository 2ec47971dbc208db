//! The kinematic boat as typed.

use crate::boat::Pid;
use schemars::JsonSchema;
use serde::Deserialize;

/// The point boat of MOOS (uSimMarine under pMarinePID), with its own constants.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Kinematic {
    /// Highest speed, m/s.
    #[schemars(range(min = 0.1, max = 60))]
    pub(crate) speed_max_m_s: f64,
    /// Thrust in per cent and speed in m/s, both rising, with [0, 0].
    pub(crate) thrust_map: Vec<ThrustAndSpeed>,
    /// Largest thrust, per cent.
    #[schemars(range(min = 1, max = 100), extend("default" = 100))]
    pub(crate) thrust_max: f64,
    /// Largest rudder, per cent.
    #[schemars(range(min = 1, max = 100), extend("default" = 100))]
    pub(crate) rudder_max: f64,
    /// Degrees a second at full rudder and half thrust.
    #[schemars(range(min = 0, max = 1000))]
    pub(crate) turn_rate: f64,
    /// Share of the speed that full rudder costs.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.85))]
    pub(crate) turn_loss: f64,
    /// Bias of the turn, degrees a second.
    #[schemars(range(min = -90, max = 90), extend("default" = 0))]
    pub(crate) rotate_deg_s: f64,
    /// Acceleration limit, m/s²; the boat does half of it, 0 is none.
    #[schemars(range(min = 0, max = 100), extend("default" = 0))]
    pub(crate) acceleration_max_m_s2: f64,
    /// Deceleration limit, m/s²; the boat does half of it, 0 is none.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.5))]
    pub(crate) deceleration_max_m_s2: f64,
    /// Thrust over desired speed, per cent per m/s; 0 uses the speed loop.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub(crate) speed_factor: f64,
    /// The speed loop. Required, unless speed_factor is given.
    pub(crate) speed_pid: Option<Pid>,
    /// The heading loop.
    pub(crate) heading_pid: Pid,
}

/// Thrust in per cent, and the speed in m/s that it gives.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct ThrustAndSpeed(
    #[schemars(range(min = -100, max = 100))] pub(crate) f64,
    #[schemars(range(min = -60, max = 60))] pub(crate) f64,
);
