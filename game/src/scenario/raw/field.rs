//! A field file as typed.

use super::{At, Pair};
use schemars::JsonSchema;
use serde::Deserialize;

/// A rectangle on the water. The first team has the end at `corner`; the flags, the scrimmage line and the
/// named points follow from it. Positions are [x east, y north] in metres from the datum.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Squall field")]
pub(in crate::scenario) struct RawField {
    /// Another field file that this one is laid over, relative to this file.
    #[expect(dead_code, reason = "followed before the files are merged; named here for the schema")]
    pub(in crate::scenario) base: Option<At<String>>,
    /// Geographic position of the local origin. Required: a boat that goes out on the water steers by it.
    pub(in crate::scenario) datum: Option<At<RawDatum>>,
    /// The corner of the first team's end that is to starboard as it looks at its opponent, [x, y] in m:
    /// -1000000 to 1000000. Default [0, 0].
    pub(in crate::scenario) corner: Option<At<Pair>>,
    /// Compass bearing from the first team's end to the second's, degrees: -360 to 360. Default 90.
    pub(in crate::scenario) along_deg: Option<At<f64>>,
    /// Extent from end to end, m: 10 to 20000. Required.
    pub(in crate::scenario) width_m: Option<At<f64>>,
    /// Extent across, m: 10 to 20000. Required.
    pub(in crate::scenario) depth_m: Option<At<f64>>,
    /// Distance of the flags from the ends, m: more than 0 and less than half the width. Default width / 8.
    pub(in crate::scenario) flag_inset_m: Option<At<f64>>,
    /// Whether the edges are walls. Default "none".
    pub(in crate::scenario) walls: Option<RawWalls>,
    /// What stands in the water.
    pub(in crate::scenario) obstacle: Option<Vec<At<RawObstacle>>>,
    /// Flags beyond the one that each team has anyway, at most 100.
    pub(in crate::scenario) flag: Option<Vec<At<RawFlag>>>,
}

/// A geographic position, WGS 84.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Datum")]
pub(in crate::scenario) struct RawDatum {
    /// Latitude, degrees north: -90 to 90. Required.
    pub(in crate::scenario) lat_deg: Option<At<f64>>,
    /// Longitude, degrees east: -180 to 180. Required.
    pub(in crate::scenario) lon_deg: Option<At<f64>>,
}

/// Whether the edges of the field are walls.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Walls")]
pub(in crate::scenario) enum RawWalls {
    /// Open water all round.
    None,
    /// A wall on every edge, which boats bump into.
    AllRound,
}

/// Something solid in the water: either `circle` or `polygon`.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Obstacle")]
pub(in crate::scenario) struct RawObstacle {
    /// A round one.
    pub(in crate::scenario) circle: Option<At<RawCircle>>,
    /// Corners [x, y] in order, either way round, three at least, with no two sides crossing.
    pub(in crate::scenario) polygon: Option<At<Vec<At<Pair>>>>,
}

/// A round obstacle.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Circle")]
pub(in crate::scenario) struct RawCircle {
    /// Its centre, [x, y] in m, on the field or at most 50 m outside. Required.
    pub(in crate::scenario) centre: Option<At<Pair>>,
    /// Its radius, m: 0.01 to 10000. Required.
    pub(in crate::scenario) radius_m: Option<At<f64>>,
}

/// An extra flag.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Flag")]
pub(in crate::scenario) struct RawFlag {
    /// The team that defends it. Required.
    pub(in crate::scenario) team: Option<RawSide>,
    /// Where it stands, [x, y] in m, inside the field. Required.
    pub(in crate::scenario) at: Option<At<Pair>>,
}

/// A field does not know the teams' names, only their order in the game file.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Side")]
pub(in crate::scenario) enum RawSide {
    /// The team listed first, with the end at `corner`.
    First,
    /// The team listed second.
    Second,
}
