//! Behaviours that want to get somewhere, as typed.

use super::Amount;
use crate::field::Field;
use crate::scenario::raw::{At, Whereabouts};
use crate::strategy::{Boat, Mark, Turn};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::json;

/// The names of boats, for editors.
fn boat(_: &mut SchemaGenerator) -> Schema {
    let names: Vec<&str> = Boat::all().map(Boat::name).collect();
    json_schema!({ "type": "string", "enum": names })
}

/// A place, for editors.
fn place(_: &mut SchemaGenerator) -> Schema {
    let position = json!({
        "description": "[x east, y north] in metres from the datum.",
        "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2
    });
    let points = Field::point_names();
    let names: Vec<&str> = Mark::all().map(Mark::name).chain(Boat::all().map(Boat::name)).collect();
    let names: Vec<&str> = names.into_iter().chain(points.iter().map(String::as_str)).collect();
    json_schema!({ "anyOf": [position, { "description": "A mark, a boat, or a named point of the own team.", "enum": names }] })
}

/// A list of places, for editors.
fn places(generator: &mut SchemaGenerator) -> Schema {
    let place = place(generator);
    json_schema!({ "type": "array", "items": place })
}

/// Drives along a list of points, and is complete at the last.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawWaypoint {
    /// The points, in order, each a place: 1 to 1000 of them. Required.
    #[schemars(schema_with = "places")]
    pub(in crate::scenario) points: Option<At<Vec<At<Whereabouts>>>>,
    /// Drives the list backwards. Default false.
    pub(in crate::scenario) reverse: Option<At<bool>>,
    /// How often the list is driven again after the first time: 0 to 1000000. Default 0.
    pub(in crate::scenario) repeat: Option<At<Amount>>,
    /// Desired speed, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
    /// A point nearer than this is reached, m: 0.1 to 1000. Default 3.
    pub(in crate::scenario) capture_radius_m: Option<At<Amount>>,
    /// A point within this that draws away again is reached, m: 0 to 1000. Default 15.
    pub(in crate::scenario) slip_radius_m: Option<At<Amount>>,
    /// Steers for the point of the line between two points that lies this far ahead, m: 0 to 1000. Default 0, for the
    /// next point.
    pub(in crate::scenario) lead_m: Option<At<Amount>>,
    /// How much course counts against speed: 0 to 1. Default 0.5.
    pub(in crate::scenario) course_share: Option<At<Amount>>,
}

/// Drives round and round a convex polygon.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawLoiter {
    /// Its corners, in order, each a place: 3 to 1000 of them. Required, or ellipse.
    #[schemars(schema_with = "places")]
    pub(in crate::scenario) polygon: Option<At<Vec<At<Whereabouts>>>>,
    /// An ellipse instead. Required, or polygon.
    pub(in crate::scenario) ellipse: Option<At<RawEllipse>>,
    /// Which way round. Default "best".
    pub(in crate::scenario) turn: Option<At<Turn>>,
    /// Desired speed, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
    /// A corner nearer than this is passed, m: 0.1 to 1000. Default 3.
    pub(in crate::scenario) capture_radius_m: Option<At<Amount>>,
    /// A corner within this that draws away again is passed, m: 0 to 1000. Default 15.
    pub(in crate::scenario) slip_radius_m: Option<At<Amount>>,
    /// Farther than this from the polygon it goes there first, m: 0 to 10000. Default 10.
    pub(in crate::scenario) acquire_m: Option<At<Amount>>,
}

/// An ellipse with axes along and across the field.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Ellipse")]
pub(in crate::scenario) struct RawEllipse {
    /// Its centre, a place. Required.
    #[schemars(schema_with = "place")]
    pub(in crate::scenario) centre: Option<At<Whereabouts>>,
    /// Full extent along the field, m: 1 to 10000. Required.
    pub(in crate::scenario) along_m: Option<At<f64>>,
    /// Full extent across it, m: 1 to 10000. Required.
    pub(in crate::scenario) across_m: Option<At<f64>>,
    /// By how many corners: 3 to 1000. Default 24.
    pub(in crate::scenario) corners: Option<At<i64>>,
}

