//! The sim's working time, which limits how long it waits for other nodes. It excludes time in
//! which the sim was suspended or had no processor.

use std::time::{Duration, Instant};

/// Maximum duration of a cycle of the sim; a longer one counts as an interruption.
const TURN_MAX: Duration = Duration::from_secs(1);
/// Time after an interruption for lost links to return. It does not count against other nodes.
/// zenoh waits at most four seconds between two attempts to connect.
const RECOVERY: Duration = Duration::from_secs(10);

/// A clock that stops while its sim is interrupted.
pub(super) struct WorkingTime {
    looked: Instant,
    /// Working time without interruptions and recovery.
    pub(super) worked: Duration,
    /// Remaining time for which the clock stands still after an interruption.
    recovery: Duration,
}

impl WorkingTime {
    pub(super) fn new(now: Instant) -> WorkingTime {
        WorkingTime {
            looked: now,
            worked: Duration::ZERO,
            recovery: Duration::ZERO,
        }
    }

    /// Accounts for the time since the last call: a wait of up to `waited`, and the sim's own work.
    pub(super) fn pass(&mut self, now: Instant, waited: Duration) {
        let passed = now.saturating_duration_since(self.looked);
        self.looked = now;
        if passed.saturating_sub(waited) > TURN_MAX {
            // Allow ten more seconds: zenoh drops links after ten seconds of silence, and they must
            // be reopened. A shorter lease would detect broken links sooner, but also drop
            // suspended ones.
            self.recovery = RECOVERY;
            return;
        }
        let recovered = passed.min(self.recovery);
        self.recovery -= recovered;
        self.worked += passed - recovered;
    }

    /// Whether the sim is recovering from an interruption.
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
            (5.5, 5.0, 5.5, false, "it waited for another node"),
            (
                6.4,
                0.05,
                6.4,
                false,
                "it waited a little longer than requested",
            ),
            (
                21.4,
                0.05,
                6.4,
                true,
                "it was suspended for fifteen seconds",
            ),
            (22.0, 0.6, 6.4, true, "it recovers"),
            (40.0, 0.05, 6.4, true, "it was suspended again"),
            (49.0, 9.0, 6.4, true, "it recovers from that too"),
            (52.0, 3.0, 8.4, false, "it is back"),
        ] {
            time.pass(
                start + Duration::from_secs_f64(at_s),
                Duration::from_secs_f64(waited_s),
            );
            let worked = time.worked.as_secs_f64();
            assert!(
                (worked - worked_s).abs() < 1e-6,
                "{at_s} s, {what}: {worked}"
            );
            assert_eq!(time.is_recovering(), is_recovering, "{at_s} s, {what}");
        }
    }
}
