//! Decides when a boat may rearm itself after a failsafe for lack of fresh orders.

use primitives::SimTime;

/// Time for which orders must have been fresh, s. An E-stop delayed by a link failure arrives
/// within this time, because operators' programs repeat it.
const STEADY_S: f64 = 1.0;

/// Watches orders and failsafes.
pub(super) struct Rearm {
    /// Time (s) after a failsafe within which the boat may rearm itself.
    within_s: f64,
    pub(super) failsafe_at: SimTime,
    /// Start of the current period of fresh orders.
    fresh_since: Option<SimTime>,
}

impl Rearm {
    pub(super) fn new(within_s: f64) -> Rearm {
        Rearm {
            within_s,
            failsafe_at: SimTime::LONG_AGO,
            fresh_since: None,
        }
    }

    /// Whether the boat may rearm itself now.
    pub(super) fn is_allowed(&mut self, now: SimTime, order_fresh: bool) -> bool {
        self.fresh_since = order_fresh.then(|| self.fresh_since.unwrap_or(now));
        let is_steady = self
            .fresh_since
            .is_some_and(|since| (now - since).as_s() >= STEADY_S);
        is_steady && (now - self.failsafe_at).as_s() <= self.within_s
    }
}
