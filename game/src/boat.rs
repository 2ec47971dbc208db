//! A kind of boat: its hull, thrusters and front seat, as the physics wants them.
//!
//! Everything is SI, in the boat's own frame with its origin midships (CO): x ahead, y to starboard,
//! yaw clockwise. The equation that these numbers enter stands in `sim::hull`.

use schemars::JsonSchema;
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
    /// Draught, m: the depth over which waves push and beyond which they do not.
    pub draught_m: f64,
    /// Inertia and resistance.
    pub hull: Hull,
    /// What the wind gets hold of.
    pub windage: Windage,
    /// What drives it.
    pub drive: Drive,
    /// What it knows of itself.
    pub sensors: Sensors,
}

/// What drives a boat.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Drive {
    /// Two thrusters on a hull that floats, steered by the front seat: the model we stand for.
    Thrusters {
        /// The two thrusters.
        thruster: Thruster,
        /// The front seat's heading and speed loops.
        autopilot: Autopilot,
    },
    /// The point boat of MOOS (uSimMarine under pMarinePID), for parity with what others train on. The sea carries it
    /// along and does nothing else to it.
    Kinematic(Kinematic),
}

impl Boat {
    /// The highest speed its front seat accepts, m/s.
    #[must_use]
    pub fn speed_max_m_s(&self) -> f64 {
        match &self.drive {
            Drive::Thrusters { autopilot, .. } => autopilot.speed_max_m_s,
            Drive::Kinematic(kinematic) => kinematic.speed_max_m_s,
        }
    }
}

/// Wind on the hull: coefficients and areas of Fossen (2021), ch. 10: X = −½ρ V² C_x A_F cos γ, Y = ½ρ V² C_y A_L sin γ,
/// N = ½ρ V² C_n A_L L sin 2γ, with the relative wind V at the angle γ off the bow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Windage {
    /// Projected area from ahead, m².
    pub frontal_area_m2: f64,
    /// Projected area from the side, m².
    pub lateral_area_m2: f64,
    /// Height of its centre above the water, m: where the wind's profile is taken.
    pub height_m: f64,
    /// C_x.
    pub surge_coefficient: f64,
    /// C_y.
    pub sway_coefficient: f64,
    /// C_n.
    pub yaw_coefficient: f64,
}

/// A point boat with thrust, rudder and PID loops: the constants of uSimMarine and pMarinePID, in SI where they have
/// units, in their own per-cent scales where they have none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kinematic {
    /// The highest speed it accepts, m/s.
    pub speed_max_m_s: f64,
    /// Thrust (per cent) and speed (m/s), both rising.
    pub thrust_map: Vec<(f64, f64)>,
    /// Largest thrust, per cent.
    pub thrust_max: f64,
    /// Largest rudder, per cent.
    pub rudder_max: f64,
    /// uSimMarine's turn rate: at full rudder and half thrust it turns by this many degrees a second.
    pub turn_rate: f64,
    /// Share of the speed that full rudder costs.
    pub turn_loss: f64,
    /// Bias of the turn, rad/s clockwise.
    pub rotate_rad_s: f64,
    /// Configured acceleration limit, m/s²; 0 is none. The boat does half of it, as uSimMarine's does.
    pub acceleration_max_m_s2: f64,
    /// Configured deceleration limit, m/s²; 0 is none.
    pub deceleration_max_m_s2: f64,
    /// Thrust over desired speed, per cent per m/s; 0 uses the speed loop instead.
    pub speed_factor: f64,
    /// The speed loop: error in m/s to change of thrust in per cent.
    pub speed_pid: Pid,
    /// The heading loop: error in degrees to rudder in per cent.
    pub heading_pid: Pid,
}

/// Gains of pMarinePID.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pid {
    /// Proportional.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub p: f64,
    /// Integral.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub i: f64,
    /// Derivative.
    #[schemars(range(min = -1000, max = 1000), extend("default" = 0))]
    pub d: f64,
    /// Limit of the integral.
    #[schemars(range(min = 0, max = 1000), extend("default" = 0))]
    pub i_limit: f64,
}

/// What a boat knows of itself. What is `None` is known perfectly and at once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sensors {
    /// Satellite navigation: position and velocity over the ground.
    pub gps: Option<Gps>,
    /// Magnetic compass: heading.
    pub compass: Option<Compass>,
    /// Gyro and accelerometers.
    pub imu: Option<Imu>,
}

