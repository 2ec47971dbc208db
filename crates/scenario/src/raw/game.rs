//! A game file as written.

use super::{FilePath, Name, Position};
use crate::Source;
use crate::fault::Fault;
use crate::link::Link;
use primitives::reseed::Reseed;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A game: field, rules, conditions and boats.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Game {
    /// Field file.
    pub(crate) field: FilePath,
    /// Rules file.
    pub(crate) rules: FilePath,
    /// Sea file. Default: fresh water at rest.
    pub(crate) sea: Option<FilePath>,
    /// Default boat file.
    pub(crate) boat: Option<FilePath>,
    /// Radio links between minds and boats. Default: no delay, no loss.
    #[schemars(extend("x-drawn" = true))]
    pub(crate) link: Option<Link>,
    /// Faults during the game, by name.
    #[schemars(extend("default" = {}))]
    pub(crate) fault: BTreeMap<String, Fault>,
    /// Random seed; each value gives a different game.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub(crate) seed: u64,
    /// Changes of the seed during the game, in chronological order.
    #[schemars(length(max = 1000), extend("default" = []))]
    pub(crate) reseed: Vec<Reseed>,
    /// Duration of the game, s. Default: `time_limit_s` of the rules.
    #[schemars(range(min = 1, max = 86400))]
    pub(crate) duration_s: Option<f64>,
    /// Physics tick, s.
    #[schemars(range(min = 0.001, max = 0.5), extend("default" = 0.05))]
    pub(crate) tick_s: f64,
    /// Time between decisions of a mind, s; a multiple of `tick_s`.
    #[schemars(range(min = 0.001, max = 10), extend("default" = 0.1))]
    pub(crate) decision_s: f64,
    /// Lockstep: wall-clock time after which a silent mind counts as lost, s.
    #[schemars(range(min = 0.001, max = 3600), extend("default" = 5))]
    pub(crate) patience_s: f64,
    /// Real time: maximum age of an order before the boat holds, s.
    #[schemars(range(min = 0.01, max = 3600), extend("default" = 1))]
    pub(crate) order_ttl_s: f64,
    /// The two teams; the first has the end at the field's `corner`.
    #[schemars(length(equal = 2), extend("x-expected" = "exactly two [[team]] tables"))]
    pub(crate) team: Vec<Team>,
    /// Individual boats, processed before all fleets.
    pub(crate) vehicle: Vec<Vehicle>,
    /// Groups of boats.
    pub(crate) fleet: Vec<Fleet>,
}

#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Team {
    /// Name.
    pub(crate) name: Name,
    /// Default strategy of the team's boats: a path, or a name in `strategies/`.
    pub(crate) strategy: Option<FilePath>,
}

#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Vehicle {
    /// Name, unique in the game.
    pub(crate) name: Name,
    /// Name of its team.
    #[schemars(length(min = 1), extend("x-expected" = "the name of a team"))]
    pub(crate) team: String,
    /// Boat file. Default: the game's.
    pub(crate) boat: Option<FilePath>,
    /// Strategy, by path or name. Default: its team's.
    pub(crate) strategy: Option<FilePath>,
    /// Start: [x, y] in m from the datum, or a named point of its team such as "PH".
    /// Default: on a line midway between its flag and the scrimmage line.
    pub(crate) at: Option<Position>,
    /// Initial compass heading, degrees. Default: towards the opponent's end.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) heading_deg: Option<f64>,
    /// Instead of `at`: a random position in a rectangle.
    pub(crate) spawn: Option<Spawn>,
    /// Joining time, s; until then it holds, out of action.
    #[schemars(range(min = 0, max = 86400), extend("default" = 0))]
    pub(crate) joins_s: f64,
    /// Source of the boat's motion.
    #[schemars(extend("default" = "simulated"))]
    pub(crate) source: Source,
}

/// A group of boats.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Fleet {
    /// Name of their team.
    #[schemars(length(min = 1), extend("x-expected" = "the name of a team"))]
    pub(crate) team: String,
    /// Number of boats; `{ uniform = [1, 6] }` draws it for every game.
    #[schemars(range(min = 1, max = 10000), extend("x-drawn" = true))]
    pub(crate) count: usize,
    /// Name pattern; {} becomes the number, from 1. Default: team name, _ and {}.
    pub(crate) name: Option<String>,
    /// Boat file. Default: the game's.
    pub(crate) boat: Option<FilePath>,
    /// Strategy, by path or name. Default: their team's.
    pub(crate) strategy: Option<FilePath>,
    /// Random positions in a rectangle. Default: midway between their flag and the scrimmage line.
    pub(crate) spawn: Option<Spawn>,
    /// Joining time, s; until then they hold, out of action.
    #[schemars(range(min = 0, max = 86400), extend("default" = 0))]
    pub(crate) joins_s: f64,
}

/// A rectangle for random start positions, as seen from the team's own end.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Spawn {
    /// Minimum and maximum distance from the team's own end, m. Default: its own half, minus 2 m at
    /// each end.
    #[schemars(inner(range(min = 0, max = 20000)))]
    pub(crate) along_m: Option<[f64; 2]>,
    /// Minimum and maximum distance from the port edge, m. Default: the whole depth, minus 2 m at
    /// each edge.
    #[schemars(inner(range(min = 0, max = 20000)))]
    pub(crate) across_m: Option<[f64; 2]>,
    /// Minimum distance to other boats and obstacles, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 5))]
    pub(crate) gap_m: f64,
}
