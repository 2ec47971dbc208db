//! Sensors as typed.

use schemars::JsonSchema;
use serde::Deserialize;

/// A satellite receiver: position and velocity over the ground.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Gps {
    /// Standard deviation of the wandering error, each axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.8))]
    pub(crate) bias_m: f64,
    /// Its correlation time, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 200))]
    pub(crate) bias_time_s: f64,
    /// Standard deviation of the white noise, each axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.1))]
    pub(crate) noise_m: f64,
    /// Standard deviation of the velocity's noise, each axis, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.05))]
    pub(crate) velocity_noise_m_s: f64,
    /// Time between fixes, s.
    #[schemars(range(min = 0.02, max = 10), extend("default" = 0.2))]
    pub(crate) period_s: f64,
    /// Age of a fix when it comes out, s.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.1))]
    pub(crate) latency_s: f64,
    /// Times without fixes. Default none.
    pub(crate) dropout: Option<Fault>,
    /// Times in which position and velocity stand still. Default none.
    pub(crate) freeze: Option<Fault>,
    /// Jumps of the position. Default none.
    pub(crate) jump: Option<Jump>,
}

/// Something that comes and goes by chance.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Fault {
    /// How often it begins, 1/h.
    #[schemars(range(min = 0, max = 3600))]
    pub(crate) per_hour: f64,
    /// How long it lasts on average, s.
    #[schemars(range(min = 0.1, max = 3600))]
    pub(crate) mean_s: f64,
}

/// Jumps: each lasts until the next.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Jump {
    /// How often, 1/h.
    #[schemars(range(min = 0, max = 3600))]
    pub(crate) per_hour: f64,
    /// Standard deviation of the offset, each axis, m.
    #[schemars(range(min = 0, max = 1000))]
    pub(crate) sigma_m: f64,
}

/// A magnetic compass with the deviation A + B sin h + C cos h + D sin 2h + E cos 2h at the heading h.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Compass {
    /// Misalignment, degrees.
    #[schemars(range(min = -180, max = 180), extend("default" = 0))]
    pub(crate) a_deg: f64,
    /// Hard iron along the boat, degrees.
    #[schemars(range(min = -45, max = 45), extend("default" = 0))]
    pub(crate) b_deg: f64,
    /// Hard iron across the boat, degrees.
    #[schemars(range(min = -45, max = 45), extend("default" = 0))]
    pub(crate) c_deg: f64,
    /// Soft iron, degrees.
    #[schemars(range(min = -45, max = 45), extend("default" = 0))]
    pub(crate) d_deg: f64,
    /// Soft iron, degrees.
    #[schemars(range(min = -45, max = 45), extend("default" = 0))]
    pub(crate) e_deg: f64,
    /// Error at full thrust of both thrusters, degrees.
    #[schemars(range(min = -90, max = 90), extend("default" = 0))]
    pub(crate) thrust_error_deg: f64,
    /// Standard deviation of the noise, degrees.
    #[schemars(range(min = 0, max = 45), extend("default" = 1))]
    pub(crate) noise_deg: f64,
    /// Time between readings, s.
    #[schemars(range(min = 0.02, max = 10), extend("default" = 0.1))]
    pub(crate) period_s: f64,
    /// What is left of the declination after correction, degrees.
    #[schemars(range(min = -180, max = 180), extend("default" = 0))]
    pub(crate) declination_error_deg: f64,
}

/// Gyro and accelerometers.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Imu {
    /// Standard deviation of the gyro's noise, degrees a second.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.05))]
    pub(crate) gyro_noise_deg_s: f64,
    /// Standard deviation of its bias, degrees a second.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.02))]
    pub(crate) gyro_bias_deg_s: f64,
    /// Correlation time of the biases, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 600))]
    pub(crate) bias_time_s: f64,
    /// Standard deviation of the accelerometers' noise, m/s².
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub(crate) accelerometer_noise_m_s2: f64,
    /// Standard deviation of their bias, m/s².
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub(crate) accelerometer_bias_m_s2: f64,
}
