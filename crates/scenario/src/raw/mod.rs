//! Scenario files as written, where they differ from the checked types; `check` converts them.
//!
//! All other types of a scenario are used in both forms. Every key is declared once, in one form or
//! the other; `schema` describes how. The doc comments are the descriptions in the JSON Schemas and
//! the reference, so they are written for authors of files.

mod boat;
mod field;
mod game;
mod sea;
mod strategy;

pub(crate) use boat::Boat;
pub(super) use boat::{SettingAndThrust, Thruster};
pub(crate) use field::Field;
pub(super) use field::{Circle, Flag, Obstacle, Side};
pub(crate) use game::Game;
pub(super) use game::{Fleet, Spawn, Team, Vehicle};
pub(crate) use sea::Sea;
pub(super) use sea::{Current, Gusts, Spectrum, Spreading, Waves, Wind};
pub(crate) use strategy::Strategy;
pub(super) use strategy::{Rule, Value, Values, Variable, VariableTable};

use super::diagnostics::NAME_PATTERN;
use schemars::JsonSchema;
use serde::Deserialize;

/// The path of another file, relative to the file that contains it. Empty if the value was invalid
/// or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("minLength" = 1, "x-expected" = "the path of a file"))]
pub struct FilePath(pub(crate) String);

/// A name. Empty if the value was invalid or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("pattern" = NAME_PATTERN))]
pub struct Name(pub(crate) String);

/// A position, or the name of one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "[x, y] or the name of a point such as \"CH\""))]
pub(super) enum Position {
    /// [x east, y north] in metres from the datum.
    At(#[schemars(inner(range(min = -1000000, max = 1000000)))] [f64; 2]),
    /// A named point of the team.
    Point(String),
}
