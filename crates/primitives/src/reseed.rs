//! A game that is the same up to a time and drawn anew from then on: one past, several futures.
//!
//! What is drawn after the time comes from another seed; what has been drawn by then, and what is drawn once for the whole game (the
//! waves, where boats start, roles), stays. A process with a memory, such as gusts or the drift of a receiver, goes on from where it is,
//! so the new future is one that the same past may have.

use crate::stream::Noise;
use crate::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// From when on chance is drawn anew, and by which seed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reseed {
    /// What is drawn after this time is drawn by `seed`, s.
    #[schemars(range(min = 0, max = 86400))]
    pub after_s: f64,
    /// Chooses what is drawn.
    #[schemars(range(min = 0, max = i64::MAX))]
    pub seed: u64,
}

/// The seed of a game, and those that take its place later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seeds {
    first: u64,
    /// By rising time: what is drawn after it comes from this seed.
    later: Vec<(SimTime, u64)>,
}

impl From<u64> for Seeds {
    fn from(seed: u64) -> Seeds {
        Seeds { first: seed, later: vec![] }
    }
}

impl Seeds {
    /// A seed, and what takes its place; by rising times.
    #[must_use]
    pub fn new(first: u64, reseed: &[Reseed]) -> Seeds {
        Seeds { first, later: reseed.iter().map(|one| (SimTime::from_s(one.after_s), one.seed)).collect() }
    }

    /// The seed of what is drawn once for the whole game.
    #[must_use]
    pub fn first(&self) -> u64 {
        self.first
    }

    /// Those that take its place: the seed of what is drawn after each time, by rising time.
    #[must_use]
    pub fn later(&self) -> &[(SimTime, u64)] {
        &self.later
    }

    /// The noise `name` of this game.
    #[must_use]
    pub fn noise(&self, name: &str) -> TimedNoise {
        let later = self.later.iter().map(|(after, seed)| (*after, Noise::new(*seed, name)));
        TimedNoise { first: Noise::new(self.first, name), later: later.collect() }
    }
}

/// A noise that another takes the place of at certain times.
#[derive(Clone, Debug)]
pub struct TimedNoise {
    first: Noise,
    later: Vec<(SimTime, Noise)>,
}

impl TimedNoise {
    /// What is drawn at `now` is drawn from this.
    #[inline]
    #[must_use]
    pub fn at(&self, now: SimTime) -> Noise {
        // Another key from a time on, and no snapshot. The past is played again, at most twice
        // the time of a branch; for that a branch is a game like any other, with a seed and a
        // key on the command line, minds included.
        let begun = |(after, _): &&(SimTime, Noise)| *after < now;
        self.later.iter().rev().find(begun).map_or(self.first, |(_, noise)| *noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_seed_counts_from_after_its_time_on() {
        let reseed = [(10.0, 2), (20.0, 3)].map(|(after_s, seed)| Reseed { after_s, seed });
        let noise = Seeds::new(1, &reseed).noise("gps/a");
        for (at_s, seed) in [(0.0, 1), (10.0, 1), (10.001, 2), (20.0, 2), (20.1, 3), (1e4, 3)] {
            assert_eq!(noise.at(SimTime::from_s(at_s)), Noise::new(seed, "gps/a"), "{at_s} s");
        }
        assert_eq!(Seeds::from(1).noise("gps/a").at(SimTime::from_s(15.0)), Noise::new(1, "gps/a"));
    }
}
