//! Sensors.

use crate::boat::{Compass, Gps, Imu};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawCompass, RawFault, RawGps, RawImu, RawJump};

/// Fixes that are under way at once.
const MOST_PERIODS_LATE: f64 = 12.0;

/// Checks a satellite receiver.
pub(super) fn gps(diagnostics: &mut Diagnostics, given: &At<RawGps>) -> Gps {
    let raw = &given.value;
    let mut number = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
    };
    let period_s = number("period_s", &raw.period_s, 0.02, 10.0, 0.2);
    let latency_s = number("latency_s", &raw.latency_s, 0.0, 2.0, 0.1);
    let gps = Gps {
        bias_m: number("bias_m", &raw.bias_m, 0.0, 100.0, 0.8),
        bias_time_s: number("bias_time_s", &raw.bias_time_s, 1.0, 86_400.0, 200.0),
        noise_m: number("noise_m", &raw.noise_m, 0.0, 100.0, 0.1),
        velocity_noise_m_s: number("velocity_noise_m_s", &raw.velocity_noise_m_s, 0.0, 10.0, 0.05),
        period_s,
        latency_s,
        dropout: fault(diagnostics, "dropout", raw.dropout.as_ref()),
        freeze: fault(diagnostics, "freeze", raw.freeze.as_ref()),
        jump: jump(diagnostics, raw.jump.as_ref()),
    };
    let most_s = MOST_PERIODS_LATE * period_s;
    if latency_s > most_s {
        let place = raw.latency_s.as_ref().or(raw.period_s.as_ref()).map_or(given.at, |given| given.at);
        diagnostics
            .note(place, format!("latency_s is {latency_s}, expected at most {most_s}: {MOST_PERIODS_LATE} periods"));
    }
    gps
}

/// How often, 1/s, and for how long, s.
fn fault(diagnostics: &mut Diagnostics, owner: &str, given: Option<&At<RawFault>>) -> (f64, f64) {
    let Some(given) = given else { return (0.0, 0.0) };
    let (raw, at) = (&given.value, given.at);
    let per_hour = diagnostics.required(at, &format!("{owner}.per_hour"), raw.per_hour.as_ref(), 0.0..=3600.0);
    (per_hour / 3600.0, diagnostics.required(at, &format!("{owner}.mean_s"), raw.mean_s.as_ref(), 0.1..=3600.0))
}

fn jump(diagnostics: &mut Diagnostics, given: Option<&At<RawJump>>) -> (f64, f64) {
    let Some(given) = given else { return (0.0, 0.0) };
    let (raw, at) = (&given.value, given.at);
    let per_hour = diagnostics.required(at, "jump.per_hour", raw.per_hour.as_ref(), 0.0..=3600.0);
    (per_hour / 3600.0, diagnostics.required(at, "jump.sigma_m", raw.sigma_m.as_ref(), 0.0..=1000.0))
}

/// Checks a compass.
pub(super) fn compass(diagnostics: &mut Diagnostics, raw: &RawCompass) -> Compass {
    let mut degrees = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default).to_radians()
    };
    Compass {
        deviation_rad: [
            degrees("a_deg", &raw.a_deg, -180.0, 180.0, 0.0),
            degrees("b_deg", &raw.b_deg, -45.0, 45.0, 0.0),
            degrees("c_deg", &raw.c_deg, -45.0, 45.0, 0.0),
            degrees("d_deg", &raw.d_deg, -45.0, 45.0, 0.0),
            degrees("e_deg", &raw.e_deg, -45.0, 45.0, 0.0),
        ],
        thrust_error_rad: degrees("thrust_error_deg", &raw.thrust_error_deg, -90.0, 90.0, 0.0),
        noise_rad: degrees("noise_deg", &raw.noise_deg, 0.0, 45.0, 1.0),
        declination_error_rad: degrees("declination_error_deg", &raw.declination_error_deg, -180.0, 180.0, 0.0),
        period_s: diagnostics.number("period_s", raw.period_s.as_ref(), 0.02..=10.0).unwrap_or(0.1),
    }
}

/// Checks gyro and accelerometers.
pub(super) fn imu(diagnostics: &mut Diagnostics, raw: &RawImu) -> Imu {
    let mut number = |key: &str, given: &Option<At<f64>>, low: f64, high: f64, default: f64| {
        diagnostics.number(key, given.as_ref(), low..=high).unwrap_or(default)
    };
    let noise = (&raw.accelerometer_noise_m_s2, &raw.accelerometer_bias_m_s2);
    Imu {
        gyro_noise_rad_s: number("gyro_noise_deg_s", &raw.gyro_noise_deg_s, 0.0, 100.0, 0.05).to_radians(),
        gyro_bias_rad_s: number("gyro_bias_deg_s", &raw.gyro_bias_deg_s, 0.0, 100.0, 0.02).to_radians(),
        bias_time_s: number("bias_time_s", &raw.bias_time_s, 1.0, 86_400.0, 600.0),
        accelerometer_noise_m_s2: number("accelerometer_noise_m_s2", noise.0, 0.0, 100.0, 0.03),
        accelerometer_bias_m_s2: number("accelerometer_bias_m_s2", noise.1, 0.0, 100.0, 0.03),
    }
}
