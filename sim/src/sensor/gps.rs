//! A satellite receiver: delayed and noisy position and velocity over the ground.
//!
//! A fix is taken every period and delivered after the latency. Its position has a wandering bias
//! (Gauss-Markov), white noise and the last jump. Its velocity, measured by Doppler shift, has only
//! white noise. Two-state Markov chains, sampled at the fixes, cause drop-outs and freezes.

use super::truth::{GaussMarkovStep, Truth, whole_ticks};
use crate::two_state::TwoStateChain;
use primitives::frame::Ned;
use primitives::reseed::{Seeds, TimedNoise};
use primitives::{SimTime, math};
use scenario::fault::{FaultKind, FaultSpan};
use scenario::sensor::{Gps, Outage};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Maximum number of fixes in transit, and maximum latency in periods. A file may specify up to 12
/// periods; rounded to whole decisions, the same time can be 18 periods.
pub const UNDER_WAY_MAX: usize = 18;
/// Pairs of normal numbers per fix: bias, position, velocity, jump.
const PAIRS: u64 = 4;
/// Uniform numbers per fix: drop-out, freeze, jump.
const UNIFORMS: u64 = 3;

/// One fix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fix {
    /// Time of measurement, to which the position refers.
    pub at: SimTime,
    /// Position, m from the datum.
    pub position: Ned,
    /// Velocity over the ground, m/s.
    pub velocity_m_s: Ned,
}

/// The constants of a receiver.
#[derive(Clone, Debug)]
pub struct GpsModel {
    normals: TimedNoise,
    uniforms: TimedNoise,
    period: SimTime,
    latency: SimTime,
    bias_m: f64,
    bias_step: GaussMarkovStep,
    noise_m: f64,
    velocity_noise_m_s: f64,
    dropout: TwoStateChain,
    freeze: TwoStateChain,
    /// Probability of a jump per fix.
    jump_chance: f64,
    jump_m: f64,
    /// The receiver's fault spans in this game, besides its own drop-outs and freezes.
    faults: Vec<FaultSpan>,
}

/// The changing state of a receiver. The default is the state before the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GpsState {
    /// The fix delivered last.
    latest: Fix,
    /// Fixes taken but not yet delivered, oldest first.
    under_way: VecDeque<Fix>,
    /// Position bias by axis, m.
    bias: Ned,
    /// Position jump by axis, m.
    jump: Ned,
    dropped: bool,
    /// The fix delivered while the receiver is frozen.
    frozen: Option<Fix>,
}

fn chain(outage: Outage, period: SimTime) -> TwoStateChain {
    if outage.rate_per_s <= 0.0 || outage.mean_s <= 0.0 {
        return TwoStateChain::OFF;
    }
    TwoStateChain::new(outage.rate_per_s, 1.0 / outage.mean_s, period)
}

impl GpsModel {
    /// The receiver of the boat named `vehicle`, read once per `tick`, with the given faults. Its
    /// period is a whole number of ticks.
    ///
    /// # Panics
    /// If its latency exceeds [`UNDER_WAY_MAX`] periods.
    pub fn new(
        gps: &Gps,
        tick: SimTime,
        seeds: &Seeds,
        vehicle: &str,
        faults: &[FaultSpan],
    ) -> GpsModel {
        let period = whole_ticks(gps.period_s, tick);
        let latency = SimTime::from_s(gps.latency_s);
        let is_of_gps = |kind| {
            matches!(
                kind,
                FaultKind::GpsFrozen | FaultKind::GpsLost | FaultKind::GpsOffset
            )
        };
        assert!(
            latency <= period * UNDER_WAY_MAX as i64,
            "the latency exceeds {UNDER_WAY_MAX} periods"
        );
        GpsModel {
            normals: seeds.noise(&format!("gps/{vehicle}")),
            uniforms: seeds.noise(&format!("gps/{vehicle}/events")),
            period,
            latency,
            bias_m: gps.bias_m,
            bias_step: GaussMarkovStep::new(period, gps.bias_time_s),
            noise_m: gps.noise_m,
            velocity_noise_m_s: gps.velocity_noise_m_s,
            dropout: chain(gps.dropout, period),
            freeze: chain(gps.freeze, period),
            jump_chance: -libm::expm1(-gps.jump.rate_per_s * period.as_s()),
            jump_m: gps.jump.sigma_m,
            faults: faults
                .iter()
                .filter(|span| is_of_gps(span.kind))
                .copied()
                .collect(),
        }
    }

