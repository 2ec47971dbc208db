//! The kinds of scenario files that the program supports, in the order of the reference.

use experiment::sweep::Sweep;
use experiment::tournament::Tournament;
use scenario::Kind;

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
