//! The playback position in a recording, and how it moves.

use primitives::SimTime;
use std::time::{Duration, Instant};

/// Limits of the playback speed, simulated seconds per second.
const SPEED: (f64, f64) = (0.01, 100.0);

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Playback {
    from: SimTime,
    to: SimTime,
    at: SimTime,
    /// When `at` began to advance; `None` while paused.
    since: Option<Instant>,
    /// The speed, simulated seconds per second.
    pub(super) speed: f64,
}

impl Playback {
    /// A paused playback at the beginning.
    pub(super) fn new(from: SimTime, to: SimTime) -> Playback {
        Playback {
            from,
            to,
            at: from,
            since: None,
            speed: 1.0,
        }
    }

    /// The moment shown.
    pub(super) fn at(&self, now: Instant) -> SimTime {
        let Some(since) = self.since else {
            return self.at;
        };
        let passed_s = now.saturating_duration_since(since).as_secs_f64() * self.speed;
        (self.at + SimTime::from_s(passed_s)).min(self.to)
    }

    /// Whether the position is advancing.
    pub(super) fn is_playing(&self) -> bool {
        self.since.is_some()
    }

    /// When a moment will be shown without further commands; `None` means never.
    pub(super) fn when(&self, moment: SimTime) -> Option<Instant> {
        let ahead_s = (moment - self.at).as_s().max(0.0) / self.speed;
        self.since?
            .checked_add(Duration::try_from_secs_f64(ahead_s).ok()?)
    }

    /// Plays. At the end, restarts from the beginning.
    pub(super) fn play(&mut self, now: Instant) {
        if self.since.is_none() {
            self.at = if self.at >= self.to {
                self.from
            } else {
                self.at
            };
            self.since = Some(now);
        }
    }

    pub(super) fn pause(&mut self, now: Instant) {
        self.at = self.at(now);
        self.since = None;
    }

    /// Pauses at the end. Returns whether the end has just been reached.
    pub(super) fn end(&mut self, now: Instant) -> bool {
        let ends = self.since.is_some() && self.at(now) >= self.to;
        if ends {
            self.pause(now);
        }
        ends
    }

    /// Jumps to a moment; continues playing, or stays paused.
    pub(super) fn seek(&mut self, moment: SimTime, now: Instant) {
        self.at = moment.clamp(self.from, self.to.max(self.from));
        self.since = self.since.map(|_| now);
    }

    /// Sets the speed, simulated seconds per second; `None` means the maximum.
    pub(super) fn set_speed(&mut self, speed: Option<f64>, now: Instant) {
        self.at = self.at(now);
        self.since = self.since.map(|_| now);
        self.speed = speed.unwrap_or(SPEED.1).clamp(SPEED.0, SPEED.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::clock;

    #[test]
    fn it_plays_by_the_clock_to_the_end_and_then_from_the_beginning() {
        let start = clock::now();
        let later = |s: f64| start + Duration::from_secs_f64(s);
        let mut playback = Playback::new(SimTime::from_s(10.0), SimTime::from_s(20.0));
        assert_eq!(
            playback.at(later(5.0)),
            SimTime::from_s(10.0),
            "a playback starts paused"
        );
        playback.play(start);
        assert_eq!(playback.at(later(2.0)), SimTime::from_s(12.0));
        playback.set_speed(Some(4.0), later(2.0));
        assert_eq!(playback.at(later(3.0)), SimTime::from_s(16.0));
        assert_eq!(playback.when(SimTime::from_s(20.0)), Some(later(4.0)));
        assert!(!playback.end(later(3.9)) && playback.end(later(9.0)) && !playback.end(later(9.0)));
        assert_eq!(
            (playback.is_playing(), playback.at(later(9.0))),
            (false, SimTime::from_s(20.0))
        );
        playback.play(later(9.0));
        assert_eq!(playback.at(later(9.0)), SimTime::from_s(10.0));
    }

    #[test]
    fn it_goes_where_it_is_told_within_the_recording() {
        let start = clock::now();
        let mut playback = Playback::new(SimTime::from_s(10.0), SimTime::from_s(20.0));
        for (to_s, want_s) in [(15.0, 15.0), (-4.0, 10.0), (1e30, 20.0)] {
            playback.seek(SimTime::from_s(to_s), start);
            assert_eq!(playback.at(start), SimTime::from_s(want_s), "{to_s}");
        }
        playback.set_speed(None, start);
        assert_eq!(playback.speed, SPEED.1);
        playback.set_speed(Some(0.0), start);
        assert_eq!(playback.speed, SPEED.0);
    }
}