    fn fault(&self, kind: FaultKind, now: SimTime) -> Option<&FaultSpan> {
        self.faults
            .iter()
            .find(|span| span.kind == kind && span.is_on(now))
    }

    /// The last fix delivered by `now`. The receiver was on before the game: the fix of time 0 is
    /// available at once, and is neither lost nor frozen.
    pub fn read(&self, state: &mut GpsState, truth: &Truth, now: SimTime) -> Fix {
        // Delivery frees space for the new fix.
        while let Some(fix) = state
            .under_way
            .pop_front_if(|fix| fix.at + self.latency <= now)
        {
            state.latest = fix;
        }
        if now.0 % self.period.0 == 0 {
            let number = (now.0 / self.period.0) as u64;
            let fix = self.measure_fix(state, truth, now, number);
            let dropped = state.dropped || self.fault(FaultKind::GpsLost, now).is_some();
            // Every boat starts with a fix, because no one launches without one.
            if number == 0 || (self.latency == SimTime::ZERO && !dropped) {
                state.latest = fix;
            } else if !dropped {
                assert!(
                    state.under_way.len() < UNDER_WAY_MAX,
                    "more than {UNDER_WAY_MAX} fixes in transit"
                );
                state.under_way.push_back(fix);
            }
        }
        state.latest
    }

    fn measure_fix(&self, state: &mut GpsState, truth: &Truth, now: SimTime, number: u64) -> Fix {
        let normals = self.normals.at(now);
        let uniforms = self.uniforms.at(now);
        let normal = |which: u64, sigma: f64| {
            let (north, east) = normals.normal_pair(PAIRS * number + which);
            Ned { north, east }.scaled(sigma)
        };
        let uniform = |which: u64| uniforms.unit(UNIFORMS * number + which);
        let GaussMarkovStep { kept, fresh } = if number == 0 {
            GaussMarkovStep::FIRST
        } else {
            self.bias_step
        };
        state.bias = state.bias.scaled(kept) + normal(0, self.bias_m * fresh);
        if number > 0 {
            state.dropped = self.dropout.next(state.dropped, uniform(0));
            if uniform(2) < self.jump_chance {
                // A jump persists until the next one, as after a change of satellites.
                state.jump = normal(3, self.jump_m);
            }
        }
        let mut measured = Fix {
            at: now,
            position: truth.pose.at + state.bias + state.jump + normal(1, self.noise_m),
            // Measured by Doppler shift: much better than differences of the noisy position.
            velocity_m_s: truth.velocity_m_s() + normal(2, self.velocity_noise_m_s),
        };
        if let Some(span) = self.fault(FaultKind::GpsOffset, now) {
            let (sin, cos) = math::sin_cos(span.direction_rad);
            measured.position = measured.position
                + Ned {
                    north: cos,
                    east: sin,
                }
                .scaled(span.offset_m);
        }
        let freezes = number > 0
            && (self.freeze.next(state.frozen.is_some(), uniform(1))
                || self.fault(FaultKind::GpsFrozen, now).is_some());
        state.frozen = freezes.then(|| state.frozen.unwrap_or(measured));
        // A frozen receiver still stamps its fixes with new times, so their age does not reveal the
        // freeze.
        state
            .frozen
            .map_or(measured, |frozen| Fix { at: now, ..frozen })
    }
}
