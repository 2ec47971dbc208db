//! Locks that let one page at a time steer a boat.

use primitives::VehicleId;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Silence after which a page loses its locks.
const SILENCE: Duration = Duration::from_secs(2);

/// By boat: the page that steers it, and when the page last confirmed its lock.
#[derive(Clone, Debug, Default)]
pub(super) struct SteeringLocks(BTreeMap<VehicleId, (u64, Instant)>);

impl SteeringLocks {
    /// Acquires or confirms a page's lock. Returns whether the page may steer.
    pub(super) fn acquire(&mut self, vehicle: VehicleId, page: u64, now: Instant) -> bool {
        self.expire(now);
        let (holder, at) = self.0.entry(vehicle).or_insert((page, now));
        if *holder == page {
            *at = now;
        }
        *holder == page
    }

    /// Releases a page's lock. Returns whether the page held it.
    pub(super) fn release(&mut self, vehicle: VehicleId, page: u64) -> bool {
        let has = self.holder(vehicle) == Some(page);
        if has {
            self.0.remove(&vehicle);
        }
        has
    }

    /// Releases all locks of a page that has disconnected.
    pub(super) fn release_all(&mut self, page: u64) {
        self.0.retain(|_, (holder, _)| *holder != page);
    }

    /// Releases the boats of silent pages. Returns whether any were released.
    pub(super) fn expire(&mut self, now: Instant) -> bool {
        let before = self.0.len();
        self.0
            .retain(|_, (_, at)| now.saturating_duration_since(*at) < SILENCE);
        self.0.len() != before
    }

    /// The page that steers a boat.
    pub(super) fn holder(&self, vehicle: VehicleId) -> Option<u64> {
        self.0.get(&vehicle).map(|(holder, _)| *holder)
    }

    pub(super) fn held(&self) -> impl Iterator<Item = VehicleId> + '_ {
        self.0.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::clock;

    #[test]
    fn one_page_steers_until_it_releases_closes_or_falls_silent() {
        let start = clock::now();
        let later = |s: f64| start + Duration::from_secs_f64(s);
        let a = VehicleId(0);
        let b = VehicleId(1);
        let mut steering_locks = SteeringLocks::default();
        assert!(
            steering_locks.acquire(a, 1, start)
                && !steering_locks.acquire(a, 2, later(1.9))
                && steering_locks.acquire(b, 2, start)
        );
        assert!(
            !steering_locks.release(a, 2)
                && steering_locks.release(a, 1)
                && steering_locks.acquire(a, 2, later(1.9))
        );
        assert!(
            !steering_locks.expire(later(1.0)) && steering_locks.expire(later(2.5)),
            "b is free"
        );
        assert_eq!(steering_locks.held().collect::<Vec<_>>(), [a]);
        assert!(
            steering_locks.acquire(a, 2, later(3.0))
                && !steering_locks.acquire(a, 3, later(4.9))
                && steering_locks.acquire(a, 3, later(5.1))
        );
        steering_locks.release_all(3);
        assert_eq!(steering_locks.holder(a), None);
    }
}
