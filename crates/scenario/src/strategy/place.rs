//! Named places and boats in strategies: fixed ones, and those that depend on the game.

use super::Named;
use primitives::frame::Ned;
use rules::field::Field;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::borrow::Cow;
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// A place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Place {
    /// A fixed position.
    At(Ned),
    /// A named point of the team, such as `CFX`.
    Point(String),
    /// A place that depends on the game.
    Mark(Mark),
    /// The position of a boat.
    Boat(Boat),
}

/// A place that depends on the game, other than a boat.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mark {
    /// Home of the team's own flag.
    OwnFlag,
    /// Home of the enemy's flag, if the flag is there.
    EnemyFlag,
    /// Place to which a flag must be brought.
    CapturePlace,
    /// Place where a tagged boat is untagged; the enemy's flag while the boat must first leave that
    /// place.
    UntagPlace,
}

/// A boat by its current role.
#[derive(VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Boat {
    /// Nearest untagged enemy.
    NearestEnemy,
    /// Nearest untagged enemy on the team's side.
    NearestIntruder,
    /// Untagged enemy nearest to one of the team's flags.
    NearestAttacker,
    /// Enemy, tagged or not, nearest to the enemy's flag.
    NearestDefender,
    /// Untagged enemy on the team's side assigned to this boat. Starting with the enemy nearest to
    /// one of the team's flags, each is assigned to the boat that meets it soonest, one boat per
    /// enemy.
    AssignedIntruder,
    /// Enemy that carries one of the team's flags.
    FlagCarrier,
    /// Enemy with the same rank; ranks repeat if there are fewer enemies.
    Opponent,
    /// Nearest teammate.
    NearestMate,
    /// Teammate that carries a flag.
    MateCarrier,
}

impl Place {
    /// The mark, boat or named point with this name.
    pub fn by_name(name: &str) -> Option<Place> {
        let mark = Mark::by_name(name).map(Place::Mark);
        let boat = || Boat::by_name(name).map(Place::Boat);
        let is_point = || Field::point_names().iter().any(|point| point == name);
        let point = || is_point().then(|| Place::Point(name.to_owned()));
        mark.or_else(boat).or_else(point)
    }

    /// All names of places.
    pub fn names() -> Vec<String> {
        let fixed = [Mark::names(), Boat::names()].concat();
        let fixed = fixed.into_iter().map(str::to_owned);
        fixed.chain(Field::point_names()).collect()
    }

    /// The names for messages, with an example in place of the list of named points.
    pub fn names_in_short() -> String {
        let marks = Mark::names().join(", ");
        let boats = Boat::names().join(", ");
        format!("{marks}, a boat ({boats}) or a named point such as CH")
    }
}

impl JsonSchema for Place {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "place".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        // Bound on the distance from the datum, m, beyond the reach of any boat.
        let number = json!({ "type": "number", "minimum": -1e6, "maximum": 1e6 });
        let position = json!({
            "description": "[x east, y north] in metres from the datum.",
            "type": "array", "items": number, "minItems": 2, "maxItems": 2
        });
        let named = json!({
            "description": "A mark, a boat, or a named point of the team.",
            "type": "string", "enum": Place::names(), "x-expected": format!("[x, y], {}", Place::names_in_short())
        });
        json_schema!({
            "title": "place",
            "anyOf": [position, named],
            "x-expected": "[x, y], or the name of a place or a boat"
        })
    }
}

impl JsonSchema for Boat {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "boat".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "title": "boat", "type": "string", "enum": Boat::names() })
    }
}
