//! A Gauss-Markov process with a cached window of grid points and linear interpolation.
//!
//! Points outside the window are recomputed, which is slower but gives the same bits.

use super::gauss_markov::{GaussMarkov, Pair, Trail};

/// Maximum number of cached points.
const HELD_MAX: i64 = 1 << 16;

#[derive(Clone, Debug)]
pub(super) struct CachedProcess {
    process: GaussMarkov,
    /// The correlation of neighbouring points.
    correlation: f64,
    trail: Trail,
    /// Point i is stored at i modulo the length, which is a power of two.
    ring: Vec<Pair>,
    /// The cached points: first (inclusive) to last (exclusive).
    held: (i64, i64),
}

impl CachedProcess {
    /// A process that caches at least `points` points, but at most [`HELD_MAX`].
    pub(super) fn new(process: GaussMarkov, points: f64) -> CachedProcess {
        let correlation = GaussMarkov::neighbour_correlation();
        let length = (points.ceil() as i64).saturating_add(3).clamp(1, HELD_MAX) as u64;
        // The length is a power of two, so that finding a slot takes a mask rather than a division.
        let ring = vec![(0.0, 0.0); length.next_power_of_two() as usize];
        CachedProcess {
            process,
            correlation,
            trail: Trail::default(),
            ring,
            held: (0, 0),
        }
    }

    /// Caches the points between two places.
    pub(super) fn hold(&mut self, from: f64, to: f64) {
        let first = from.floor() as i64;
        let end = (to.floor() as i64 + 2).min(first + self.ring.len() as i64);
        let known = if (self.held.0..=self.held.1).contains(&first) {
            self.held.1
        } else {
            first
        };
        for index in known..end {
            let slot = self.slot(index);
            self.ring[slot] = self.process.at(index, &mut self.trail);
        }
        self.held = (first, end.max(known));
    }

    /// The pair of processes at a place, each with mean 0 and variance 1.
    ///
    /// Linear interpolation reduces the variance to (1−w)² + w² + 2 w (1−w) ρ. Without dividing by
    /// its square root, gusts would be weaker between grid points.
    #[inline]
    pub(super) fn at(&self, place: f64) -> Pair {
        let floor = place.floor();
        let index = floor as i64;
        let weight = place - floor;
        let (low, high) = self.neighbours(index);
        let product = 2.0 * weight * (1.0 - weight);
        let deviation = (1.0 - product * (1.0 - self.correlation)).sqrt();
        let between = |low: f64, high: f64| (low + weight * (high - low)) / deviation;
        (between(low.0, high.0), between(low.1, high.1))
    }

    /// A point and the next one.
    #[inline]
    fn neighbours(&self, index: i64) -> (Pair, Pair) {
        if self.held.0 <= index && index + 1 < self.held.1 {
            return (self.ring[self.slot(index)], self.ring[self.slot(index + 1)]);
        }
        // The two points share most of their path.
        let mut trail = Trail::default();
        (
            self.process.at(index, &mut trail),
            self.process.at(index + 1, &mut trail),
        )
    }

    #[inline]
    fn slot(&self, index: i64) -> usize {
        index as usize & (self.ring.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn process() -> GaussMarkov {
        GaussMarkov::new(&1.into(), "test", |now| now.as_s())
    }

    #[test]
    fn the_cache_changes_no_bit() {
        let bare = CachedProcess::new(process(), 0.0);
        let mut cached = CachedProcess::new(process(), 40.0);
        // Small and large steps ahead, steps back, beyond the ring, and below zero.
        for from in [
            0.0, 0.4, 1.7, 30.2, 31.0, 200.5, 5.5, 6.5, -70.2, -1030.0, 1e6,
        ] {
            cached.hold(from, from + 40.0);
            for place in [
                from - 90.0,
                from - 0.1,
                from,
                from + 0.3,
                from + 17.5,
                from + 40.0,
                from + 99.9,
            ] {
                assert_eq!(
                    cached.at(place),
                    bare.at(place),
                    "holding {from}, at {place}"
                );
            }
        }
    }

    #[test]
    fn the_ring_is_filled_no_further_than_it_is_long() {
        let bare = CachedProcess::new(process(), 0.0);
        let mut cached = CachedProcess::new(process(), 10.0);
        cached.hold(0.0, 1000.0);
        for place in [0.5, 9.5, 15.5, 16.5, 500.5] {
            assert_eq!(cached.at(place), bare.at(place));
        }
    }
}
