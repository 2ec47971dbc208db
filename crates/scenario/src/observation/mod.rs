//! Observations: the values that a policy receives. The crate `agent` encodes them.

pub mod pyquaticus;
pub mod squall;

use pyquaticus::Edition;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The values that a policy receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ObservationSpace {
    /// The values of Pyquaticus, in its order: 21 for the boat itself and 8 for each other boat,
    /// each from -1 to 1.
    Pyquaticus,
    /// The values of Pyquaticus from November 2023 to January 2024: `pyquaticus` without the
    /// scores. Distances are relative to the field's diagonal plus 10 m, except the distance to the
    /// scrimmage line, which is relative to half the field's width.
    #[serde(rename = "pyquaticus_2023")]
    Pyquaticus2023,
    /// The values of the 2026 competition: `pyquaticus`, plus whether each boat is out of action.
    #[serde(rename = "pyquaticus_2026")]
    Pyquaticus2026,
    /// Squall's own values: sensor and radio data, in a frame that is the same for both teams.
    Squall {
        /// Number of slots for teammates; if there are too few, the nearest get them.
        #[schemars(range(min = 0, max = 255))]
        mates: u8,
        /// Number of slots for enemies, nearest first.
        #[schemars(range(min = 0, max = 255))]
        enemies: u8,
        /// Number of successive decisions included, newest first.
        #[schemars(range(min = 1, max = 255), extend("default" = 1))]
        frames: u8,
    },
}

impl ObservationSpace {
    /// The version of Pyquaticus' observations; `None` for other spaces.
    pub fn edition(self) -> Option<Edition> {
        match self {
            ObservationSpace::Pyquaticus => Some(Edition::Of2025),
            ObservationSpace::Pyquaticus2023 => Some(Edition::Of2023),
            ObservationSpace::Pyquaticus2026 => Some(Edition::Of2026),
            ObservationSpace::Squall { .. } => None,
        }
    }

    /// Incremented when the meaning of a value changes.
    pub fn version(self) -> u32 {
        match self.edition() {
            Some(_) => pyquaticus::VERSION,
            None => squall::VERSION,
        }
    }

    /// The number of values for a boat with this many teammates and enemies.
    pub fn size(self, mates: usize, enemies: usize) -> usize {
        match (self, self.edition()) {
            (_, Some(edition)) => {
                let others = mates + enemies;
                edition.own_names().count() + others * edition.other_names().count()
            }
            (
                ObservationSpace::Squall {
                    mates,
                    enemies,
                    frames,
                },
                _,
            ) => {
                let others = usize::from(mates) + usize::from(enemies);
                usize::from(frames) * (squall::OWN_NAMES.len() + others * squall::OTHER)
            }
            _ => 0,
        }
    }

    /// The names of the values, in order. Names of older frames begin with their age in policy
    /// decisions: `t-1.speed`.
    pub fn names(self, mates: usize, enemies: usize) -> Vec<String> {
        match (self, self.edition()) {
            (_, Some(edition)) => {
                let own: Vec<&str> = edition.own_names().collect();
                let other: Vec<&str> = edition.other_names().collect();
                names_of(&own, &other, mates, enemies)
            }
            (
                ObservationSpace::Squall {
                    mates,
                    enemies,
                    frames,
                },
                _,
            ) => {
                let newest = names_of(
                    &squall::OWN_NAMES,
                    &squall::OTHER_NAMES,
                    mates.into(),
                    enemies.into(),
                );
                let older = (1..frames)
                    .flat_map(|ago| newest.iter().map(move |name| format!("t-{ago}.{name}")));
                newest.iter().cloned().chain(older).collect()
            }
            _ => vec![],
        }
    }
}

/// The names of the boat's own values, then those of each other boat: `mate_1_speed`,
/// `enemy_2_speed`.
fn names_of(own: &[&str], other: &[&str], mates: usize, enemies: usize) -> Vec<String> {
    let mates = (1..=mates).map(|i| format!("mate_{i}"));
    let others = mates.chain((1..=enemies).map(|i| format!("enemy_{i}")));
    let of_others = others.flat_map(|boat| other.iter().map(move |name| format!("{boat}_{name}")));
    let own = own.iter().map(|name| (*name).to_owned());
    own.chain(of_others).collect()
}

#[cfg(test)]
mod tests {
    use super::ObservationSpace;
    use std::collections::BTreeSet;

    #[test]
    fn every_number_has_a_name_of_its_own() {
        let squall = |frames| ObservationSpace::Squall {
            mates: 2,
            enemies: 3,
            frames,
        };
        for (space, mates, enemies) in [
            (ObservationSpace::Pyquaticus, 1, 2),
            (ObservationSpace::Pyquaticus, 0, 1),
            (ObservationSpace::Pyquaticus2023, 1, 2),
            (ObservationSpace::Pyquaticus2026, 2, 3),
            (squall(1), 1, 2),
            (squall(3), 1, 2),
        ] {
            let names = space.names(mates, enemies);
            assert_eq!(names.len(), space.size(mates, enemies), "{space:?}");
            assert_eq!(
                names.iter().collect::<BTreeSet<_>>().len(),
                names.len(),
                "{space:?}: {names:?}"
            );
        }
        let sizes = [
            ObservationSpace::Pyquaticus2023.size(1, 2),
            ObservationSpace::Pyquaticus.size(2, 3),
            ObservationSpace::Pyquaticus2026.size(2, 3),
        ];
        assert_eq!(sizes, [43, 61, 67]);
        assert_eq!(squall(2).names(2, 3)[0], "position_ahead");
        assert_eq!(
            ObservationSpace::Pyquaticus.names(1, 2)[21],
            "mate_1_bearing"
        );
    }
}
