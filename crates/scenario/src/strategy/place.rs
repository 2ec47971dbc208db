//! Places and boats with names in strategies: fixed ones, and those that move with the game.

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
    /// A named point of the own team, such as `CFX`.
    Point(String),
    /// Something that follows the game.
    Mark(Mark),
    /// The position of a boat.
    Boat(Boat),
}

/// A place that follows the game, but is no boat.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
pub enum Mark {
    /// The home of the own team's flag; of several the nearest.
    OwnFlag,
    /// The home of the enemy's flag; of several the nearest that is there.
    EnemyFlag,
    /// Where the rules want a flag brought; of several the nearest.
    CapturePlace,
    /// Where a tagged boat must come to play again, of several the nearest; while it must leave that place first, the enemy's flag.
    UntagPlace,
}

/// A boat, by what it is just now.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, VariantArray, IntoStaticStr, EnumMessage)]
#[strum(serialize_all = "snake_case")]
pub enum Boat {
    /// The nearest enemy that is not tagged.
    NearestEnemy,
    /// Of the enemies on the own side that are not tagged, the nearest to the own boat.
    NearestIntruder,
    /// Of the enemies that are not tagged, wherever they are, the nearest to an own flag.
    NearestAttacker,
    /// Of the enemies, tagged ones too, the nearest to the enemy's flag.
    NearestDefender,
    /// Of the enemies on the own side that are not tagged, the one that this boat is to meet: each is assigned to the boat of the
    /// own team that meets it soonest, one boat to one enemy, those nearest to an own flag first.
    AssignedIntruder,
    /// The enemy that carries a flag of the own team; of several the nearest.
    FlagCarrier,
    /// The enemy assigned to this boat: the one of the same rank, counted round where there are fewer enemies.
    Opponent,
    /// The nearest other boat of the own team.
    NearestMate,
    /// The other boat of the own team that carries a flag; of several the nearest.
    MateCarrier,
}

impl Place {
    /// The mark, boat or named point with this name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Place> {
        let point = || Field::point_names().into_iter().find(|point| point == name).map(Place::Point);
        Mark::by_name(name).map(Place::Mark).or_else(|| Boat::by_name(name).map(Place::Boat)).or_else(point)
    }

    /// All names of places.
    #[must_use]
    pub fn names() -> Vec<String> {
        let fixed = [Mark::names(), Boat::names()].concat().into_iter().map(str::to_owned);
        fixed.chain(Field::point_names()).collect()
    }

    /// The same as text, abbreviated.
    #[must_use]
    pub fn names_in_short() -> String {
        let (marks, boats) = (Mark::names().join(", "), Boat::names().join(", "));
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
        // Bound on the distance from the datum, m; no boat goes that far.
        let number = json!({ "type": "number", "minimum": -1e6, "maximum": 1e6 });
        let position = json!({
            "description": "[x east, y north] in metres from the datum.",
            "type": "array", "items": number, "minItems": 2, "maxItems": 2
        });
        let named = json!({
            "description": "A mark, a boat, or a named point of the own team.",
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
