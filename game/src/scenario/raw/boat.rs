//! A boat file as typed.

use super::{Compass, Gps, Imu, Kinematic};
use crate::boat::{Autopilot, Ventilation};
use schemars::JsonSchema;
use serde::Deserialize;

/// A kind of boat: hull, thrusters and front seat, in surge, sway and yaw. The origin is midships; x
/// ahead, y to starboard, yaw clockwise. Any number may be drawn for every game.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(extend("x-drawn" = true))]
pub(crate) struct Boat {
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
    /// Satellite navigation. Default perfect.
    pub(crate) gps: Option<Gps>,
    /// Magnetic compass. Default perfect.
    pub(crate) compass: Option<Compass>,
    /// Gyro and accelerometers. Default perfect.
    pub(crate) imu: Option<Imu>,
}

/// Inertia and resistance of a hull. What is left out is estimated from length L, beam, mass m and thrust.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Hull {
    /// Mass with payload, kg.
    #[schemars(range(min = 0.1, max = 1000000))]
    pub(crate) mass_kg: f64,
    /// Moment of inertia about midships, kg m². Default m (L/4)² + m x_g².
    #[schemars(range(min = 0.0001, max = 1000000000))]
    pub(crate) yaw_inertia_kg_m2: Option<f64>,
    /// Centre of gravity ahead of midships, m, within the hull.
    #[schemars(range(min = -50, max = 50), extend("default" = 0))]
    pub(crate) x_g_m: f64,
    /// Added mass in surge A11, kg. Default 2.7 ρ (m/ρ)^(5/3) / L² with ρ = 1000 (Söding).
    #[schemars(range(min = 0, max = 1000000))]
    pub(crate) added_surge_kg: Option<f64>,
    /// Added mass in sway A22, kg. Default m.
    #[schemars(range(min = 0, max = 10000000))]
    pub(crate) added_sway_kg: Option<f64>,
    /// Added moment of inertia in yaw A66, kg m². Default the moment of inertia.
    #[schemars(range(min = 0, max = 1000000000))]
    pub(crate) added_yaw_kg_m2: Option<f64>,
    /// Added coupling of sway and yaw A26, kg m.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub(crate) added_sway_yaw_kg_m: f64,
    /// Linear resistance in surge -X_u, kg/s. Default what makes both thrusters full ahead give the autopilot's
    /// speed_max_m_s, with the quadratic part as given (0 if that alone is more).
    #[schemars(range(min = 0, max = 1000000))]
    pub(crate) surge_linear_kg_s: Option<f64>,
    /// Quadratic resistance in surge -X_|u|u, kg/m.
    #[schemars(range(min = 0, max = 1000000), extend("default" = 0))]
    pub(crate) surge_quadratic_kg_m: f64,
    /// Linear resistance in sway -Y_v, kg/s. Default (m + A22) / 1 s.
    #[schemars(range(min = 0, max = 10000000))]
    pub(crate) sway_linear_kg_s: Option<f64>,
    /// Lift-like resistance in sway -Y_|u|v, kg/m.
    #[schemars(range(min = 0, max = 1000000), extend("default" = 0))]
    pub(crate) sway_lift_kg_m: f64,
    /// Linear resistance in yaw -N_r, kg m²/s. Default (inertia + A66) / 1 s.
    #[schemars(range(min = 0, max = 1000000000))]
    pub(crate) yaw_linear_kg_m2_s: Option<f64>,
    /// Quadratic resistance in yaw -N_|r|r, kg m².
    #[schemars(range(min = 0, max = 1000000000), extend("default" = 0))]
    pub(crate) yaw_quadratic_kg_m2: f64,
    /// Resistance in yaw that grows with speed -N_|u|r, kg m.
    #[schemars(range(min = 0, max = 10000000), extend("default" = 0))]
    pub(crate) yaw_lift_kg_m: f64,
    /// Cross-flow drag coefficient of the immersed side (Hoerner); 0 is no cross-flow.
    #[schemars(range(min = 0, max = 3), extend("default" = 0))]
    pub(crate) crossflow_coefficient: f64,
    /// Draught that meets the cross-flow, m. Required with a coefficient, else 0.
    #[schemars(range(min = 0, max = 20))]
    pub(crate) crossflow_draught_m: Option<f64>,
    /// Length that meets the cross-flow, m. Default L.
    #[schemars(range(min = 0, max = 200))]
    pub(crate) crossflow_length_m: Option<f64>,
    /// Share of the Munk moment (A22 - A11) u v that acts, where 1 is the bare hull in ideal flow.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub(crate) munk_factor: f64,
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
    /// Largest setting that is taken up, as a share of full ahead or astern.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub(crate) saturation: f64,
    /// Factor on the port thruster's thrust. The front seat does not know it.
    #[schemars(range(min = 0, max = 2), extend("default" = 1))]
    pub(crate) port_gain: f64,
    /// Factor on the starboard thruster's thrust. The front seat does not know it.
    #[schemars(range(min = 0, max = 2), extend("default" = 1))]
    pub(crate) starboard_gain: f64,
    /// Factor on thrust astern. The front seat does not know it.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub(crate) reverse_efficiency: f64,
    /// Moment at full thrust that nobody asked for, N m clockwise.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub(crate) bias_newton_m: f64,
    /// How long a command is on its way to the thrusters, s.
    #[schemars(range(min = 0, max = 5), extend("default" = 0))]
    pub(crate) latency_s: f64,
    /// Without a new order for this long the thrusters stop, s. Default never.
    #[schemars(range(min = 0.1, max = 3600))]
    pub(crate) watchdog_s: Option<f64>,
    /// A battery that sags. Default one that does not.
    pub(crate) battery: Option<Battery>,
    /// Propellers that suck air in waves. Default they do not.
    pub(crate) ventilation: Option<Ventilation>,
}

