//! A boat's sensors of its own state, and their errors.
//!
//! These types also declare the keys of boat files, like those in [`crate::boat`].

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Maximum latency of fixes, in fix periods.
pub(crate) const MOST_PERIODS_LATE: f64 = 12.0;

/// Sensors of a boat's own state. `None` means perfect measurement without delay.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sensors {
    /// Satellite receiver. Default: perfect.
    pub gps: Option<Gps>,
    /// Magnetic compass. Default: perfect.
    pub compass: Option<Compass>,
    /// Gyro and accelerometers. Default: perfect.
    pub imu: Option<Imu>,
}

/// A GPS receiver: position and velocity over the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gps {
    /// Standard deviation of the slowly varying error, per axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.8))]
    pub bias_m: f64,
    /// Correlation time of that error, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 200))]
    pub bias_time_s: f64,
    /// Standard deviation of white noise, per axis, m.
    #[schemars(range(min = 0, max = 100), extend("default" = 0.1))]
    pub noise_m: f64,
    /// Standard deviation of velocity noise, per axis, m/s.
    #[schemars(range(min = 0, max = 10), extend("default" = 0.05))]
    pub velocity_noise_m_s: f64,
    /// Time between fixes, s.
    #[schemars(range(min = 0.02, max = 10), extend("default" = 0.2))]
    pub period_s: f64,
    /// Age of a fix when output, s.
    #[schemars(range(min = 0, max = 2), extend("default" = 0.1))]
    pub latency_s: f64,
    /// Periods without fixes. Default: none.
    #[serde(default)]
    #[schemars(with = "Option<Outage>", !default)]
    pub dropout: Outage,
    /// Periods with constant position and velocity. Default: none.
    #[serde(default)]
    #[schemars(with = "Option<Outage>", !default)]
    pub freeze: Outage,
    /// Jumps of the position. Default: none.
    #[serde(default)]
    #[schemars(with = "Option<Jump>", !default)]
    pub jump: Jump,
}

/// Randomly timed periods.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outage {
    /// Rate, 1/s.
    #[schemars(description = "Rate, 1/h.")]
    #[schemars(rename = "per_hour", range(min = 0, max = 3600), extend("x-field" = "rate_per_s"))]
    pub rate_per_s: f64,
    /// Mean duration, s.
    #[schemars(range(min = 0.1, max = 3600))]
    pub mean_s: f64,
}

/// Jumps; each lasts until the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Jump {
    /// Rate, 1/s.
    #[schemars(description = "Rate, 1/h.")]
    #[schemars(rename = "per_hour", range(min = 0, max = 3600), extend("x-field" = "rate_per_s"))]
    pub rate_per_s: f64,
    /// Standard deviation of the offset, per axis, m.
    #[schemars(range(min = 0, max = 1000))]
    pub sigma_m: f64,
}

/// A magnetic compass with deviation A + B sin h + C cos h + D sin 2h + E cos 2h at heading h.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Compass {
    /// A to E, rad.
    #[schemars(flatten, with = "Deviation")]
    pub deviation_rad: [f64; 5],
    /// Error at full thrust of both thrusters, rad.
    #[schemars(description = "Error at full thrust of both thrusters, degrees.")]
    #[schemars(rename = "thrust_error_deg", range(min = -90, max = 90))]
    #[schemars(extend("x-field" = "thrust_error_rad", "default" = 0))]
    pub thrust_error_rad: f64,
    /// Standard deviation of noise, rad.
    #[schemars(description = "Standard deviation of noise, degrees.")]
    #[schemars(rename = "noise_deg", range(min = 0, max = 45), extend("x-field" = "noise_rad", "default" = 1))]
    pub noise_rad: f64,
    /// Time between readings, s.
    #[schemars(range(min = 0.02, max = 10), extend("default" = 0.1))]
    pub period_s: f64,
    /// Error of the declination correction, rad.
    #[schemars(description = "Error of the declination correction, degrees.")]
    #[schemars(rename = "declination_error_deg", range(min = -180, max = 180))]
    #[schemars(extend("x-field" = "declination_error_rad", "default" = 0))]
    pub declination_error_rad: f64,
}

/// The coefficients of a compass's deviation, under their names in files.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "the schema of five keys")]
struct Deviation {
    /// A: misalignment, degrees.
    #[schemars(range(min = -180, max = 180), extend("x-field" = "deviation_rad.0", "default" = 0))]
    a_deg: f64,
    /// B: hard iron along the boat, degrees.
    #[schemars(range(min = -45, max = 45), extend("x-field" = "deviation_rad.1", "default" = 0))]
    b_deg: f64,
    /// C: hard iron across the boat, degrees.
    #[schemars(range(min = -45, max = 45), extend("x-field" = "deviation_rad.2", "default" = 0))]
    c_deg: f64,
    /// D: soft iron, degrees.
    #[schemars(range(min = -45, max = 45), extend("x-field" = "deviation_rad.3", "default" = 0))]
    d_deg: f64,
    /// E: soft iron, degrees.
    #[schemars(range(min = -45, max = 45), extend("x-field" = "deviation_rad.4", "default" = 0))]
    e_deg: f64,
}

/// Gyro and accelerometers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Imu {
    /// Standard deviation of gyro noise, rad/s.
    #[schemars(description = "Standard deviation of gyro noise, degrees/s.")]
    #[schemars(rename = "gyro_noise_deg_s", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "gyro_noise_rad_s", "default" = 0.05))]
    pub gyro_noise_rad_s: f64,
    /// Standard deviation of gyro bias, rad/s.
    #[schemars(description = "Standard deviation of gyro bias, degrees/s.")]
    #[schemars(rename = "gyro_bias_deg_s", range(min = 0, max = 100))]
    #[schemars(extend("x-field" = "gyro_bias_rad_s", "default" = 0.02))]
    pub gyro_bias_rad_s: f64,
    /// Correlation time of the biases, s.
    #[schemars(range(min = 1, max = 86400), extend("default" = 600))]
    pub bias_time_s: f64,
    /// Standard deviation of accelerometer noise, m/s².
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub accelerometer_noise_m_s2: f64,
    /// Standard deviation of accelerometer bias, m/s².
    #[schemars(range(min = 0, max = 100), extend("default" = 0.03))]
    pub accelerometer_bias_m_s2: f64,
}
