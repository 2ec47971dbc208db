//! Sensors as typed.

use super::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// A satellite receiver: position and velocity over the ground.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Gps")]
pub(in crate::scenario) struct RawGps {
    /// Standard deviation of the wandering error, each axis, m: 0 to 100. Default 0.8.
    pub(in crate::scenario) bias_m: Option<At<f64>>,
    /// Its correlation time, s: 1 to 86400. Default 200.
    pub(in crate::scenario) bias_time_s: Option<At<f64>>,
    /// Standard deviation of the white noise, each axis, m: 0 to 100. Default 0.1.
    pub(in crate::scenario) noise_m: Option<At<f64>>,
    /// Standard deviation of the velocity's noise, each axis, m/s: 0 to 10. Default 0.05.
    pub(in crate::scenario) velocity_noise_m_s: Option<At<f64>>,
    /// Time between fixes, s: 0.02 to 10. Default 0.2.
    pub(in crate::scenario) period_s: Option<At<f64>>,
    /// Age of a fix when it comes out, s: 0 to 2. Default 0.1.
    pub(in crate::scenario) latency_s: Option<At<f64>>,
    /// Times without fixes. Default none.
    pub(in crate::scenario) dropout: Option<At<RawFault>>,
    /// Times in which position and velocity stand still. Default none.
    pub(in crate::scenario) freeze: Option<At<RawFault>>,
    /// Jumps of the position. Default none.
    pub(in crate::scenario) jump: Option<At<RawJump>>,
}

/// Something that comes and goes by chance.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Fault")]
pub(in crate::scenario) struct RawFault {
    /// How often it begins, 1/h: 0 to 3600. Required.
    pub(in crate::scenario) per_hour: Option<At<f64>>,
    /// How long it lasts on average, s: 0.1 to 3600. Required.
    pub(in crate::scenario) mean_s: Option<At<f64>>,
}

/// Jumps: each lasts until the next.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Jump")]
pub(in crate::scenario) struct RawJump {
    /// How often, 1/h: 0 to 3600. Required.
    pub(in crate::scenario) per_hour: Option<At<f64>>,
    /// Standard deviation of the offset, each axis, m: 0 to 1000. Required.
    pub(in crate::scenario) sigma_m: Option<At<f64>>,
}

/// A magnetic compass with the deviation A + B sin h + C cos h + D sin 2h + E cos 2h at the heading h.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Compass")]
pub(in crate::scenario) struct RawCompass {
    /// Misalignment, degrees: -180 to 180. Default 0.
    pub(in crate::scenario) a_deg: Option<At<f64>>,
    /// Hard iron along the boat, degrees: -45 to 45. Default 0.
    pub(in crate::scenario) b_deg: Option<At<f64>>,
    /// Hard iron across the boat, degrees: -45 to 45. Default 0.
    pub(in crate::scenario) c_deg: Option<At<f64>>,
    /// Soft iron, degrees: -45 to 45. Default 0.
    pub(in crate::scenario) d_deg: Option<At<f64>>,
    /// Soft iron, degrees: -45 to 45. Default 0.
    pub(in crate::scenario) e_deg: Option<At<f64>>,
    /// Error at full thrust of both thrusters, degrees: -90 to 90. Default 0.
    pub(in crate::scenario) thrust_error_deg: Option<At<f64>>,
    /// Standard deviation of the noise, degrees: 0 to 45. Default 1.
    pub(in crate::scenario) noise_deg: Option<At<f64>>,
    /// Time between readings, s: 0.02 to 10. Default 0.1.
    pub(in crate::scenario) period_s: Option<At<f64>>,
    /// What is left of the declination after correction, degrees: -180 to 180. Default 0.
    pub(in crate::scenario) declination_error_deg: Option<At<f64>>,
}

/// Gyro and accelerometers.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Imu")]
pub(in crate::scenario) struct RawImu {
    /// Standard deviation of the gyro's noise, degrees a second: 0 to 100. Default 0.05.
    pub(in crate::scenario) gyro_noise_deg_s: Option<At<f64>>,
    /// Standard deviation of its bias, degrees a second: 0 to 100. Default 0.02.
    pub(in crate::scenario) gyro_bias_deg_s: Option<At<f64>>,
    /// Correlation time of the biases, s: 1 to 86400. Default 600.
    pub(in crate::scenario) bias_time_s: Option<At<f64>>,
    /// Standard deviation of the accelerometers' noise, m/s²: 0 to 100. Default 0.03.
    pub(in crate::scenario) accelerometer_noise_m_s2: Option<At<f64>>,
    /// Standard deviation of their bias, m/s²: 0 to 100. Default 0.03.
    pub(in crate::scenario) accelerometer_bias_m_s2: Option<At<f64>>,
}
