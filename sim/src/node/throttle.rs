//! Sends fewer pictures over a link that cannot carry all of them.
//!
//! QUIC queues the datagrams that its congestion window does not admit, up to a mebibyte of them.
//! Over a link slower than the sim, orders would answer older and older pictures. As in LEDBAT (RFC
//! 6817), the time in queues is the round-trip time beyond its recent minimum.

use std::time::{Duration, Instant};

/// Queueing time above which pictures are skipped.
const QUEUED_MAX: Duration = Duration::from_millis(300);
/// Maximum number of pictures skipped in a row: an order lives for a second, and the next picture
/// may be lost.
const SKIPPED_MAX: u32 = 2;
/// Window of the minimum round trip; the minimum covers one to two windows.
const WINDOW: Duration = Duration::from_secs(10);
/// Time without a reply after which a team counts as absent, not slow.
const ABSENT: Duration = Duration::from_secs(2);

/// The queues between the sim and the agents of a team.
pub(super) struct Throttle {
    /// The shortest round trips of the previous and the current window.
    shortest: [Duration; 2],
    opened: Instant,
    /// When the last reply arrived, and how long the reply and its picture were queued.
    last: (Instant, Duration),
    skipped: u32,
}

impl Throttle {
    pub(super) fn new(now: Instant) -> Throttle {
        Throttle {
            shortest: [Duration::MAX; 2],
            opened: now,
            last: (now, Duration::ZERO),
            skipped: 0,
        }
    }

    /// Records a reply with its round trip.
    pub(super) fn note(&mut self, now: Instant, round_trip: Duration) {
        if now.saturating_duration_since(self.opened) > WINDOW {
            (self.shortest, self.opened) = ([self.shortest[1], Duration::MAX], now);
        }
        self.shortest[1] = self.shortest[1].min(round_trip);
        self.last = (now, round_trip - self.shortest[0].min(self.shortest[1]));
    }

    /// Whether to send the next picture.
    pub(super) fn admits(&mut self, now: Instant) -> bool {
        let (at, queued) = self.last;
        let is_slow = queued > QUEUED_MAX && now.saturating_duration_since(at) < ABSENT;
        let skips = is_slow && self.skipped < SKIPPED_MAX;
        self.skipped = if skips { self.skipped + 1 } else { 0 };
        !skips
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_millis(100);

    /// The fraction of 600 pictures sent over a link with this one-way delay that carries one
    /// picture per `spacing`, and the last round trip.
    fn play(delay: Duration, spacing: Duration) -> (f64, Duration) {
        let start = bus::clock::now();
        let mut throttle = Throttle::new(start);
        let mut free = start;
        let mut answers = std::collections::VecDeque::new();
        let mut sent = 0;
        let mut last = Duration::ZERO;
        for tick in 0..600 {
            let now = start + tick * PERIOD;
            while let Some((at, asked)) =
                answers.pop_front_if(|(at, _): &mut (Instant, Instant)| *at <= now)
            {
                last = at - asked;
                throttle.note(at, last);
            }
            if throttle.admits(now) {
                free = free.max(now) + spacing;
                answers.push_back((free + 2 * delay, now));
                sent += 1;
            }
        }
        (f64::from(sent) / 600.0, last)
    }

    #[test]
    fn a_slow_link_gets_as_many_pictures_as_it_carries_and_a_fast_one_gets_all() {
        let ms = Duration::from_millis;
        for delay in [ms(1), ms(150), ms(300)] {
            let (share, round_trip) = play(delay, ms(10));
            assert!(
                share > 0.999 && round_trip <= 2 * delay + ms(10),
                "{delay:?}: {share}, {round_trip:?}"
            );
            let (share, round_trip) = play(delay, ms(200));
            assert!((0.4..0.6).contains(&share), "{delay:?}: {share}");
            // Pictures sent before a reply reveals the queue also wait in it. Without skipping, the
            // last round trip would take a minute.
            assert!(
                round_trip < 4 * delay + ms(1100),
                "{delay:?}: {round_trip:?}"
            );
        }
    }

    #[test]
    fn an_absent_team_gets_every_picture() {
        let start = bus::clock::now();
        let mut throttle = Throttle::new(start);
        throttle.note(start, PERIOD);
        throttle.note(start, 20 * PERIOD);
        assert!(!throttle.admits(start));
        assert!((0..10).all(|_| throttle.admits(start + ABSENT)));
    }
}
