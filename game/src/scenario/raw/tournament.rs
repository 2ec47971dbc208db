//! A tournament file as typed.

use super::At;
use schemars::JsonSchema;
use serde::Deserialize;

/// A tournament: every entry against every other, in one game, over many seeds and from both sides.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall tournament")]
pub(in crate::scenario) struct RawTournament {
    /// Another tournament file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// The game file; the strategies of its teams are replaced by those of the entries. Required.
    pub(in crate::scenario) game: Option<At<String>>,
    /// The sea file. Default the game's.
    pub(in crate::scenario) sea: Option<At<String>>,
    /// Games of each pairing, half of them on each side; an odd number is rounded up: 2 to 1000000. Default 200.
    pub(in crate::scenario) games: Option<At<i64>>,
    /// The first seed; one more for every two games of a pairing: 0 to 9223372036854775807. Default 1.
    pub(in crate::scenario) seed: Option<At<i64>>,
    /// Whether entries also play against themselves. Default false.
    pub(in crate::scenario) self_play: Option<bool>,
    /// Who enters. Required: 2 to 100 of them.
    pub(in crate::scenario) entry: Option<Vec<At<RawEntry>>>,
}

/// Who enters.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Entry")]
pub(in crate::scenario) struct RawEntry {
    /// Its name in the tables: a-z, 0-9 and _. Required.
    pub(in crate::scenario) name: Option<At<String>>,
    /// The strategy file that all its boats follow. Required.
    pub(in crate::scenario) strategy: Option<At<String>>,
}
