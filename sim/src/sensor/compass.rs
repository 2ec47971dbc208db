//! A magnetic compass: heading with declination, deviation and other errors.
//!
//! ```text
//! reading = ψ − declination − (A + B sin ψ + C cos ψ + D sin 2ψ + E cos 2ψ) + thrust error + noise
//! ```
//!
//! Declination and deviation follow the navigators' sign convention: with east positive, the needle
//! points east of its true direction and the compass reads too low (Bowditch, The American
//! Practical Navigator, ch. on compasses). The thrust error is proportional to the thrusters'
//! current; the configured error applies at full thrust of both thrusters.

use super::truth::{Truth, whole_ticks};
use primitives::angle::wrap_pi;
use primitives::reseed::{Seeds, TimedNoise};
use primitives::{SimTime, math};
use scenario::fault::{FaultKind, FaultSpan};
use scenario::sensor::Compass;
use serde::{Deserialize, Serialize};

/// The constants of a compass.
#[derive(Clone, Debug)]
pub struct CompassModel {
    compass: Compass,
    noise: TimedNoise,
    period: SimTime,
    faults: Vec<FaultSpan>,
}

/// The changing state of a compass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompassState {
    /// The last reading.
    psi_rad: f64,
    /// The error of the last reading, rad.
    pub(super) error_rad: f64,
}

impl CompassModel {
    /// The compass of the boat named `vehicle`, with the given faults.
    pub fn new(
        compass: &Compass,
        tick: SimTime,
        seeds: &Seeds,
        vehicle: &str,
        faults: &[FaultSpan],
    ) -> CompassModel {
        CompassModel {
            compass: compass.clone(),
            noise: seeds.noise(&format!("compass/{vehicle}")),
            period: whole_ticks(compass.period_s, tick),
            faults: faults
                .iter()
                .filter(|span| span.kind == FaultKind::CompassOffset)
                .copied()
                .collect(),
        }
    }

    /// The deviation at a heading, rad, east positive.
    pub fn deviation_rad(&self, psi_rad: f64) -> f64 {
        let [a, b, c, d, e] = self.compass.deviation_rad;
        let (sin, cos) = math::sin_cos(psi_rad);
        // sin 2ψ and cos 2ψ by the double angle.
        a + b * sin + c * cos + d * (2.0 * sin * cos) + e * (cos * cos - sin * sin)
    }

    /// The current error due to faults, rad.
    fn fault_rad(&self, now: SimTime) -> Option<f64> {
        self.faults
            .iter()
            .filter(|span| span.is_on(now))
            .map(|span| span.offset_rad)
            .reduce(|sum, one| sum + one)
    }

    /// The reading at `now`, rad, -pi to pi; it changes once per period.
    pub fn read(&self, state: &mut CompassState, truth: &Truth, now: SimTime) -> f64 {
        if now.0 % self.period.0 == 0 {
            let number = (now.0 / self.period.0) as u64;
            let noise = self.noise.at(now).normal(number);
            let psi_rad = truth.pose.psi_rad;
            let magnetic_rad =
                psi_rad - self.compass.declination_error_rad - self.deviation_rad(psi_rad);
            let error_rad =
                self.compass.thrust_error_rad * truth.thrust_share + self.compass.noise_rad * noise;
            state.psi_rad = wrap_pi(magnetic_rad + error_rad);
            if let Some(off_rad) = self.fault_rad(now) {
                state.psi_rad = wrap_pi(state.psi_rad + off_rad);
            }
            // Like a real front seat, the simulated one steers by its compass, so a deviation leads
            // the boat astray instead of only being reported.
            state.error_rad = wrap_pi(state.psi_rad - psi_rad);
        }
        state.psi_rad
    }
}
