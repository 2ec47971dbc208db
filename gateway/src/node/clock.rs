//! The gateway's monotonic clock, which includes time that the machine is suspended. In a game
//! faster than real time it runs at the game's pace.

use bus::clock;
use primitives::SimTime;
use std::time::{Duration, Instant};

/// Time since the gateway started.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    start: Instant,
    /// Total suspended time at `start`.
    suspended: Duration,
    /// Its time at `start`.
    base: SimTime,
    factor: f64,
}

impl Clock {
    pub(super) fn start() -> Clock {
        Clock { start: clock::now(), suspended: clock::suspended(), base: SimTime::ZERO, factor: 1.0 }
    }

    /// Runs at this pace of a game from now on.
    pub(super) fn set_pace(&mut self, factor: f64) {
        let (now, suspended) = (clock::now(), clock::suspended());
        *self = Clock { base: self.time_at(now, suspended), start: now, suspended, factor };
    }

    pub(super) fn now(&self) -> SimTime {
        self.at(clock::now())
    }

    /// The gateway's time at a moment of real time since the machine was last suspended.
    pub(super) fn at(&self, moment: Instant) -> SimTime {
        self.time_at(moment, clock::suspended())
    }

    fn time_at(&self, moment: Instant, suspended: Duration) -> SimTime {
        // Linux' monotonic clock stops while the machine sleeps. The time asleep is added, so that
        // old data counts as old after waking.
        let passed = moment.saturating_duration_since(self.start) + suspended.saturating_sub(self.suspended);
        self.base + SimTime::from_s(passed.as_secs_f64() * self.factor)
    }

    /// Real time until the gateway's time `due`.
    pub(super) fn until(&self, due: SimTime) -> Duration {
        let wait_s = (due - self.now()).as_s() / self.factor;
        Duration::from_secs_f64(wait_s.clamp(0.0, 1.0))
    }
}

/// When the gateway's loop last ran, and the total suspended time by then.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastRun {
    at: Instant,
    suspended: Duration,
}

/// Minimum time that counts as a suspension: the two clocks are not read simultaneously.
const SUSPENSION_MIN: Duration = Duration::from_millis(50);

impl LastRun {
    pub(super) fn now() -> LastRun {
        LastRun { at: clock::now(), suspended: clock::suspended() }
    }

    /// How long the loop has not run until `now`, and how long of that the machine was suspended,
    /// if it was.
    pub(super) fn gap(self, now: LastRun) -> (Duration, Option<Duration>) {
        let suspended = now.suspended.saturating_sub(self.suspended);
        let awake = now.at.saturating_duration_since(self.at);
        (awake + suspended, (suspended >= SUSPENSION_MIN).then_some(suspended))
    }

    /// The moment.
    pub(super) fn moment(self) -> Instant {
        self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_suspended_machine_slept_counts_as_time_and_as_a_gap() {
        let clock = Clock::start();
        let (second, hour) = (Duration::from_secs(1), Duration::from_secs(3600));
        let later = clock.start + second;
        assert_eq!(clock.time_at(later, clock.suspended), SimTime::from_s(1.0));
        assert_eq!(clock.time_at(later, clock.suspended + hour), SimTime::from_s(3601.0));
        let before = LastRun::now();
        let after = |suspended| LastRun { at: before.at + second, suspended: before.suspended + suspended };
        assert_eq!(before.gap(after(Duration::ZERO)), (second, None));
        assert_eq!(before.gap(after(hour)), (second + hour, Some(hour)));
    }

    #[test]
    fn the_clock_of_this_machine_does_not_run_backwards() {
        let clock = Clock::start();
        let times: Vec<SimTime> = (0..1000).map(|_| clock.now()).collect();
        let backwards = times.windows(2).map(|two| (two[0] - two[1]).as_s()).fold(0.0, f64::max);
        // The two clocks are read one after the other.
        assert!(backwards < 0.01, "{backwards} s");
    }
}
