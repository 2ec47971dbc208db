//! The gateway's monotonic clock; in a game that runs faster than real time it runs as fast as the game.

use bus::clock;
use game::SimTime;
use std::time::{Duration, Instant};

/// Time since the gateway began.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    start: Instant,
    /// Its time at `start`.
    base: SimTime,
    factor: f64,
}

impl Clock {
    pub(super) fn start() -> Clock {
        Clock { start: clock::now(), base: SimTime::ZERO, factor: 1.0 }
    }

    /// From now on it runs as fast as a game of this pace.
    pub(super) fn set_pace(&mut self, factor: f64) {
        let now = clock::now();
        *self = Clock { base: self.at(now), start: now, factor };
    }

    pub(super) fn now(&self) -> SimTime {
        self.at(clock::now())
    }

    /// The gateway's time at a moment of real time.
    pub(super) fn at(&self, moment: Instant) -> SimTime {
        self.base + SimTime::from_s(moment.saturating_duration_since(self.start).as_secs_f64() * self.factor)
    }

    /// How long it is in real time until the gateway's time `due`.
    pub(super) fn until(&self, due: SimTime) -> Duration {
        let wait_s = (due - self.now()).as_s() / self.factor;
        Duration::from_secs_f64(wait_s.clamp(0.0, 1.0))
    }
}
