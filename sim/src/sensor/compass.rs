//! A magnetic compass: the heading, off by what the earth and the boat do to it.
//!
//! ```text
//! reading = ψ − declination − (A + B sin ψ + C cos ψ + D sin 2ψ + E cos 2ψ) + thrust error + noise
//! ```
//!
//! Declination and deviation have the navigator's sign: east is positive, and then the needle stands east of where it
//! should and the compass reads less than the truth (Bowditch, The American Practical Navigator, ch. on compasses). The
//! thrust error is that of the reading, at full thrust of both thrusters.

use super::{Truth, whole_ticks};
use primitives::angle::wrap_pi;
use primitives::reseed::{Seeds, TimedNoise};
use primitives::{SimTime, math};
use scenario::fault::{FaultKind, FaultSpan};
use scenario::sensor::Compass;
use serde::{Deserialize, Serialize};

/// A compass: constant.
#[derive(Clone, Debug)]
pub struct CompassModel {
    compass: Compass,
    noise: TimedNoise,
    period: SimTime,
    /// Faults of the game.
    faults: Vec<FaultSpan>,
}

/// Everything that changes about a compass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CompassState {
    /// The last reading.
    psi_rad: f64,
    /// How far that was off.
    pub(super) error_rad: f64,
}

impl CompassModel {
    /// The compass of the boat named `vehicle`.
    #[must_use]
    pub fn new(compass: &Compass, tick: SimTime, seeds: &Seeds, vehicle: &str) -> CompassModel {
        CompassModel {
            compass: compass.clone(),
            noise: seeds.noise(&format!("compass/{vehicle}")),
            period: whole_ticks(compass.period_s, tick),
            faults: vec![],
        }
    }

    /// The deviation at a heading, rad, east positive.
    #[must_use]
    pub fn deviation_rad(&self, psi_rad: f64) -> f64 {
        let [a, b, c, d, e] = self.compass.deviation_rad;
        let (sin, cos) = math::sin_cos(psi_rad);
        // sin 2ψ and cos 2ψ by the double angle.
        a + b * sin + c * cos + d * (2.0 * sin * cos) + e * (cos * cos - sin * sin)
    }

    /// Faults that befall it in the midst of the game.
    pub fn set_faults(&mut self, faults: &[FaultSpan]) {
        self.faults = faults.iter().filter(|span| span.kind == FaultKind::CompassOffset).copied().collect();
    }

    /// How far those put it off, rad.
    fn fault_rad(&self, now: SimTime) -> Option<f64> {
        self.faults.iter().filter(|span| span.is_on(now)).map(|span| span.offset_rad).reduce(|sum, one| sum + one)
    }

    /// The heading that the boat reads at `now`, rad, -pi to pi: that of the last period.
    pub fn read(&self, state: &mut CompassState, truth: &Truth, now: SimTime) -> f64 {
        if now.0 % self.period.0 == 0 {
            let number = (now.0 / self.period.0) as u64;
            let noise = self.noise.at(now).normal(number);
            let psi_rad = truth.pose.psi_rad;
            let magnetic_rad = psi_rad - self.compass.declination_error_rad - self.deviation_rad(psi_rad);
            let error_rad = self.compass.thrust_error_rad * truth.thrust_share + self.compass.noise_rad * noise;
            state.psi_rad = wrap_pi(magnetic_rad + error_rad);
            if let Some(off_rad) = self.fault_rad(now) {
                state.psi_rad = wrap_pi(state.psi_rad + off_rad);
            }
            // The front seat steers by its compass, as the real one does: a deviation leads the
            // boat astray instead of only being reported.
            state.error_rad = wrap_pi(state.psi_rad - psi_rad);
        }
        state.psi_rad
    }
}
