//! A two-state Markov chain in continuous time, sampled at equal intervals, for receiver outages
//! and bursts of radio loss.
//!
//! With turn-on rate λ and turn-off rate μ, a chain that is off is on after a period p with
//! probability λ / (λ + μ) (1 − e^−(λ+μ)p). Durations are exponential, and the fraction of time on
//! is exactly λ / (λ + μ).

use primitives::SimTime;

/// Probabilities of a change between consecutive samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwoStateChain {
    turns_on: f64,
    turns_off: f64,
}

impl TwoStateChain {
    /// A chain that is never on.
    pub(crate) const OFF: TwoStateChain = TwoStateChain {
        turns_on: 0.0,
        turns_off: 1.0,
    };

    /// A chain with the given rates (1/s), sampled every `period`.
    pub(crate) fn new(on_per_s: f64, off_per_s: f64, period: SimTime) -> TwoStateChain {
        // Computed in continuous time, so that a receiver's period affects only the sampling, not
        // the failure rate.
        let either = -libm::expm1(-(on_per_s + off_per_s) * period.as_s()) / (on_per_s + off_per_s);
        TwoStateChain {
            turns_on: on_per_s * either,
            turns_off: off_per_s * either,
        }
    }

    /// Whether the chain is on at the next sample, given a uniform number between 0 and 1.
    pub(crate) fn next(self, on: bool, uniform: f64) -> bool {
        uniform
            < if on {
                1.0 - self.turns_off
            } else {
                self.turns_on
            }
    }
}
