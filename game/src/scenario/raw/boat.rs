//! A boat file as typed.

use super::{At, Pair, RawCompass, RawGps, RawImu, RawKinematic};
use schemars::JsonSchema;
use serde::Deserialize;

/// A kind of boat: hull, thrusters and front seat, in surge, sway and yaw. The origin is midships; x
/// ahead, y to starboard, yaw clockwise. Any number may be drawn by lot for every game.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall boat")]
pub(in crate::scenario) struct RawBoat {
    /// Another boat file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Length over all, m: 0.1 to 100. Required.
    pub(in crate::scenario) length_m: Option<At<f64>>,
    /// Beam over all, m: 0.05 to 50. Required.
    pub(in crate::scenario) beam_m: Option<At<f64>>,
    /// Draught, m: 0.01 to 20. Default the hull's crossflow_draught_m, or L / 12.
    pub(in crate::scenario) draught_m: Option<At<f64>>,
    /// Inertia and resistance. Required.
    pub(in crate::scenario) hull: Option<RawHull>,
    /// What the wind gets hold of.
    pub(in crate::scenario) windage: Option<RawWindage>,
    /// The two thrusters. Required, unless the boat is kinematic.
    pub(in crate::scenario) thruster: Option<RawThruster>,
    /// The front seat's heading and speed loops. Required, unless the boat is kinematic.
    pub(in crate::scenario) autopilot: Option<RawAutopilot>,
    /// Instead of thruster and autopilot: the point boat of MOOS, for parity. Waves and wind do nothing to it.
    pub(in crate::scenario) kinematic: Option<At<RawKinematic>>,
    /// Satellite navigation. Default perfect.
    pub(in crate::scenario) gps: Option<At<RawGps>>,
    /// Magnetic compass. Default perfect.
    pub(in crate::scenario) compass: Option<At<RawCompass>>,
    /// Gyro and accelerometers. Default perfect.
    pub(in crate::scenario) imu: Option<At<RawImu>>,
}

/// Inertia and resistance of a hull. What is left out is estimated from length L, beam, mass m and thrust.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Hull")]
pub(in crate::scenario) struct RawHull {
    /// Mass with payload, kg: 0.1 to 1000000. Required.
    pub(in crate::scenario) mass_kg: Option<At<f64>>,
    /// Moment of inertia about midships, kg m²: 0.0001 to 1000000000. Default m (L/4)² + m x_g².
    pub(in crate::scenario) yaw_inertia_kg_m2: Option<At<f64>>,
    /// Centre of gravity ahead of midships, m: -50 to 50, and within the hull. Default 0.
    pub(in crate::scenario) x_g_m: Option<At<f64>>,
    /// Added mass in surge A11, kg: 0 to 1000000. Default 2.7 ρ (m/ρ)^(5/3) / L² with ρ = 1000 (Söding).
    pub(in crate::scenario) added_surge_kg: Option<At<f64>>,
    /// Added mass in sway A22, kg: 0 to 10000000. Default m.
    pub(in crate::scenario) added_sway_kg: Option<At<f64>>,
    /// Added moment of inertia in yaw A66, kg m²: 0 to 1000000000. Default the moment of inertia.
    pub(in crate::scenario) added_yaw_kg_m2: Option<At<f64>>,
    /// Added coupling of sway and yaw A26, kg m: -1000000 to 1000000. Default 0.
    pub(in crate::scenario) added_sway_yaw_kg_m: Option<At<f64>>,
    /// Linear resistance in surge -X_u, kg/s: 0 to 1000000. Default what makes both thrusters full ahead
    /// give the autopilot's speed_max_m_s, with the quadratic part as given (0 if that alone is more).
    pub(in crate::scenario) surge_linear_kg_s: Option<At<f64>>,
    /// Quadratic resistance in surge -X_|u|u, kg/m: 0 to 1000000. Default 0.
    pub(in crate::scenario) surge_quadratic_kg_m: Option<At<f64>>,
    /// Linear resistance in sway -Y_v, kg/s: 0 to 10000000. Default (m + A22) / 1 s.
    pub(in crate::scenario) sway_linear_kg_s: Option<At<f64>>,
    /// Lift-like resistance in sway -Y_|u|v, kg/m: 0 to 1000000. Default 0.
    pub(in crate::scenario) sway_lift_kg_m: Option<At<f64>>,
    /// Linear resistance in yaw -N_r, kg m²/s: 0 to 1000000000. Default (inertia + A66) / 1 s.
    pub(in crate::scenario) yaw_linear_kg_m2_s: Option<At<f64>>,
    /// Quadratic resistance in yaw -N_|r|r, kg m²: 0 to 1000000000. Default 0.
    pub(in crate::scenario) yaw_quadratic_kg_m2: Option<At<f64>>,
    /// Resistance in yaw that grows with speed -N_|u|r, kg m: 0 to 10000000. Default 0.
    pub(in crate::scenario) yaw_lift_kg_m: Option<At<f64>>,
    /// Cross-flow drag coefficient of the immersed side (Hoerner): 0 to 3. Default 0, no cross-flow.
    pub(in crate::scenario) crossflow_coefficient: Option<At<f64>>,
    /// Draught that meets the cross-flow, m: 0 to 20. Required with a coefficient, else 0.
    pub(in crate::scenario) crossflow_draught_m: Option<At<f64>>,
    /// Length that meets the cross-flow, m: 0 to 200. Default L.
    pub(in crate::scenario) crossflow_length_m: Option<At<f64>>,
    /// Share of the Munk moment (A22 - A11) u v that acts: 0 to 1, where 1 is the bare hull in ideal
    /// flow. Default 0.5.
    pub(in crate::scenario) munk_factor: Option<At<f64>>,
}

