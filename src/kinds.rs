//! The kinds of scenario files that the program supports, in the order of the reference.

use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use scenario::{Kind, did_you_mean};

pub(crate) const KINDS: &[Kind] = &[
    Kind::GAME,
    Kind::FIELD,
    Kind::RULES,
    Kind::BOAT,
    Kind::SEA,
    Kind::STRATEGY,
    Kind::of::<Tournament>(),
    #[cfg(feature = "network")]
    Kind::of::<gateway::config::Gateway>(),
    Kind::of::<learn::rewards::Rewards>(),
    Kind::of::<learn::training::Training>(),
    Kind::of::<Sweep>(),
];

/// Parses the name of a kind, or of its folder.
pub(crate) fn parse(word: &str) -> Result<Kind, String> {
    let names: Vec<&str> = KINDS.iter().map(|kind| kind.name()).collect();
    let found = KINDS.iter().copied().find(|kind| [kind.name(), kind.folder()].contains(&word));
    found.ok_or_else(|| format!("expected one of {}{}", names.join(", "), did_you_mean(word, &names)))
}
