//! A tournament file as typed.

use super::{FilePath, Name};
use schemars::JsonSchema;
use serde::Deserialize;

/// A tournament: every entry against every other, in one game, over many seeds and from both sides.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Tournament {
    /// The game file; the strategies of its teams are replaced by those of the entries.
    pub(crate) game: FilePath,
    /// The sea file. Default the game's.
    pub(crate) sea: Option<FilePath>,
    /// Games of each pairing, half of them on each side; an odd number is rounded up.
    #[schemars(range(min = 2, max = 1000000), extend("default" = 200))]
    pub(crate) games: u32,
    /// The first seed; one more for every two games of a pairing.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub(crate) seed: u64,
    /// Whether entries also play against themselves.
    #[schemars(extend("default" = false))]
    pub(crate) self_play: bool,
    /// Who enters.
    #[schemars(length(min = 2, max = 100))]
    pub(crate) entry: Vec<Entry>,
}

/// Who enters.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Entry {
    /// Its name in the tables.
    pub(crate) name: Name,
    /// The strategy file that all its boats follow.
    pub(crate) strategy: FilePath,
}
