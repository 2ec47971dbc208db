//! The gateway's monotonic clock, which keeps running while the machine is suspended. For an
//! emulated boat, it can run at the game's pace.

use bus::clock;
use primitives::SimTime;
use std::time::{Duration, Instant};

/// Minimum difference between the two clocks that counts as a suspension: they are not read
/// simultaneously.
const SUSPENSION_MIN: Duration = Duration::from_millis(50);

/// A moment, and the total suspended time until then.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    pub(super) at: Instant,
    suspended: Duration,
}

impl Moment {
    pub(super) fn now() -> Moment {
        Moment {
            at: clock::now(),
            suspended: clock::suspended(),
        }
    }

    /// The time from this moment to `now`, and how long the machine was suspended in between, if it
    /// was.
    pub(super) fn gap(self, now: Moment) -> (Duration, Option<Duration>) {
        // Linux's monotonic clock stops during sleep. The time asleep is added, so that old data
        // counts as old after waking.
        let suspended = now.suspended.saturating_sub(self.suspended);
        let awake = now.at.saturating_duration_since(self.at);
        (
            awake + suspended,
            (suspended >= SUSPENSION_MIN).then_some(suspended),
        )
    }
}

/// Time since the gateway started.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    start: Moment,
    /// The clock's time at `start`.
    base: SimTime,
    factor: f64,
}

impl Clock {
    pub(super) fn start() -> Clock {
        Clock {
            start: Moment::now(),
            base: SimTime::ZERO,
            factor: 1.0,
        }
    }

    /// From now on, runs at this multiple of real time, the game's pace.
    pub(super) fn set_pace(&mut self, factor: f64) {
        let now = Moment::now();
        *self = Clock {
            base: self.time_at(now),
            start: now,
            factor,
        };
    }

    pub(super) fn now(&self) -> SimTime {
        self.time_at(Moment::now())
    }

    /// The gateway's time at this instant, which must be after the last suspension of the machine.
    pub(super) fn at(&self, at: Instant) -> SimTime {
        self.time_at(Moment {
            at,
            ..Moment::now()
        })
    }

    fn time_at(&self, moment: Moment) -> SimTime {
        let (passed, _) = self.start.gap(moment);
        self.base + SimTime::from_s(passed.as_secs_f64() * self.factor)
    }

    /// Real time until the gateway's time `due`.
    pub(super) fn until(&self, due: SimTime) -> Duration {
        let wait_s = (due - self.now()).as_s() / self.factor;
        Duration::from_secs_f64(wait_s.clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_suspended_machine_slept_counts_as_time_and_as_a_gap() {
        let clock = Clock::start();
        let second = Duration::from_secs(1);
        let hour = Duration::from_secs(3600);
        let before = clock.start;
        let after = |suspended| Moment {
            at: before.at + second,
            suspended: before.suspended + suspended,
        };
        assert_eq!(clock.time_at(after(Duration::ZERO)), SimTime::from_s(1.0));
        assert_eq!(clock.time_at(after(hour)), SimTime::from_s(3601.0));
        assert_eq!(before.gap(after(Duration::ZERO)), (second, None));
        assert_eq!(before.gap(after(hour)), (second + hour, Some(hour)));
    }

    #[test]
    fn the_clock_of_this_machine_does_not_run_backwards() {
        let clock = Clock::start();
        let times: Vec<SimTime> = (0..1000).map(|_| clock.now()).collect();
        let backwards = times
            .windows(2)
            .map(|two| (two[0] - two[1]).as_s())
            .fold(0.0, f64::max);
        // The two clocks are read one after the other.
        assert!(backwards < 0.01, "{backwards} s");
    }
}
