//! Selects the nearest boats or obstacles for a behaviour; nearer ones weigh more.

use crate::situation::{OtherBoat, Situation};
use scenario::strategy::{Boat, Contacts, NEAREST_MAX};

/// How far ahead to predict entry to the side where the boat can be tagged, s.
const TAG_FORESIGHT_S: f64 = 5.0;

/// The nearest few, without heap allocation; no behaviour responds to more.
#[derive(Clone)]
pub(super) struct Nearest {
    /// Distance (m) and index; nearest first, then lowest index.
    entries: [(f64, usize); NEAREST_MAX],
    count: usize,
}

impl Default for Nearest {
    fn default() -> Nearest {
        Nearest {
            entries: [(f64::INFINITY, 0); NEAREST_MAX],
            count: 0,
        }
    }
}

impl Nearest {
    pub(super) fn of(those: impl Iterator<Item = (f64, usize)>) -> Nearest {
        let mut nearest = Nearest::default();
        those.for_each(|entry| nearest.add(entry));
        nearest
    }

    pub(super) fn add(&mut self, entry: (f64, usize)) {
        let place = self.entries[..self.count].partition_point(|known| *known <= entry);
        // Keep at most sixteen, to bound the cost of a decision for any fleet, and keep the
        // nearest, so that the order of the list does not matter.
        if place < NEAREST_MAX {
            self.count = (self.count + 1).min(NEAREST_MAX);
            self.entries[place..self.count].rotate_right(1);
            self.entries[place] = entry;
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (f64, usize)> {
        self.entries[..self.count].iter().copied()
    }
}

/// The fraction of a weight at a distance: 1 up to `inner_m`, 0 from `outer_m` on.
pub(super) fn nearness(distance_m: f64, inner_m: f64, outer_m: f64) -> f64 {
    if distance_m <= inner_m {
        1.0
    } else if distance_m >= outer_m {
        0.0
    } else {
        (outer_m - distance_m) / (outer_m - inner_m)
    }
}

/// Whether `contacts` includes this boat.
pub(super) fn is_meant(contacts: Contacts, situation: &Situation, other: &OtherBoat) -> bool {
    match contacts {
        Contacts::All => true,
        Contacts::Enemies => other.is_enemy,
        Contacts::Mates => !other.is_enemy,
        // Boats that stay farther from enemies than the tag distance never tag anyone, and all
        // strategies score alike. A strategy may therefore avoid only boats with which no tag is
        // possible.
        Contacts::NoTag => !other.is_enemy || other.tagged || situation.own.tagged,
        Contacts::Opponent => {
            let opponent = situation
                .boat(Boat::Opponent)
                .map(|opponent| opponent.vehicle);
            opponent == Some(other.vehicle) && is_meant(Contacts::Taggers, situation, other)
        }
        Contacts::Taggers => {
            // An enemy tags only on its own side, and already counts when this boat is about to
            // enter that side.
            let soon = situation.at + situation.velocity.scaled(TAG_FORESIGHT_S);
            let exposed =
                !situation.model.is_own_side(situation.at) || !situation.model.is_own_side(soon);
            other.is_enemy && !other.tagged && !other.intrudes && exposed && !situation.own.tagged
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{NEAREST_MAX, Nearest, nearness};

    #[test]
    fn the_nearest_of_many_come_in_order() {
        let many: Vec<(f64, usize)> = (0..100)
            .map(|i| (f64::from((i * 37) % 50), i as usize))
            .collect();
        let mut sorted = many.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        sorted.truncate(NEAREST_MAX);
        assert!(Nearest::of(many.into_iter()).iter().eq(sorted));
        assert_eq!(
            Nearest::of([(2.0, 0), (1.0, 1)].into_iter())
                .iter()
                .collect::<Vec<_>>(),
            [(1.0, 1), (2.0, 0)]
        );
    }

    #[test]
    fn a_weight_falls_from_inner_to_outer_and_never_exceeds_itself() {
        for (distance_m, want) in [
            (0.0, 1.0),
            (10.0, 1.0),
            (15.0, 0.5),
            (20.0, 0.0),
            (90.0, 0.0),
        ] {
            assert!(
                (nearness(distance_m, 10.0, 20.0) - want).abs() < 1e-12,
                "{distance_m} m"
            );
        }
        assert!(
            nearness(5.0, 5.0, 5.0) == 1.0 && nearness(5.1, 5.0, 5.0) == 0.0,
            "a step"
        );
    }
}
