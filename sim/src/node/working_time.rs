//! The time that a sim was at work: its patience with others goes by it. Time that the sim itself lost, because it was
//! suspended or had no processor, is nobody else's fault.

use std::time::{Duration, Instant};

/// A turn of the sim's own that takes longer than this was interrupted.
const TURN_MAX: Duration = Duration::from_secs(1);
/// Links that were given up meanwhile are there again after this time; until then nobody's patience is tried. zenoh waits
/// between two attempts to connect for four seconds at most.
const RECOVERY: Duration = Duration::from_secs(10);

/// A clock that stands still while its sim does.
pub(super) struct WorkingTime {
    looked: Instant,
    worked: Duration,
    /// How long the clock still stands after an interruption.
    recovery: Duration,
}

impl WorkingTime {
    pub(super) fn new(now: Instant) -> WorkingTime {
        WorkingTime { looked: now, worked: Duration::ZERO, recovery: Duration::ZERO }
    }

    /// Time has passed since the last call: the sim's own turn, after it had waited up to `waited`.
    pub(super) fn pass(&mut self, now: Instant, waited: Duration) {
        let passed = now.saturating_duration_since(self.looked);
        self.looked = now;
        if passed.saturating_sub(waited) > TURN_MAX {
            // Patience for ten seconds more: zenoh gives up links after ten seconds of silence,
            // and they have to be opened anew. A shorter lease would find cut links sooner and
            // give up suspended ones as well.
            self.recovery = RECOVERY;
            return;
        }
        let recovered = passed.min(self.recovery);
        self.recovery -= recovered;
        self.worked += passed - recovered;
    }

    /// How long the sim was at work, without interruptions and what it took to recover from them.
    pub(super) fn worked(&self) -> Duration {
        self.worked
    }

    /// Whether the sim was interrupted a moment ago.
    pub(super) fn is_recovering(&self) -> bool {
        !self.recovery.is_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_that_was_lost_does_not_count_and_the_time_to_recover_neither() {
        let start = bus::clock::now();
        let mut time = WorkingTime::new(start);
        for (at_s, waited_s, worked_s, is_recovering, what) in [
            (0.5, 0.0, 0.5, false, "its own work"),
            (5.5, 5.0, 5.5, false, "it waited for somebody"),
            (6.4, 0.05, 6.4, false, "it waited a little longer than it wanted to"),
            (21.4, 0.05, 6.4, true, "it was suspended for fifteen seconds"),
            (22.0, 0.6, 6.4, true, "it recovers"),
            (40.0, 0.05, 6.4, true, "it was suspended again"),
            (49.0, 9.0, 6.4, true, "it recovers from that too"),
            (52.0, 3.0, 8.4, false, "it is back"),
        ] {
            time.pass(start + Duration::from_secs_f64(at_s), Duration::from_secs_f64(waited_s));
            let worked = time.worked().as_secs_f64();
            assert!((worked - worked_s).abs() < 1e-6, "{at_s} s, {what}: {worked}");
            assert_eq!(time.is_recovering(), is_recovering, "{at_s} s, {what}");
        }
    }
}
