//! A game file as typed.

use super::{FilePath, Name, Position};
use crate::Source;
use crate::fault::Fault;
use crate::link::Link;
use primitives::reseed::Reseed;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A game: where, by which rules, on what water, and who plays. Paths are relative to the file they stand in.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Game {
    /// The field file.
    pub(crate) field: FilePath,
    /// The rules file.
    pub(crate) rules: FilePath,
    /// The sea file. Default fresh water at rest.
    pub(crate) sea: Option<FilePath>,
    /// The boat file of all vehicles that name none.
    pub(crate) boat: Option<FilePath>,
    /// Over which radio links minds and boats talk. Default at once and without loss.
    #[schemars(extend("x-drawn" = true))]
    pub(crate) link: Option<Link>,
    /// What fails in the midst of the game, under names that single values and sweeps know it by.
    #[schemars(extend("default" = {}))]
    pub(crate) fault: BTreeMap<String, Fault>,
    /// Chooses the game.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub(crate) seed: u64,
    /// Other seeds that take its place in the midst of the game, by rising times: what is drawn after each is drawn anew, all before stays.
    #[schemars(length(max = 1000), extend("default" = []))]
    pub(crate) reseed: Vec<Reseed>,
    /// The game ends at this time, s. Default what the rules say.
    #[schemars(range(min = 1, max = 86400))]
    pub(crate) duration_s: Option<f64>,
    /// Physics tick, s.
    #[schemars(range(min = 0.001, max = 0.5), extend("default" = 0.05))]
    pub(crate) tick_s: f64,
    /// Time between two decisions of a mind, s, a multiple of the physics tick.
    #[schemars(range(min = 0.001, max = 10), extend("default" = 0.1))]
    pub(crate) decision_s: f64,
    /// In lockstep, how long (wall clock) the sim waits for a mind before it is lost, s.
    #[schemars(range(min = 0.001, max = 3600), extend("default" = 5))]
    pub(crate) patience_s: f64,
    /// In real time, how old (simulated time) an order may grow before the boat holds, s.
    #[schemars(range(min = 0.01, max = 3600), extend("default" = 1))]
    pub(crate) order_ttl_s: f64,
    /// The two teams; the first has the end at the field's corner.
    #[schemars(length(equal = 2), extend("x-expected" = "exactly two [[team]] for now"))]
    pub(crate) team: Vec<Team>,
    /// Boats one by one. They come before the fleets in the order of play.
    pub(crate) vehicle: Vec<Vehicle>,
    /// Many boats at once.
    pub(crate) fleet: Vec<Fleet>,
}

/// A team.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Team {
    /// Its name.
    pub(crate) name: Name,
    /// The strategy of its boats that name none: the path of a file, or the name of one in the folder of strategies.
    pub(crate) strategy: Option<FilePath>,
}

/// A boat that plays.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Vehicle {
    /// Its name, unique in the game.
    pub(crate) name: Name,
    /// Its team's name.
    #[schemars(length(min = 1), extend("x-expected" = "the name of a team"))]
    pub(crate) team: String,
    /// Its boat file. Default the game's.
    pub(crate) boat: Option<FilePath>,
    /// Its strategy, by path or name. Default its team's.
    pub(crate) strategy: Option<FilePath>,
    /// Where it starts: [x, y] in m from the datum, or a named point of its own team such as "PH". Default, without
    /// `spawn`: on the team's line midway between own flag and scrimmage line.
    pub(crate) at: Option<Position>,
    /// The compass heading it starts with, degrees. Default facing the opponent's end.
    #[schemars(range(min = -360, max = 360))]
    pub(crate) heading_deg: Option<f64>,
    /// Instead of `at`: somewhere in a rectangle, drawn anew for every seed.
    pub(crate) spawn: Option<Spawn>,
    /// Where its motion comes from.
    #[schemars(extend("default" = "simulated"))]
    pub(crate) source: Source,
}

/// Many boats at once.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Fleet {
    /// Its team's name.
    #[schemars(length(min = 1), extend("x-expected" = "the name of a team"))]
    pub(crate) team: String,
    /// How many boats.
    #[schemars(range(min = 1, max = 10000))]
    pub(crate) count: usize,
    /// Their names; {} becomes the number, from 1. Default the team's name, _ and {}.
    pub(crate) name: Option<String>,
    /// Their boat file. Default the game's.
    pub(crate) boat: Option<FilePath>,
    /// Their strategy, by path or name. Default their team's.
    pub(crate) strategy: Option<FilePath>,
    /// Somewhere in a rectangle, drawn anew for every seed. Default: on the team's line midway between own flag and
    /// scrimmage line.
    pub(crate) spawn: Option<Spawn>,
}

/// A rectangle of the field to start in, as the team sees it that looks from its own end at its opponent's.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Spawn {
    /// From and to, m from the own end. Default the own half but for 2 m at either side.
    #[schemars(inner(range(min = 0, max = 20000)))]
    pub(crate) along_m: Option<[f64; 2]>,
    /// From and to, m from the edge to port. Default the whole depth but for 2 m at either side.
    #[schemars(inner(range(min = 0, max = 20000)))]
    pub(crate) across_m: Option<[f64; 2]>,
    /// Smallest distance to any other boat and to obstacles, m.
    #[schemars(range(min = 0, max = 1000), extend("default" = 5))]
    pub(crate) gap_m: f64,
}
