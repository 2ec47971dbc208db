//! A kind of boat: its hull, thrusters and front seat, as the physics wants them.
//!
//! Everything is SI, in the boat's own frame with its origin midships (CO): x ahead, y to starboard,
//! yaw clockwise. The equation that these numbers enter stands in `sim::hull`.

use serde::{Deserialize, Serialize};

/// A kind of boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Boat {
    /// The boat file's stem, for example `surveyor_m1_8`.
    pub name: String,
    /// Length over all, m.
    pub length_m: f64,
    /// Beam, m.
    pub beam_m: f64,
    /// Inertia and resistance.
    pub hull: Hull,
    /// The two thrusters.
    pub thruster: Thruster,
    /// The front seat's heading and speed loops.
    pub autopilot: Autopilot,
}

/// Inertia and resistance of a hull in surge, sway and yaw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hull {
    /// Mass with payload, kg.
    pub mass_kg: f64,
    /// Moment of inertia about midships, kg m².
    pub yaw_inertia_kg_m2: f64,
    /// Centre of gravity ahead of midships, m.
    pub x_g_m: f64,
    /// Added mass in surge, A11, kg.
    pub added_surge_kg: f64,
    /// Added mass in sway, A22, kg.
    pub added_sway_kg: f64,
    /// Added moment of inertia in yaw, A66, kg m².
    pub added_yaw_kg_m2: f64,
    /// Added coupling of sway and yaw, A26, kg m.
    pub added_sway_yaw_kg_m: f64,
    /// Linear resistance in surge, −X_u, kg/s.
    pub surge_linear_kg_s: f64,
    /// Quadratic resistance in surge, −X_|u|u, kg/m.
    pub surge_quadratic_kg_m: f64,
    /// Linear resistance in sway, −Y_v, kg/s.
    pub sway_linear_kg_s: f64,
    /// Lift-like resistance in sway, −Y_|u|v, kg/m.
    pub sway_lift_kg_m: f64,
    /// Linear resistance in yaw, −N_r, kg m²/s.
    pub yaw_linear_kg_m2_s: f64,
    /// Quadratic resistance in yaw, −N_|r|r, kg m².
    pub yaw_quadratic_kg_m2: f64,
    /// Resistance in yaw that grows with speed, −N_|u|r, kg m.
    pub yaw_lift_kg_m: f64,
    /// Cross-flow drag coefficient C_d of the immersed side (Hoerner); 0 leaves it out.
    pub crossflow_coefficient: f64,
    /// Draught that meets the cross-flow, m.
    pub crossflow_draught_m: f64,
    /// Length that meets the cross-flow, m.
    pub crossflow_length_m: f64,
    /// Share of the Munk moment (A22 − A11) u v that acts: 1 is the bare hull in ideal flow.
    pub munk_factor: f64,
}

/// Two fixed thrusters, one each side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Thruster {
    /// Distance of each thruster from the centre line, m.
    pub arm_m: f64,
    /// What a setting gives in thrust.
    pub curve: ThrustCurve,
    /// Time constant with which a setting is taken up, s; 0 is at once.
    pub lag_s: f64,
    /// The fastest change of the commanded setting, in shares of full ahead a second.
    pub slew_per_s: f64,
    /// Commands smaller than this share of full ahead give nothing.
    pub deadband: f64,
}

/// Thrust as a function of the thruster's setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ThrustCurve {
    /// A propeller: T = k n |n|; the setting is the shaft speed n, rad/s, and the lag acts on n.
    Propeller {
        /// k for n > 0, N s²/rad².
        k_ahead: f64,
        /// k for n < 0, N s²/rad².
        k_astern: f64,
        /// Shaft speed at full ahead, rad/s.
        n_max_rad_s: f64,
        /// Shaft speed at full astern (a positive number), rad/s.
        n_min_rad_s: f64,
    },
    /// A measured table; the setting is the share of full ahead, −1 to 1, and the lag acts on it.
    Table {
        /// (setting, thrust in N), both rising strictly, with (0, 0) among them.
        points: Vec<(f64, f64)>,
    },
}

/// The front seat: how the boat follows a heading and a speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Autopilot {
    /// The highest speed the front seat accepts, m/s.
    pub speed_max_m_s: f64,
    /// Natural frequency of the heading loop, rad/s.
    pub heading_bandwidth_rad_s: f64,
    /// Damping ratio of the heading loop.
    pub heading_damping: f64,
    /// Time constant of the speed loop, s.
    pub speed_time_s: f64,
}
