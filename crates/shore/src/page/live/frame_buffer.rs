//! A buffer of frames: the newest frame to show, and past frames for trails.

use crate::page::view::{Outgoing, TRAIL_S, TRAIL_STEP_S};
use messages::{Frame, Stamp};
use primitives::SimTime;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Period over which the frame rate is measured.
const METER: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, Default)]
pub(super) struct FrameBuffer {
    /// The number of frames so far, which is also the number of the newest, counted from 1.
    pub(super) count: u64,
    pub(super) stamp: Stamp,
    /// Whether the game is over.
    pub(super) is_over: bool,
    /// When the newest frame arrived.
    pub(super) came: Option<Instant>,
    pub(super) newest: Option<Outgoing>,
    past: VecDeque<(SimTime, Outgoing)>,
    counted: Option<(Instant, u64)>,
    rate_hz: f64,
}

impl FrameBuffer {
    /// Adds a frame with its CDR. Returns whether frames before it were missed.
    pub(super) fn take(&mut self, frame: &Frame, cdr: &[u8], now: Instant) -> bool {
        let at = frame.stamp.valid_ns;
        let seq = frame.stamp.seq;
        let missed = self.count > 0 && seq > self.stamp.seq.saturating_add(1);
        if at < self.stamp.valid_ns {
            self.past.clear();
        }
        if self
            .past
            .back()
            .is_none_or(|(last, _)| (at - *last).as_s() >= TRAIL_STEP_S)
        {
            self.past.push_back((at, Outgoing::past(cdr)));
        }
        while self
            .past
            .front()
            .is_some_and(|(first, _)| (at - *first).as_s() > TRAIL_S)
        {
            self.past.pop_front();
        }
        // Pass on the sim's own bytes: the page decodes CDR with the `.msg` files in the first
        // message, so no second encoding can diverge.
        (self.stamp, self.is_over, self.newest) =
            (frame.stamp, frame.over, Some(Outgoing::now(cdr)));
        (self.count, self.came) = (self.count + 1, Some(now));
        self.measure(now);
        missed
    }

    /// The past frames before the newest.
    pub(super) fn past(&self) -> VecDeque<Outgoing> {
        let before = self.past.iter().filter(|(at, _)| *at < self.stamp.valid_ns);
        before.map(|(_, frame)| frame.clone()).collect()
    }

    pub(super) fn rate_hz(&self, now: Instant) -> f64 {
        let is_late = self
            .counted
            .is_none_or(|(since, _)| now.saturating_duration_since(since) > 2 * METER);
        if is_late { 0.0 } else { self.rate_hz }
    }

    fn measure(&mut self, now: Instant) {
        let (since, count) = *self.counted.get_or_insert((now, self.count));
        let passed = now.saturating_duration_since(since);
        if passed >= METER {
            self.rate_hz = (self.count - count) as f64 / passed.as_secs_f64();
            self.counted = Some((now, self.count));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::clock;

    fn frame(seq: u64) -> Frame {
        let stamp = Stamp {
            valid_ns: SimTime(100_000_000 * seq as i64),
            seq,
            version: 3,
        };
        Frame {
            stamp,
            ..Frame::default()
        }
    }

    #[test]
    fn the_newest_is_shown_and_a_minute_is_kept() {
        let start = clock::now();
        let mut frames = FrameBuffer::default();
        for seq in 0..2000 {
            assert!(!frames.take(
                &frame(seq),
                &seq.to_le_bytes(),
                start + Duration::from_millis(100) * seq as u32
            ));
        }
        assert_eq!(frames.newest, Some(Outgoing::now(&1999_u64.to_le_bytes())));
        let past = frames.past();
        assert_eq!(past.len(), 120);
        assert_eq!(past[119], Outgoing::past(&1995_u64.to_le_bytes()));
        let end = start + Duration::from_millis(199_900);
        assert!((frames.rate_hz(end) - 10.0).abs() < 0.1);
        assert_eq!(frames.rate_hz(end + Duration::from_secs(5)), 0.0);
    }

    #[test]
    fn a_gap_is_noticed_and_a_new_beginning_forgets_the_past() {
        let start = clock::now();
        let mut frames = FrameBuffer::default();
        assert!(
            !frames.take(&frame(7), &[], start),
            "frames before the first are not missed"
        );
        assert!(!frames.take(&frame(8), &[], start) && frames.take(&frame(10), &[], start));
        assert!(!frames.take(&frame(0), &[], start));
        assert!(frames.past().is_empty());
    }
}
