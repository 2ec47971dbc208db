//! Reseeding: keeps a game unchanged up to a certain time and redraws what follows, so that one
//! past can have several futures.
//!
//! Draws after that time use a new seed. Earlier draws stay the same, and so do those for the whole
//! game (waves, start positions, roles). A process with memory, such as gusts or receiver drift,
//! continues from its current state: the new future is a possible continuation of the same past.

use crate::stream::Noise;
use crate::time::SimTime;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A time after which a new seed applies. Earlier draws are unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reseed {
    /// Time, s.
    #[schemars(range(min = 0, max = 86400))]
    pub after_s: f64,
    /// Seed of all later draws.
    #[schemars(range(min = 0, max = i64::MAX))]
    pub seed: u64,
}

/// The seed of a game, and the seeds that replace it later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seeds {
    first: u64,
    /// The times, ascending, with the seed of draws after each.
    later: Vec<(SimTime, u64)>,
}

impl From<u64> for Seeds {
    fn from(seed: u64) -> Seeds {
        Seeds {
            first: seed,
            later: vec![],
        }
    }
}

impl Seeds {
    /// The first seed and its replacements, by ascending time.
    pub fn new(first: u64, reseed: &[Reseed]) -> Seeds {
        Seeds {
            first,
            later: reseed
                .iter()
                .map(|one| (SimTime::from_s(one.after_s), one.seed))
                .collect(),
        }
    }

    /// The seed of draws for the whole game.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// The replacement seeds: the seed of draws after each time, by ascending time.
    pub fn later(&self) -> &[(SimTime, u64)] {
        &self.later
    }

    /// The noise `name` of this game.
    pub fn noise(&self, name: &str) -> TimedNoise {
        let later = self
            .later
            .iter()
            .map(|(after, seed)| (*after, Noise::new(*seed, name)));
        TimedNoise {
            first: Noise::new(self.first, name),
            later: later.collect(),
        }
    }
}

/// A noise that is replaced with others at certain times.
#[derive(Clone, Debug)]
pub struct TimedNoise {
    first: Noise,
    later: Vec<(SimTime, Noise)>,
}

impl TimedNoise {
    /// The noise for draws at `now`.
    #[inline]
    pub fn at(&self, now: SimTime) -> Noise {
        // The noise changes at a certain time, and no snapshot is restored: the past is replayed,
        // which at most doubles the time of a branch. In return, a branch is a game like any other,
        // minds included, specified by a seed and a setting on the command line.
        let begun = |(after, _): &&(SimTime, Noise)| *after < now;
        self.later
            .iter()
            .rev()
            .find(begun)
            .map_or(self.first, |(_, noise)| *noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_seed_counts_from_after_its_time_on() {
        let reseed = [(10.0, 2), (20.0, 3)].map(|(after_s, seed)| Reseed { after_s, seed });
        let noise = Seeds::new(1, &reseed).noise("gps/a");
        for (at_s, seed) in [
            (0.0, 1),
            (10.0, 1),
            (10.001, 2),
            (20.0, 2),
            (20.1, 3),
            (1e4, 3),
        ] {
            assert_eq!(
                noise.at(SimTime::from_s(at_s)),
                Noise::new(seed, "gps/a"),
                "{at_s} s"
            );
        }
        assert_eq!(
            Seeds::from(1).noise("gps/a").at(SimTime::from_s(15.0)),
            Noise::new(1, "gps/a")
        );
    }
}
