//! A game file as typed.

use super::{At, Pair, RawLink};
use schemars::JsonSchema;
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::fmt;

/// A game: where, by which rules, on what water, and who plays. Paths are relative to the file they stand in.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall game")]
pub(in crate::scenario) struct RawGame {
    /// Another game file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// The field file. Required.
    pub(in crate::scenario) field: Option<At<String>>,
    /// The rules file. Required.
    pub(in crate::scenario) rules: Option<At<String>>,
    /// The sea file. Default fresh water at rest.
    pub(in crate::scenario) sea: Option<At<String>>,
    /// The boat file of all vehicles that name none.
    pub(in crate::scenario) boat: Option<At<String>>,
    /// Over which radio links minds and boats talk. Default at once and without loss.
    pub(in crate::scenario) link: Option<At<RawLink>>,
    /// Chooses the game: 0 to 9223372036854775807. Default 1.
    pub(in crate::scenario) seed: Option<At<i64>>,
    /// The game ends at this time, s: 1 to 86400. Default what the rules say.
    pub(in crate::scenario) duration_s: Option<At<f64>>,
    /// Physics tick, s: 0.001 to 0.5. Default 0.05.
    pub(in crate::scenario) tick_s: Option<At<f64>>,
    /// Time between two decisions of a mind, s: 0.001 to 10, a multiple of the physics tick. Default 0.1.
    pub(in crate::scenario) decision_s: Option<At<f64>>,
    /// In lockstep, how long (wall clock) the sim waits for a mind before it is lost, s: 0.001 to 3600.
    /// Default 5.
    pub(in crate::scenario) patience_s: Option<At<f64>>,
    /// In real time, how old (simulated time) an order may grow before the boat holds, s: 0.01 to 3600.
    /// Default 1.
    pub(in crate::scenario) order_ttl_s: Option<At<f64>>,
    /// The two teams; the first has the end at the field's corner.
    pub(in crate::scenario) team: Option<Vec<At<RawTeam>>>,
    /// Boats one by one. They come before the fleets in the order of play.
    pub(in crate::scenario) vehicle: Option<Vec<At<RawVehicle>>>,
    /// Many boats at once.
    pub(in crate::scenario) fleet: Option<Vec<At<RawFleet>>>,
}

/// A team.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Team")]
pub(in crate::scenario) struct RawTeam {
    /// Its name: a-z, 0-9 and _. Required.
    pub(in crate::scenario) name: Option<At<String>>,
    /// The strategy of its boats that name none: the path of a file, or the name of one in the folder of strategies.
    pub(in crate::scenario) strategy: Option<At<String>>,
}

/// A boat that plays.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Vehicle")]
pub(in crate::scenario) struct RawVehicle {
    /// Its name, unique in the game: a-z, 0-9 and _. Required.
    pub(in crate::scenario) name: Option<At<String>>,
    /// Its team's name. Required.
    pub(in crate::scenario) team: Option<At<String>>,
    /// Its boat file. Default the game's.
    pub(in crate::scenario) boat: Option<At<String>>,
    /// Its strategy, by path or name. Default its team's.
    pub(in crate::scenario) strategy: Option<At<String>>,
    /// Where it starts: [x, y] in m from the datum, or a named point of its own team such as "PH".
    /// Default, without `spawn`: on the team's line midway between own flag and scrimmage line.
    pub(in crate::scenario) at: Option<At<Whereabouts>>,
    /// The compass heading it starts with, degrees: -360 to 360. Default facing the opponent's end.
    pub(in crate::scenario) heading_deg: Option<At<f64>>,
    /// Instead of `at`: somewhere in a rectangle, drawn anew for every seed.
    pub(in crate::scenario) spawn: Option<At<RawSpawn>>,
    /// Where its motion comes from. Default "simulated".
    pub(in crate::scenario) source: Option<RawSource>,
}

/// Where a vehicle's motion comes from.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Source")]
pub(in crate::scenario) enum RawSource {
    /// The program moves it through the scenario's sea.
    Simulated,
    /// It is a real boat: its gateway reports where it is. Such games are played in real time.
    External,
}

/// Many boats at once.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Fleet")]
pub(in crate::scenario) struct RawFleet {
    /// Its team's name. Required.
    pub(in crate::scenario) team: Option<At<String>>,
    /// How many boats: 1 to 10000. Required.
    pub(in crate::scenario) count: Option<At<i64>>,
    /// Their names; {} becomes the number, from 1. Default the team's name, _ and {}.
    pub(in crate::scenario) name: Option<At<String>>,
    /// Their boat file. Default the game's.
    pub(in crate::scenario) boat: Option<At<String>>,
    /// Their strategy, by path or name. Default their team's.
    pub(in crate::scenario) strategy: Option<At<String>>,
    /// Somewhere in a rectangle, drawn anew for every seed. Default: on the team's line midway between
    /// own flag and scrimmage line.
    pub(in crate::scenario) spawn: Option<At<RawSpawn>>,
}

/// A rectangle of the field to start in, as the team sees it that looks from its own end at its opponent's.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Spawn")]
pub(in crate::scenario) struct RawSpawn {
    /// From and to, m from the own end. Default the own half but for 2 m at either side.
    pub(in crate::scenario) along_m: Option<At<Pair>>,
    /// From and to, m from the edge to port. Default the whole depth but for 2 m at either side.
    pub(in crate::scenario) across_m: Option<At<Pair>>,
    /// Smallest distance to any other boat and to obstacles, m: 0 to 1000. Default 5.
    pub(in crate::scenario) gap_m: Option<At<f64>>,
}

/// A position, or the name of one.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged, inline)]
pub(in crate::scenario) enum Whereabouts {
    /// [x east, y north] in metres from the datum.
    Position([f64; 2]),
    /// A named point of the own team.
    Point(String),
}

impl<'de> Deserialize<'de> for Whereabouts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Whereabouts, D::Error> {
        deserializer.deserialize_any(WhereaboutsVisitor)
    }
}

struct WhereaboutsVisitor;

impl<'de> Visitor<'de> for WhereaboutsVisitor {
    type Value = Whereabouts;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[x, y] or the name of a point such as \"CH\"")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Whereabouts, E> {
        Ok(Whereabouts::Point(name.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Whereabouts, A::Error> {
        let mut numbers = [0.0; 2];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = seq.next_element()?.ok_or_else(|| serde::de::Error::invalid_length(i, &self))?;
        }
        match seq.next_element::<f64>()? {
            None => Ok(Whereabouts::Position(numbers)),
            Some(_) => Err(serde::de::Error::invalid_length(3, &self)),
        }
    }
}
