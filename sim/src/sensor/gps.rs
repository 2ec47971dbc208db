//! A satellite receiver: where a boat was a moment ago and how it moved over the ground, nearly.
//!
//! A fix is taken every period and comes out after the latency. Its position errs by a wandering bias (Gauss-Markov), by
//! white noise and by the last jump; its velocity, which a receiver has from the Doppler shift, by white noise alone.
//! Drop-outs and freezes come and go as a two-state Markov chain, sampled at the fixes.

use super::{GaussMarkovStep, Truth, whole_ticks};
use crate::two_state::TwoStateChain;
use primitives::frame::Ned;
use primitives::reseed::{Seeds, TimedNoise};
use primitives::{SimTime, math};
use scenario::fault::{FaultKind, FaultSpan};
use scenario::sensor::{Gps, Outage};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Most fixes that can be under way at once: the latency is at most this many periods. A file may state 12 periods; of
/// them, rounded to whole decisions, as many as 18 may be left of the same time.
pub const UNDER_WAY_MAX: usize = 18;
/// Pairs of normal numbers that a fix takes: bias, position, velocity, jump.
const PAIRS: u64 = 4;
/// Uniform numbers that a fix takes: drop-out, freeze, jump.
const UNIFORMS: u64 = 3;

/// One fix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fix {
    /// When it was taken: where the boat was then, it says.
    pub at: SimTime,
    /// Position, m from the datum.
    pub position: Ned,
    /// Velocity over the ground, m/s.
    pub velocity_m_s: Ned,
}

/// A receiver: constant.
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
    /// Probability of a jump at a fix.
    jump_chance: f64,
    jump_m: f64,
    /// Faults of the game, beside those of its own.
    faults: Vec<FaultSpan>,
}

/// Everything that changes about a receiver. The default is the state before the game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GpsState {
    /// The fix that came out last.
    latest: Fix,
    /// Fixes that have been taken and have not come out, the oldest first.
    under_way: VecDeque<Fix>,
    /// m, by axis.
    bias: Ned,
    /// m, by axis.
    jump: Ned,
    dropped: bool,
    /// What comes out meanwhile, if the receiver is frozen.
    frozen: Option<Fix>,
}

fn chain(outage: Outage, period: SimTime) -> TwoStateChain {
    if outage.rate_per_s <= 0.0 || outage.mean_s <= 0.0 {
        return TwoStateChain::OFF;
    }
    TwoStateChain::new(outage.rate_per_s, 1.0 / outage.mean_s, period)
}

impl GpsModel {
    /// The receiver of the boat named `vehicle`, read once a `tick`: its period is a whole number of these.
    ///
    /// # Panics
    /// If its latency is more than [`UNDER_WAY_MAX`] periods.
    #[must_use]
    pub fn new(gps: &Gps, tick: SimTime, seeds: &Seeds, vehicle: &str) -> GpsModel {
        let period = whole_ticks(gps.period_s, tick);
        let latency = SimTime::from_s(gps.latency_s);
        assert!(latency <= period * UNDER_WAY_MAX as i64, "a latency is at most {UNDER_WAY_MAX} periods");
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
            faults: vec![],
        }
    }

    /// Faults that befall it in the midst of the game.
    pub fn set_faults(&mut self, faults: &[FaultSpan]) {
        let is_of_gps = |kind| matches!(kind, FaultKind::GpsFrozen | FaultKind::GpsLost | FaultKind::GpsOffset);
        self.faults = faults.iter().filter(|span| is_of_gps(span.kind)).copied().collect();
    }

    /// The fault of a kind that is going on, if one is.
    fn fault(&self, kind: FaultKind, now: SimTime) -> Option<&FaultSpan> {
        self.faults.iter().find(|span| span.kind == kind && span.is_on(now))
    }

    /// The last fix that has come out by `now`. The receiver has been on since before the game: the fix of time 0 is
    /// there at once, and nothing is amiss at first.
    pub fn read(&self, state: &mut GpsState, truth: &Truth, now: SimTime) -> Fix {
        // What is out makes room for the new fix.
        while let Some(fix) = state.under_way.pop_front_if(|fix| fix.at + self.latency <= now) {
            state.latest = fix;
        }
        if now.0 % self.period.0 == 0 {
            let number = (now.0 / self.period.0) as u64;
            let fix = self.measure_fix(state, truth, now, number);
            let dropped = state.dropped || self.fault(FaultKind::GpsLost, now).is_some();
            // Every boat begins with a fix: nobody launches without one.
            if number == 0 || (self.latency == SimTime::ZERO && !dropped) {
                state.latest = fix;
            } else if !dropped {
                assert!(state.under_way.len() < UNDER_WAY_MAX, "a latency is at most {UNDER_WAY_MAX} periods");
                state.under_way.push_back(fix);
            }
        }
        state.latest
    }

    fn measure_fix(&self, state: &mut GpsState, truth: &Truth, now: SimTime, number: u64) -> Fix {
        let (normals, uniforms) = (self.normals.at(now), self.uniforms.at(now));
        let normal = |which: u64, sigma: f64| {
            let (north, east) = normals.normal_pair(PAIRS * number + which);
            Ned { north, east }.scaled(sigma)
        };
        let uniform = |which: u64| uniforms.unit(UNIFORMS * number + which);
        let GaussMarkovStep { kept, fresh } = if number == 0 { GaussMarkovStep::FIRST } else { self.bias_step };
        state.bias = state.bias.scaled(kept) + normal(0, self.bias_m * fresh);
        if number > 0 {
            state.dropped = self.dropout.next(state.dropped, uniform(0));
            if uniform(2) < self.jump_chance {
                // It stays until the next one, as after a change of satellites.
                state.jump = normal(3, self.jump_m);
            }
        }
        let mut measured = Fix {
            at: now,
            position: truth.pose.at + state.bias + state.jump + normal(1, self.noise_m),
            // By Doppler shift: it is not the change of the noisy position, and much better
            // than that.
            velocity_m_s: truth.velocity_m_s() + normal(2, self.velocity_noise_m_s),
        };
        if let Some(span) = self.fault(FaultKind::GpsOffset, now) {
            let (sin, cos) = math::sin_cos(span.direction_rad);
            measured.position = measured.position + Ned { north: cos, east: sin }.scaled(span.offset_m);
        }
        let freezes = number > 0
            && (self.freeze.next(state.frozen.is_some(), uniform(1))
                || self.fault(FaultKind::GpsFrozen, now).is_some());
        state.frozen = freezes.then(|| state.frozen.unwrap_or(measured));
        // A frozen receiver still stamps its fixes anew: who reads them cannot tell by their age.
        state.frozen.map_or(measured, |frozen| Fix { at: now, ..frozen })
    }
}
