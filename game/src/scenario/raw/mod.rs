//! Scenario files as people type them: degrees and relative paths. Every key is declared here, and only here; how, is
//! told in `schema`.
//!
//! The doc comments are the descriptions in the JSON Schemas and the reference, so they are written for people who
//! write files. Where units do not differ, a type of the checked scenario stands for itself. `check` turns these types
//! into those the program believes.

mod boat;
mod field;
mod game;
mod gateway;
mod kinematic;
mod link;
mod rules;
mod sea;
mod sensor;
mod strategy;
mod tournament;

pub(super) use boat::{Boat, SettingAndThrust, Thruster};
pub(super) use field::{Circle, Field, Flag, Obstacle, Side};
pub(super) use game::{Fleet, Game, Spawn, Team, Vehicle};
pub(super) use gateway::Gateway;
pub(super) use kinematic::{Kinematic, ThrustAndSpeed};
pub(super) use link::{Link, Sharing};
pub(super) use rules::Rules;
pub(super) use sea::{Current, Eddy, Gusts, Sea, Spectrum, Spreading, Waves, Wind};
pub(super) use sensor::{Compass, Fault, Gps, Imu};
pub(super) use strategy::{Common, Rule, Strategy, Value, Values, Variable, VariableTable};
pub(super) use tournament::{Entry, Tournament};

use super::Kind;
use super::diagnostics::NAME_PATTERN;
use super::read::Declared;
use schemars::JsonSchema;
use serde::Deserialize;

/// The path of another file, relative to the one it stands in. Empty where it was wrong or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("minLength" = 1, "x-expected" = "the path of a file"))]
pub(super) struct FilePath(pub(super) String);

/// A name. Empty where it was wrong or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("pattern" = NAME_PATTERN))]
pub(super) struct Name(pub(super) String);

/// A position, or the name of one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "[x, y] or the name of a point such as \"CH\""))]
pub(super) enum Position {
    /// [x east, y north] in metres from the datum.
    At(#[schemars(inner(range(min = -1000000, max = 1000000)))] [f64; 2]),
    /// A named point of the own team.
    Point(String),
}

impl Declared for Game {
    const KIND: Kind = Kind::Game;
}

impl Declared for Field {
    const KIND: Kind = Kind::Field;
}

impl Declared for Rules {
    const KIND: Kind = Kind::Rules;
}

impl Declared for Boat {
    const KIND: Kind = Kind::Boat;
}

impl Declared for Sea {
    const KIND: Kind = Kind::Sea;
}

impl Declared for Tournament {
    const KIND: Kind = Kind::Tournament;
}

impl Declared for Gateway {
    const KIND: Kind = Kind::Gateway;
}
