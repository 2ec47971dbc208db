//! The kinds of scenario files: their names, and which kind a file is.

use super::schema::declared;
use std::collections::BTreeSet;
use std::path::Path;
use strum::{Display, IntoStaticStr};

/// A kind of scenario file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Display, IntoStaticStr)]
#[strum(serialize_all = "snake_case")]
pub enum Kind {
    /// A game.
    Game,
    /// A field.
    Field,
    /// Rules.
    Rules,
    /// A kind of boat.
    Boat,
    /// A sea.
    Sea,
    /// A strategy.
    Strategy,
    /// A tournament.
    Tournament,
    /// The way to a real boat.
    Gateway,
    /// Rewards for learning.
    Rewards,
    /// How a policy is trained.
    Training,
    /// How strategies do at many points of a space of scenarios.
    Sweep,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Kind; 11] = [
        Kind::Game,
        Kind::Field,
        Kind::Rules,
        Kind::Boat,
        Kind::Sea,
        Kind::Strategy,
        Kind::Tournament,
        Kind::Gateway,
        Kind::Rewards,
        Kind::Training,
        Kind::Sweep,
    ];

    /// Its name, which is also that of its schema file.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The folder its files lie in.
    #[must_use]
    pub fn folder(self) -> &'static str {
        [
            "games",
            "fields",
            "rules",
            "boats",
            "seas",
            "strategies",
            "tournaments",
            "gateways",
            "rewards",
            "training",
            "sweeps",
        ][self as usize]
    }

    /// The kind that the folder of `path` says, if it says one.
    #[must_use]
    pub fn by_folder(path: &Path) -> Option<Kind> {
        let folder = path.parent()?.file_name()?;
        Kind::ALL.into_iter().find(|kind| folder == kind.folder())
    }

    /// The kind that knows most of these top-level keys; the first of [`Kind::ALL`] where several do.
    pub(super) fn by_keys(keys: &BTreeSet<String>) -> Kind {
        // Of equals `max_by_key` takes the last.
        Kind::ALL.into_iter().rev().max_by_key(|kind| kind.known(keys)).unwrap_or(Kind::Game)
    }

    /// The kind of a file with these top-level keys, if it is clearly another than this: it knows two more of them at least.
    pub(super) fn other_by_keys(self, keys: &BTreeSet<String>) -> Option<Kind> {
        Some(Kind::by_keys(keys)).filter(|other| other.known(keys) >= self.known(keys) + 2)
    }

    /// How many of these top-level keys it knows.
    fn known(self, keys: &BTreeSet<String>) -> usize {
        let known = &declared(self)["properties"];
        keys.iter().filter(|key| known.get(key.as_str()).is_some()).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_outside_of_the_folders_is_told_by_its_keys() {
        for (keys, want) in [
            (vec!["field", "team"], Kind::Game),
            (vec!["width_m", "depth_m"], Kind::Field),
            (vec!["points"], Kind::Rules),
            (vec!["hull", "typo"], Kind::Boat),
            (vec!["current"], Kind::Sea),
            (vec!["roles", "base"], Kind::Strategy),
            (vec!["game", "entry", "sea", "seed"], Kind::Tournament),
            (vec!["order_ttl_s", "fence", "limits"], Kind::Gateway),
            (vec!["boat", "enemy", "potential"], Kind::Rewards),
            (vec!["stage", "observation", "seed"], Kind::Training),
            (vec!["game", "opponent", "axis"], Kind::Sweep),
            (vec!["base"], Kind::Game),
            (vec![], Kind::Game),
        ] {
            let keys = keys.into_iter().map(str::to_owned).collect();
            assert_eq!(Kind::by_keys(&keys), want, "{keys:?}");
        }
        let keys = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect::<BTreeSet<String>>();
        assert_eq!(Kind::Game.other_by_keys(&keys(&["about", "game", "opponent", "axis"])), Some(Kind::Sweep));
        assert_eq!(Kind::Game.other_by_keys(&keys(&["field", "team", "typo"])), None);
        assert_eq!(Kind::Sea.other_by_keys(&keys(&["typo", "other"])), None);
        assert_eq!(Kind::by_folder(Path::new("x/seas/calm.toml")), Some(Kind::Sea));
        assert_eq!(Kind::by_folder(Path::new("calm.toml")), None);
    }
}