/// A setting in per cent, and the thrust in newton that it gives.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct SettingAndThrust(
    #[schemars(range(min = -100, max = 100))] pub(crate) f64,
    #[schemars(range(min = -1000000, max = 1000000))] pub(crate) f64,
);

/// A propeller: thrust k n |n| newton at n rad/s.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Propeller {
    /// k turning ahead, N s²/rad².
    #[schemars(range(min = 0.00000001, max = 1000))]
    pub(crate) k_ahead: f64,
    /// k turning astern, N s²/rad². Default k_ahead.
    #[schemars(range(min = 0.00000001, max = 1000))]
    pub(crate) k_astern: Option<f64>,
    /// Shaft speed at full ahead, rad/s.
    #[schemars(range(min = 0.1, max = 10000))]
    pub(crate) n_max_rad_s: f64,
    /// Shaft speed at full astern, rad/s, a positive number. Default n_max_rad_s.
    #[schemars(range(min = 0.1, max = 10000))]
    pub(crate) n_min_rad_s: Option<f64>,
}

/// A battery whose voltage, and with it the thrust, falls with its charge.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Battery {
    /// Energy when full, W h.
    #[schemars(range(min = 1, max = 1000000))]
    pub(crate) capacity_wh: f64,
    /// Charge at the start of a game.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub(crate) charge: f64,
    /// Power that both thrusters draw at full ahead, W.
    #[schemars(range(min = 0, max = 1000000))]
    pub(crate) full_power_w: f64,
    /// Power that everything else draws, W.
    #[schemars(range(min = 0, max = 100000), extend("default" = 0))]
    pub(crate) hotel_power_w: f64,
    /// Share of the thrust that is lost when it is empty.
    #[schemars(range(min = 0, max = 0.9), extend("default" = 0.15))]
    pub(crate) sag: f64,
}

/// What the wind gets hold of: projected areas and coefficients (Fossen 2021, ch. 10).
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Windage {
    /// Area from ahead, m². Default 0.36 beam².
    #[schemars(range(min = 0, max = 1000))]
    pub(crate) frontal_area_m2: Option<f64>,
    /// Area from the side, m². Default 0.16 L².
    #[schemars(range(min = 0, max = 5000))]
    pub(crate) lateral_area_m2: Option<f64>,
    /// Height at which the wind is taken, m. Default 0.25 L.
    #[schemars(range(min = 0.05, max = 100))]
    pub(crate) height_m: Option<f64>,
    /// C_x.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.6))]
    pub(crate) surge_coefficient: f64,
    /// C_y.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.85))]
    pub(crate) sway_coefficient: f64,
    /// C_n.
    #[schemars(range(min = -0.5, max = 0.5), extend("default" = 0.1))]
    pub(crate) yaw_coefficient: f64,
}