/// Two fixed thrusters, one each side: `propeller` or `table_pct_newton` says what they push.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Thruster")]
pub(in crate::scenario) struct RawThruster {
    /// Distance of each thruster from the centre line, m: 0.01 to 25. Required.
    pub(in crate::scenario) arm_m: Option<At<f64>>,
    /// A propeller with thrust k n |n|.
    pub(in crate::scenario) propeller: Option<At<RawPropeller>>,
    /// Setting in per cent and thrust of one thruster in newton, from -100 to 100, both rising, with [0, 0].
    pub(in crate::scenario) table_pct_newton: Option<At<Vec<At<Pair>>>>,
    /// Time constant with which a setting is taken up, s: 0 to 60. Default 0.2.
    pub(in crate::scenario) lag_s: Option<At<f64>>,
    /// Fastest change of the commanded setting, shares of full ahead a second: 0.001 to 1000. Default 10.
    pub(in crate::scenario) slew_per_s: Option<At<f64>>,
    /// Commands smaller than this share of full ahead give nothing: 0 to 0.9. Default 0.
    pub(in crate::scenario) deadband: Option<At<f64>>,
    /// Largest setting that is taken up, as a share of full ahead or astern: 0.05 to 1. Default 1.
    pub(in crate::scenario) saturation: Option<At<f64>>,
    /// Factor on the port thruster's thrust: 0 to 2. Default 1. The front seat does not know it.
    pub(in crate::scenario) port_gain: Option<At<f64>>,
    /// Factor on the starboard thruster's thrust: 0 to 2. Default 1. The front seat does not know it.
    pub(in crate::scenario) starboard_gain: Option<At<f64>>,
    /// Factor on thrust astern: 0 to 1. Default 1. The front seat does not know it.
    pub(in crate::scenario) reverse_efficiency: Option<At<f64>>,
    /// Moment at full thrust that nobody asked for, N m clockwise: -1000000 to 1000000. Default 0.
    pub(in crate::scenario) bias_newton_m: Option<At<f64>>,
    /// How long a command is on its way to the thrusters, s: 0 to 5. Default 0.
    pub(in crate::scenario) latency_s: Option<At<f64>>,
    /// Without a new order for this long the thrusters stop, s: 0.1 to 3600. Default never.
    pub(in crate::scenario) watchdog_s: Option<At<f64>>,
    /// A battery that sags. Default one that does not.
    pub(in crate::scenario) battery: Option<At<RawBattery>>,
    /// Propellers that suck air in waves. Default they do not.
    pub(in crate::scenario) ventilation: Option<At<RawVentilation>>,
}

