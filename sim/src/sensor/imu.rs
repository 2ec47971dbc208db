//! Gyro and accelerometers: rotation rates and specific force in body axes (ahead, starboard,
//! down).
//!
//! With roll φ, pitch θ and heading ψ (Fossen 2021, ch. 2 and 14):
//!
//! ```text
//! gyro:            p = φ' − ψ' sin θ     q = θ' cos φ + ψ' cos θ sin φ     r = −θ' sin φ + ψ' cos θ cos φ
//! accelerometers:  f = R(φ, θ, ψ)ᵀ (a − g),  g downwards: a boat at rest reads −g down, the water's push
//! ```
//!
//! each with white noise and a wandering bias (Gauss-Markov). The accelerometers are amidships.

use super::truth::{GaussMarkovStep, Truth};
use messages::picture;
use primitives::reseed::{Seeds, TimedNoise};
use primitives::{SimTime, math};
use scenario::sea::GRAVITY_M_S2;
use scenario::sensor::Imu;
use serde::{Deserialize, Serialize};

/// Pairs of normal numbers per reading: noise and bias for each of six axes.
const PAIRS: u64 = 6;

/// A reading of gyro and accelerometers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImuReading {
    /// Rates about the axes ahead, to starboard and down, rad/s.
    pub gyro_rad_s: [f64; 3],
    /// Specific force along these axes, m/s².
    pub accelerometer_m_s2: [f64; 3],
}

/// The constants of gyro and accelerometers.
#[derive(Clone, Debug)]
pub struct ImuModel {
    imu: Imu,
    noise: TimedNoise,
    tick: SimTime,
    bias_step: GaussMarkovStep,
}

/// The changing state of gyro and accelerometers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImuState {
    bias: ImuReading,
}

impl ImuReading {
    /// The true values.
    pub fn of(truth: &Truth) -> ImuReading {
        let Truth {
            nu,
            nu_dot,
            attitude,
            ..
        } = *truth;
        let (sin_roll, cos_roll) = math::sin_cos(attitude.roll_rad);
        let (sin_pitch, cos_pitch) = math::sin_cos(attitude.pitch_rad);
        let roll_rate = attitude.roll_rad_s;
        let pitch_rate = attitude.pitch_rad_s;
        let yaw_rate = nu.yaw;
        // a − g along the heading, across it and down, in the rotating axes.
        let ahead = nu_dot.surge - nu.sway * yaw_rate;
        let starboard = nu_dot.sway + nu.surge * yaw_rate;
        let down = -attitude.heave_up_m_s2 - GRAVITY_M_S2;
        let pitched = sin_pitch * ahead + cos_pitch * down;
        ImuReading {
            gyro_rad_s: [
                roll_rate - yaw_rate * sin_pitch,
                pitch_rate * cos_roll + yaw_rate * cos_pitch * sin_roll,
                -pitch_rate * sin_roll + yaw_rate * cos_pitch * cos_roll,
            ],
            accelerometer_m_s2: [
                cos_pitch * ahead - sin_pitch * down,
                cos_roll * starboard + sin_roll * pitched,
                -sin_roll * starboard + cos_roll * pitched,
            ],
        }
    }
}

impl From<ImuReading> for picture::Imu {
    fn from(reading: ImuReading) -> picture::Imu {
        let [roll_rate_rad_s, pitch_rate_rad_s, yaw_rate_rad_s] = reading.gyro_rad_s;
        let [ahead_m_s2, starboard_m_s2, down_m_s2] = reading.accelerometer_m_s2;
        picture::Imu {
            roll_rate_rad_s,
            pitch_rate_rad_s,
            yaw_rate_rad_s,
            ahead_m_s2,
            starboard_m_s2,
            down_m_s2,
        }
    }
}

impl ImuModel {
    /// Gyro and accelerometers of the boat named `vehicle`, read every `tick`.
    pub fn new(imu: &Imu, tick: SimTime, seeds: &Seeds, vehicle: &str) -> ImuModel {
        let noise = seeds.noise(&format!("imu/{vehicle}"));
        ImuModel {
            imu: imu.clone(),
            noise,
            tick,
            bias_step: GaussMarkovStep::new(tick, imu.bias_time_s),
        }
    }

    /// The reading at `now`.
    pub fn read(&self, state: &mut ImuState, truth: &Truth, now: SimTime) -> ImuReading {
        let number = (now.0 / self.tick.0) as u64;
        let GaussMarkovStep { kept, fresh } = if number == 0 {
            GaussMarkovStep::FIRST
        } else {
            self.bias_step
        };
        let imu = &self.imu;
        let drawn = self.noise.at(now);
        let mut reading = ImuReading::of(truth);
        for axis in 0..3 {
            let (noise, step) = drawn.normal_pair(PAIRS * number + axis as u64);
            // A slowly wandering bias makes integrated rates diverge, which white noise alone would
            // hide.
            let bias = &mut state.bias.gyro_rad_s[axis];
            *bias = kept * *bias + fresh * imu.gyro_bias_rad_s * step;
            reading.gyro_rad_s[axis] += *bias + imu.gyro_noise_rad_s * noise;
            let (noise, step) = drawn.normal_pair(PAIRS * number + 3 + axis as u64);
            let bias = &mut state.bias.accelerometer_m_s2[axis];
            *bias = kept * *bias + fresh * imu.accelerometer_bias_m_s2 * step;
            reading.accelerometer_m_s2[axis] += *bias + imu.accelerometer_noise_m_s2 * noise;
        }
        reading
    }
}
