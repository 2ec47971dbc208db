//! A kind of boat: its hull, thrusters and front seat.
//!
//! Everything is SI, in the boat's own frame with its origin amidships (CO): x ahead, y to
//! starboard, yaw clockwise. `sim::hull` contains the equations that use these numbers.
//!
//! These types also declare the keys of boat files. For a key in a different unit, `rename` sets
//! the key's name, the description gives the unit, and `x-field` names the field. A number that is
//! estimated if a file omits it has the type `E`: `Option<f64>` in a file, `f64` once checked.

use crate::sensor::Sensors;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A kind of boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boat {
    /// The boat file's stem, for example `surveyor_m1_8`.
    pub name: String,
    /// Length overall, m.
    pub length_m: f64,
    /// Beam, m.
    pub beam_m: f64,
    /// Draught, m: waves act on the boat down to this depth.
    pub draught_m: f64,
    /// Inertia and resistance.
    pub hull: Hull,
    /// Areas and coefficients of the wind force.
    pub windage: Windage,
    /// The propulsion model.
    pub drive: Drive,
    /// Behaviour during a hold. Older recordings lack it.
    #[serde(default)]
    pub hold: Hold,
    /// Sensors of the boat's own state.
    pub sensors: Sensors,
}

/// What a boat does without an order, while out of action, or on a hold order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// Stops its thrusters and drifts.
    #[default]
    Drifts,
    /// Keeps station where the hold began. If operators stop the boats, it drifts.
    KeepsStation,
}

/// A boat's propulsion model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// Two thrusters on a floating hull, steered by the front seat: Squall's own model.
    Thrusters {
        /// The two thrusters.
        thruster: Thruster,
        /// The front seat's heading and speed loops.
        autopilot: Autopilot,
    },
    /// The point boat of MOOS (uSimMarine under pMarinePID), for parity with other training
    /// environments. The sea affects it only through the current.
    Kinematic(Kinematic),
}

impl Boat {
    /// The maximum speed that the front seat accepts, m/s.
    pub fn speed_max_m_s(&self) -> f64 {
        match &self.drive {
            Drive::Thrusters { autopilot, .. } => autopilot.speed_max_m_s,
            Drive::Kinematic(kinematic) => kinematic.speed_max_m_s,
        }
    }
}

/// Wind force (Fossen 2021, ch. 10): X = −½ρ V² C_x A_F cos γ, Y = ½ρ V² C_y A_L sin γ, N = ½ρ V²
/// C_n A_L L sin 2γ, with relative wind V at angle γ off the bow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Windage<E = f64> {
    /// A_F: frontal area, m². Default: 0.36 beam².
    #[schemars(range(min = 0, max = 1000))]
    pub frontal_area_m2: E,
    /// A_L: lateral area, m². Default: 0.16 L².
    #[schemars(range(min = 0, max = 5000))]
    pub lateral_area_m2: E,
    /// Height of the reference wind, m. Default: 0.25 L.
    #[schemars(range(min = 0.05, max = 100))]
    pub height_m: E,
    /// C_x.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.6))]
    pub surge_coefficient: f64,
    /// C_y.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.85))]
    pub sway_coefficient: f64,
    /// C_n.
    #[schemars(range(min = -0.5, max = 0.5), extend("default" = 0.1))]
    pub yaw_coefficient: f64,
}

/// The point boat of MOOS (uSimMarine under pMarinePID) with its constants.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Kinematic {
    /// Maximum speed, m/s.
    #[schemars(range(min = 0.1, max = 60))]
    pub speed_max_m_s: f64,
    /// Pairs of thrust (%) and speed (m/s), both ascending, including [0, 0].
    #[schemars(with = "Vec<ThrustAndSpeed>")]
    pub thrust_map: Vec<(f64, f64)>,
    /// Maximum thrust, %.
    #[schemars(range(min = 1, max = 100), extend("default" = 100))]
    pub thrust_max: f64,
    /// Maximum rudder, %.
    #[schemars(range(min = 1, max = 100), extend("default" = 100))]
    pub rudder_max: f64,
    /// Rate of turn at full rudder and half thrust, degrees/s.
    #[schemars(range(min = 0, max = 1000))]
    pub turn_rate: f64,
    /// Fraction of speed lost at full rudder.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.85))]
    pub turn_loss: f64,
    /// Turn bias, rad/s.
    #[schemars(description = "Turn bias, degrees/s.")]
    #[schemars(rename = "rotate_deg_s", range(min = -90, max = 90), extend("default" = 0, "x-field" = "rotate_rad_s"))]
    pub rotate_rad_s: f64,
    /// Acceleration limit, m/s²; the boat achieves half of it; 0: no limit.
    #[schemars(range(min = 0, max = 100), extend("default" = 0))]
    pub acceleration_max_m_s2: f64,
    /// Deceleration limit, m/s²; the boat achieves half of it; 0: no limit.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.5))]
    pub deceleration_max_m_s2: f64,
    /// Thrust per desired speed, % per m/s; 0: use `speed_pid`.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub speed_factor: f64,
    /// Speed loop. Required without `speed_factor`.
    #[serde(default)]
    #[schemars(with = "Option<Pid>", !default)]
    pub speed_pid: Pid,
    /// Heading loop.
    pub heading_pid: Pid,
}