/// A propeller: thrust k n |n| newton at n rad/s.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Propeller")]
pub(in crate::scenario) struct RawPropeller {
    /// k turning ahead, N s²/rad²: 0.00000001 to 1000. Required.
    pub(in crate::scenario) k_ahead: Option<At<f64>>,
    /// k turning astern, N s²/rad²: 0.00000001 to 1000. Default k_ahead.
    pub(in crate::scenario) k_astern: Option<At<f64>>,
    /// Shaft speed at full ahead, rad/s: 0.1 to 10000. Required.
    pub(in crate::scenario) n_max_rad_s: Option<At<f64>>,
    /// Shaft speed at full astern, rad/s, a positive number: 0.1 to 10000. Default n_max_rad_s.
    pub(in crate::scenario) n_min_rad_s: Option<At<f64>>,
}

/// The front seat: how the boat follows a heading and a speed.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Autopilot")]
pub(in crate::scenario) struct RawAutopilot {
    /// Highest speed that the front seat accepts, m/s: 0.1 to 60. Required.
    pub(in crate::scenario) speed_max_m_s: Option<At<f64>>,
    /// Natural frequency of the heading loop, rad/s: 0.01 to 10. Default 1.
    pub(in crate::scenario) heading_bandwidth_rad_s: Option<At<f64>>,
    /// Damping ratio of the heading loop: 0.1 to 5. Default 1.
    pub(in crate::scenario) heading_damping: Option<At<f64>>,
    /// Time constant of the speed loop, s: 0.1 to 60. Default 2.
    pub(in crate::scenario) speed_time_s: Option<At<f64>>,
}

/// A battery whose voltage, and with it the thrust, falls with its charge.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Battery")]
pub(in crate::scenario) struct RawBattery {
    /// Energy when full, W h: 1 to 1000000. Required.
    pub(in crate::scenario) capacity_wh: Option<At<f64>>,
    /// Charge at the start of a game: 0 to 1. Default 1.
    pub(in crate::scenario) charge: Option<At<f64>>,
    /// Power that both thrusters draw at full ahead, W: 0 to 1000000. Required.
    pub(in crate::scenario) full_power_w: Option<At<f64>>,
    /// Power that everything else draws, W: 0 to 100000. Default 0.
    pub(in crate::scenario) hotel_power_w: Option<At<f64>>,
    /// Share of the thrust that is lost when it is empty: 0 to 0.9. Default 0.15.
    pub(in crate::scenario) sag: Option<At<f64>>,
}

/// Propellers near the surface, which suck air as waves bare them.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Ventilation")]
pub(in crate::scenario) struct RawVentilation {
    /// How deep the propellers are in still water, m: 0.01 to 10. Required.
    pub(in crate::scenario) depth_m: Option<At<f64>>,
}

/// What the wind gets hold of: projected areas and coefficients (Fossen 2021, ch. 10).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Windage")]
pub(in crate::scenario) struct RawWindage {
    /// Area from ahead, m²: 0 to 1000. Default 0.36 beam².
    pub(in crate::scenario) frontal_area_m2: Option<At<f64>>,
    /// Area from the side, m²: 0 to 5000. Default 0.16 L².
    pub(in crate::scenario) lateral_area_m2: Option<At<f64>>,
    /// Height at which the wind is taken, m: 0.05 to 100. Default 0.25 L.
    pub(in crate::scenario) height_m: Option<At<f64>>,
    /// C_x: 0 to 2. Default 0.6.
    pub(in crate::scenario) surge_coefficient: Option<At<f64>>,
    /// C_y: 0 to 2. Default 0.85.
    pub(in crate::scenario) sway_coefficient: Option<At<f64>>,
    /// C_n: -0.5 to 0.5. Default 0.1.
    pub(in crate::scenario) yaw_coefficient: Option<At<f64>>,
}