/// A satellite receiver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gps {
    /// Standard deviation of the position's wandering bias (Gauss-Markov), each axis, m.
    pub bias_m: f64,
    /// Correlation time of the bias, s.
    pub bias_time_s: f64,
    /// Standard deviation of the position's white noise, each axis, m.
    pub noise_m: f64,
    /// Standard deviation of the velocity's white noise, each axis, m/s.
    pub velocity_noise_m_s: f64,
    /// Time between fixes, s.
    pub period_s: f64,
    /// Age of a fix when it comes out, s.
    pub latency_s: f64,
    /// Drop-outs: no fixes come out meanwhile.
    pub dropout: Outage,
    /// Freezes: fixes come out with the position and velocity that they had at the beginning.
    pub freeze: Outage,
    /// Jumps of the position.
    pub jump: Jump,
}

/// A fault that comes and goes. The default never does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outage {
    /// How often it begins, 1/s.
    pub rate_per_s: f64,
    /// How long it lasts on average, s.
    pub mean_s: f64,
}

/// Offsets, each of which lasts until the next. The default has none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Jump {
    /// How often one comes, 1/s.
    pub rate_per_s: f64,
    /// Standard deviation of the offset, each axis, m.
    pub sigma_m: f64,
}

/// A magnetic compass. Its deviation is A + B sin ψ + C cos ψ + D sin 2ψ + E cos 2ψ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compass {
    /// A to E, rad: A is a misalignment, B and C hard iron, D and E soft iron.
    pub deviation_rad: [f64; 5],
    /// Error at full thrust of both thrusters, rad: it grows with their current.
    pub thrust_error_rad: f64,
    /// Standard deviation of the white noise, rad.
    pub noise_rad: f64,
    /// Time between readings, s.
    pub period_s: f64,
    /// What is left of the declination after correction, rad: magnetic north, as the boat takes it, east of true north.
    pub declination_error_rad: f64,
}

/// Gyro and accelerometers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Imu {
    /// Standard deviation of the gyro's white noise, rad/s.
    pub gyro_noise_rad_s: f64,
    /// Standard deviation of the gyro's bias, rad/s.
    pub gyro_bias_rad_s: f64,
    /// Correlation time of the biases, s.
    pub bias_time_s: f64,
    /// Standard deviation of the accelerometers' white noise, m/s².
    pub accelerometer_noise_m_s2: f64,
    /// Standard deviation of the accelerometers' bias, m/s².
    pub accelerometer_bias_m_s2: f64,
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
    /// In what it falls short of that.
    pub flaws: Flaws,
}

/// What keeps thrusters from doing what they are told. The default is nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flaws {
    /// Largest setting that is taken up, as a share of full ahead or astern.
    pub saturation: f64,
    /// Factor on the port thruster's thrust, and on the starboard one's.
    pub gain: (f64, f64),
    /// Factor on thrust astern.
    pub reverse_efficiency: f64,
    /// Moment that acts unasked for, N m clockwise at full thrust of both: a bent bracket, a worn propeller.
    pub bias_newton_m: f64,
    /// How long a command is on its way to the thrusters, s.
    pub latency_s: f64,
    /// Without a new command for this long the thrusters stop, s; `None` is never.
    pub watchdog_s: Option<f64>,
    /// What the thrusters live on.
    pub battery: Option<Battery>,
    /// Thrust lost in waves.
    pub ventilation: Option<Ventilation>,
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

/// A battery that sags.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Battery {
    /// Energy when full, J.
    pub capacity_joule: f64,
    /// Charge at the start of a game, as a share.
    pub charge: f64,
    /// Power that both thrusters together draw at full ahead, W.
    pub full_power_watt: f64,
    /// Power that everything else draws, W.
    pub hotel_power_watt: f64,
    /// Share of the thrust that is lost when the battery is empty; it falls in step with the charge.
    pub sag: f64,
}

/// Propellers near the surface, which suck air as waves bare them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ventilation {
    /// How deep the propellers are in still water, m.
    #[schemars(range(min = 0.01, max = 10))]
    pub depth_m: f64,
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Autopilot {
    /// Highest speed that the front seat accepts, m/s.
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