/// A thrust in per cent and its speed in m/s.
#[derive(JsonSchema)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema of a pair")]
pub struct ThrustAndSpeed(
    #[schemars(range(min = -100, max = 100))] f64,
    #[schemars(range(min = -60, max = 60))] f64,
);

/// Gains of pMarinePID.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pid {
    /// Proportional gain.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub p: f64,
    /// Integral gain.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub i: f64,
    /// Derivative gain.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub d: f64,
    /// Limit of the integral.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub i_limit: f64,
}

/// Inertia and resistance. Omitted values are estimated from length L, beam, mass m and thrust.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Hull<E = f64> {
    /// Mass including payload, kg.
    #[schemars(range(min = 0.1, max = 1000000))]
    pub mass_kg: f64,
    /// Moment of inertia about amidships, kg m². Default: m (L/4)² + m x_g².
    #[schemars(range(min = 0.0001, max = 1000000000))]
    pub yaw_inertia_kg_m2: E,
    /// Centre of gravity, m ahead of amidships, within the hull.
    #[schemars(range(min = -50, max = 50), extend("default" = 0))]
    pub x_g_m: f64,
    /// Added mass in surge A11, kg. Default: 2.7 ρ (m/ρ)^(5/3) / L², ρ = 1000 (Söding).
    #[schemars(range(min = 0, max = 1000000))]
    pub added_surge_kg: E,
    /// Added mass in sway A22, kg. Default: m.
    #[schemars(range(min = 0, max = 10000000))]
    pub added_sway_kg: E,
    /// Added moment of inertia in yaw A66, kg m². Default: the moment of inertia.
    #[schemars(range(min = 0, max = 1000000000))]
    pub added_yaw_kg_m2: E,
    /// Added sway-yaw coupling A26, kg m.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub added_sway_yaw_kg_m: f64,
    /// Linear surge resistance -X_u, kg/s. Default: such that both thrusters full ahead give the
    /// autopilot's `speed_max_m_s`, at least 0.
    #[schemars(range(min = 0, max = 1000000))]
    pub surge_linear_kg_s: E,
    /// Quadratic surge resistance -X_|u|u, kg/m.
    #[schemars(range(min = 0, max = 1000000), extend("default" = 0))]
    pub surge_quadratic_kg_m: f64,
    /// Linear sway resistance -Y_v, kg/s. Default: (m + A22) / 1 s.
    #[schemars(range(min = 0, max = 10000000))]
    pub sway_linear_kg_s: E,
    /// Lift-like sway resistance -Y_|u|v, kg/m.
    #[schemars(range(min = 0, max = 1000000), extend("default" = 0))]
    pub sway_lift_kg_m: f64,
    /// Linear yaw resistance -N_r, kg m²/s. Default: (inertia + A66) / 1 s.
    #[schemars(range(min = 0, max = 1000000000))]
    pub yaw_linear_kg_m2_s: E,
    /// Quadratic yaw resistance -N_|r|r, kg m².
    #[schemars(range(min = 0, max = 1000000000), extend("default" = 0))]
    pub yaw_quadratic_kg_m2: f64,
    /// Speed-dependent yaw resistance -N_|u|r, kg m.
    #[schemars(range(min = 0, max = 10000000), extend("default" = 0))]
    pub yaw_lift_kg_m: f64,
    /// Cross-flow drag coefficient of the immersed side (Hoerner); 0: no cross-flow.
    #[schemars(range(min = 0, max = 3), extend("default" = 0))]
    pub crossflow_coefficient: f64,
    /// Draught for cross-flow, m. Required if `crossflow_coefficient` is above 0. Default: 0.
    #[schemars(range(min = 0, max = 20))]
    pub crossflow_draught_m: E,
    /// Length for cross-flow, m. Default: L.
    #[schemars(range(min = 0, max = 200))]
    pub crossflow_length_m: E,
    /// Fraction of the Munk moment (A22 - A11) u v; 1: bare hull in ideal flow.
    #[schemars(range(min = 0, max = 1), extend("default" = 0.5))]
    pub munk_factor: f64,
}

/// Two fixed thrusters, one on each side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thruster {
    /// Distance of each thruster from the centreline, m.
    pub arm_m: f64,
    /// Thrust as a function of the setting.
    pub curve: ThrustCurve,
    /// Time constant of the response to a setting, s; 0 is immediate.
    pub lag_s: f64,
    /// Maximum rate of change of the commanded setting, fractions of full ahead per second.
    pub slew_per_s: f64,
    /// Commands below this fraction of full ahead have no effect.
    pub deadband: f64,
    /// Deviations from the ideal thruster.
    pub flaws: Flaws,
}

