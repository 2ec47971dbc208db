//! Sensors.

use crate::boat::{Compass, Gps, Imu, Jump, Outage};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw;
use crate::scenario::read::Document;

/// Fixes that are under way at once.
const MOST_PERIODS_LATE: f64 = 12.0;

/// Checks a satellite receiver.
pub(super) fn gps(diagnostics: &mut Diagnostics, document: &Document<raw::Boat>, raw: &raw::Gps) -> Gps {
    let (latency_s, most_s) = (raw.latency_s, MOST_PERIODS_LATE * raw.period_s);
    if latency_s > most_s {
        let path = if document.has("gps.latency_s") { "gps.latency_s" } else { "gps.period_s" };
        let message = format!("latency_s is {latency_s}, expected at most {most_s}: {MOST_PERIODS_LATE} periods");
        diagnostics.note(document.at(path), message);
    }
    let outage = |raw: &raw::Fault| Outage { rate_per_s: raw.per_hour / 3600.0, mean_s: raw.mean_s };
    Gps {
        bias_m: raw.bias_m,
        bias_time_s: raw.bias_time_s,
        noise_m: raw.noise_m,
        velocity_noise_m_s: raw.velocity_noise_m_s,
        period_s: raw.period_s,
        latency_s,
        dropout: raw.dropout.as_ref().map(outage).unwrap_or_default(),
        freeze: raw.freeze.as_ref().map(outage).unwrap_or_default(),
        jump: raw
            .jump
            .as_ref()
            .map_or_else(Jump::default, |jump| Jump { rate_per_s: jump.per_hour / 3600.0, sigma_m: jump.sigma_m }),
    }
}

/// A compass.
pub(super) fn compass(raw: &raw::Compass) -> Compass {
    Compass {
        deviation_rad: [raw.a_deg, raw.b_deg, raw.c_deg, raw.d_deg, raw.e_deg].map(f64::to_radians),
        thrust_error_rad: raw.thrust_error_deg.to_radians(),
        noise_rad: raw.noise_deg.to_radians(),
        declination_error_rad: raw.declination_error_deg.to_radians(),
        period_s: raw.period_s,
    }
}

/// Gyro and accelerometers.
pub(super) fn imu(raw: &raw::Imu) -> Imu {
    Imu {
        gyro_noise_rad_s: raw.gyro_noise_deg_s.to_radians(),
        gyro_bias_rad_s: raw.gyro_bias_deg_s.to_radians(),
        bias_time_s: raw.bias_time_s,
        accelerometer_noise_m_s2: raw.accelerometer_noise_m_s2,
        accelerometer_bias_m_s2: raw.accelerometer_bias_m_s2,
    }
}