/// Holds a place.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawStationKeep {
    /// The place. Default where the boat is when it begins.
    #[schemars(schema_with = "place")]
    pub(in crate::scenario) at: Option<At<Whereabouts>>,
    /// Within this it does nothing, m: 0 to 1000. Default 4.
    pub(in crate::scenario) inner_radius_m: Option<At<Amount>>,
    /// From here outwards it goes at the transit speed, m: 0 to 1000. Default 15.
    pub(in crate::scenario) outer_radius_m: Option<At<Amount>>,
    /// The speed that it reaches at the outer radius, rising from 0 at the inner one, m/s: 0 to 60. Default 1.2.
    pub(in crate::scenario) outer_speed_m_s: Option<At<Amount>>,
    /// The speed outside of it, m/s: 0 to 60. Default 2.5.
    pub(in crate::scenario) transit_speed_m_s: Option<At<Amount>>,
}

/// Closes in on a boat: a blend of the rate of closure and the closest point of approach.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawCutRange {
    /// Which boat. Required.
    #[schemars(schema_with = "boat")]
    pub(in crate::scenario) contact: Option<At<String>>,
    /// From only the rate of closure to only the closest point of approach: 0 to 100. Default 50.
    pub(in crate::scenario) patience: Option<At<Amount>>,
    /// How long a course is thought to be held, s: 0.1 to 600. Default 15.
    pub(in crate::scenario) time_on_leg_s: Option<At<Amount>>,
    /// Farther than this it gives up, m: 0 to 100000. Default 0, never.
    pub(in crate::scenario) giveup_m: Option<At<Amount>>,
}

/// Keeps a place relative to a boat that moves.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawTrail {
    /// Which boat. Required.
    #[schemars(schema_with = "boat")]
    pub(in crate::scenario) contact: Option<At<String>>,
    /// How far from it, m: 0 to 10000. Default 50.
    pub(in crate::scenario) range_m: Option<At<Amount>>,
    /// In which direction from its bow, degrees clockwise: -360 to 360. Default 180, astern.
    pub(in crate::scenario) angle_deg: Option<At<Amount>>,
    /// Nearer than this to the place it takes the contact's own course and speed, m: 0 to 1000. Default 5.
    pub(in crate::scenario) radius_m: Option<At<Amount>>,
    /// The fastest it goes, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
}

/// Steers for the point where it can meet a boat soonest (lead pursuit).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawIntercept {
    /// Which boat. Required.
    #[schemars(schema_with = "boat")]
    pub(in crate::scenario) contact: Option<At<String>>,
    /// Speed, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
    /// Farther than this it gives up, m: 0 to 100000. Default 0, never.
    pub(in crate::scenario) giveup_m: Option<At<Amount>>,
}

/// Keeps between what it guards and an enemy.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawShield {
    /// What it guards, a place. Required.
    #[schemars(schema_with = "place")]
    pub(in crate::scenario) guarded: Option<At<Whereabouts>>,
    /// From whom. Default "nearest_attacker".
    #[schemars(schema_with = "boat")]
    pub(in crate::scenario) against: Option<At<String>>,
    /// How far from what it guards it keeps, towards the enemy, m: 0 to 10000. Default 10; never beyond the middle
    /// between the two.
    pub(in crate::scenario) distance_m: Option<At<Amount>>,
    /// Within this of its station it takes the speed of what it guards, m: 0 to 1000. Default 3.
    pub(in crate::scenario) radius_m: Option<At<Amount>>,
    /// The fastest it goes, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
}

/// Draws the boat to a place, the more the nearer it is, and not at all beyond a distance.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawAttractor {
    /// The place. Required.
    #[schemars(schema_with = "place")]
    pub(in crate::scenario) to: Option<At<Whereabouts>>,
    /// Nearer than this it has its full weight, m: 0 to 10000. Default 10.
    pub(in crate::scenario) inner_m: Option<At<Amount>>,
    /// Farther than this it has none, m: 0 to 10000. Default 50.
    pub(in crate::scenario) outer_m: Option<At<Amount>>,
    /// Speed, m/s: 0 to 60. Default 5; more than the boat can do is its top speed.
    pub(in crate::scenario) speed_m_s: Option<At<Amount>>,
}