/// Deviations from ideal thrusters. By default there are none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Flaws {
    /// Maximum setting, as a fraction of full ahead or astern.
    #[schemars(range(min = 0.05, max = 1), extend("default" = 1))]
    pub saturation: f64,
    /// Factors on port and starboard thrust.
    #[schemars(flatten, with = "Gains")]
    pub gain: (f64, f64),
    /// Factor on thrust astern, unknown to the front seat.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub reverse_efficiency: f64,
    /// Unintended moment at full thrust, N m clockwise.
    #[schemars(range(min = -1000000, max = 1000000), extend("default" = 0))]
    pub bias_newton_m: f64,
    /// Delay of commands to the thrusters, s.
    #[schemars(range(min = 0, max = 5), extend("default" = 0))]
    pub latency_s: f64,
    /// Time without a new order after which the thrusters stop, s. Default: never.
    #[schemars(range(min = 0.1, max = 3600))]
    pub watchdog_s: Option<f64>,
    /// A battery whose voltage falls. Default: constant voltage.
    pub battery: Option<Battery>,
    /// Loss of thrust in waves. Default: none.
    pub ventilation: Option<Ventilation>,
}

/// The factors on port and starboard thrust, as named in files.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "the schema of two keys")]
struct Gains {
    /// Factor on port thrust, unknown to the front seat.
    #[schemars(range(min = 0, max = 2), extend("default" = 1, "x-field" = "gain.0"))]
    port_gain: f64,
    /// Factor on starboard thrust, unknown to the front seat.
    #[schemars(range(min = 0, max = 2), extend("default" = 1, "x-field" = "gain.1"))]
    starboard_gain: f64,
}

impl Default for Flaws {
    fn default() -> Flaws {
        Flaws {
            saturation: 1.0,
            gain: (1.0, 1.0),
            reverse_efficiency: 1.0,
            bias_newton_m: 0.0,
            latency_s: 0.0,
            watchdog_s: None,
            battery: None,
            ventilation: None,
        }
    }
}

/// A battery whose voltage, and therefore thrust, falls with its charge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Battery {
    /// Energy when full, J.
    #[schemars(description = "Energy when full, W h.")]
    #[schemars(rename = "capacity_wh", range(min = 1, max = 1000000), extend("x-field" = "capacity_joule"))]
    pub capacity_joule: f64,
    /// Initial fraction of charge.
    #[schemars(range(min = 0, max = 1), extend("default" = 1))]
    pub charge: f64,
    /// Power of both thrusters at full ahead, W.
    #[schemars(rename = "full_power_w", range(min = 0, max = 1000000), extend("x-field" = "full_power_watt"))]
    pub full_power_watt: f64,
    /// Power of all other loads, W.
    #[schemars(rename = "hotel_power_w", range(min = 0, max = 100000))]
    #[schemars(extend("x-field" = "hotel_power_watt", "default" = 0))]
    pub hotel_power_watt: f64,
    /// Fraction of thrust lost when empty.
    #[schemars(range(min = 0, max = 0.9), extend("default" = 0.15))]
    pub sag: f64,
}

/// Propellers that draw air when waves expose them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ventilation {
    /// Depth of the propellers in still water, m.
    #[schemars(range(min = 0.01, max = 10))]
    pub depth_m: f64,
}

/// Thrust as a function of the thruster's setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ThrustCurve {
    /// A propeller: the setting is the shaft speed n, rad/s, and the lag acts on n.
    Propeller(Propeller),
    /// A measured table; the setting is the fraction of full ahead, −1 to 1, and the lag acts on
    /// it.
    Table {
        /// (setting, thrust in N), both strictly ascending, including (0, 0).
        points: Vec<(f64, f64)>,
    },
}

/// Thrust k n |n| newtons at n rad/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Propeller<E = f64> {
    /// k ahead, N s²/rad².
    #[schemars(range(min = 0.00000001, max = 1000))]
    pub k_ahead: f64,
    /// k astern, N s²/rad². Default: `k_ahead`.
    #[schemars(range(min = 0.00000001, max = 1000))]
    pub k_astern: E,
    /// Shaft speed at full ahead, rad/s.
    #[schemars(range(min = 0.1, max = 10000))]
    pub n_max_rad_s: f64,
    /// Shaft speed at full astern, rad/s, positive. Default: `n_max_rad_s`.
    #[schemars(range(min = 0.1, max = 10000))]
    pub n_min_rad_s: E,
}

/// The front seat: follows a heading and a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Autopilot {
    /// Maximum speed setting, m/s.
    #[schemars(range(min = 0.1, max = 60))]
    pub speed_max_m_s: f64,
    /// Natural frequency of the heading loop, rad/s.
    #[schemars(range(min = 0.01, max = 10), extend("default" = 1))]
    pub heading_bandwidth_rad_s: f64,
    /// Damping ratio of the heading loop.
    #[schemars(range(min = 0.1, max = 5), extend("default" = 1))]
    pub heading_damping: f64,
    /// Time constant of the speed loop, s.
    #[schemars(range(min = 0.1, max = 60), extend("default" = 2))]
    pub speed_time_s: f64,
}
