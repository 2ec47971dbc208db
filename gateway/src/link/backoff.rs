//! The back-off of a link: the wait before it reconnects.

use std::time::Duration;

/// Minimum time for which a good connection receives bytes. The waits keep growing for a peer that
/// accepts and closes at once, or that dies after one line.
pub(super) const STEADY: Duration = Duration::from_secs(1);

/// Prevents a busy loop if the settings contain 0.
const SHORTEST: Duration = Duration::from_millis(10);

/// Waits that double from the first to the longest.
pub(super) struct Backoff {
    first: Duration,
    longest: Duration,
    next: Duration,
}

impl Backoff {
    pub(super) fn new(first: Duration, longest: Duration) -> Backoff {
        let first = first.max(SHORTEST);
        Backoff {
            first,
            longest: longest.max(first),
            next: first,
        }
    }

    /// The wait before the next attempt.
    pub(super) fn wait(&mut self) -> Duration {
        let wait = self.next;
        // By default, the wait is at most a second, in which an uncontrolled boat travels two or
        // three metres.
        self.next = wait.saturating_mul(2).min(self.longest);
        wait
    }

    /// Resets the waits if the connection received bytes for long enough.
    pub(super) fn note_connection(&mut self, received_for: Duration) {
        if received_for >= STEADY {
            self.next = self.first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waits_ms(backoff: &mut Backoff, count: usize) -> Vec<u128> {
        (0..count).map(|_| backoff.wait().as_millis()).collect()
    }

    #[test]
    fn waits_double_up_to_the_longest() {
        let ms = Duration::from_millis;
        for (first, longest, want) in [
            (
                ms(100),
                ms(5000),
                vec![100, 200, 400, 800, 1600, 3200, 5000, 5000],
            ),
            (ms(100), ms(100), vec![100, 100]),
            (ms(300), ms(100), vec![300, 300]),
            (ms(0), ms(0), vec![10, 10]),
        ] {
            let mut backoff = Backoff::new(first, longest);
            assert_eq!(
                waits_ms(&mut backoff, want.len()),
                want,
                "{first:?} to {longest:?}"
            );
        }
    }

    #[test]
    fn only_a_connection_that_received_for_some_time_resets_them() {
        let mut backoff = Backoff::new(Duration::from_millis(100), Duration::from_secs(5));
        waits_ms(&mut backoff, 2);
        backoff.note_connection(STEADY / 2);
        assert_eq!(waits_ms(&mut backoff, 1), [400]);
        backoff.note_connection(STEADY);
        assert_eq!(waits_ms(&mut backoff, 2), [100, 200]);
    }
}
