//! A field file as typed.

use rules::field::Plan;
use schemars::JsonSchema;
use serde::Deserialize;

/// A rectangle on the water. The first team has the end at `corner`; the flags, the scrimmage line and the
/// named points follow from it. Positions are [x east, y north] in metres from the datum.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Field {
    #[serde(flatten)]
    pub(crate) plan: Plan,
    /// What stands in the water.
    pub(crate) obstacle: Vec<Obstacle>,
    /// Flags beyond the one that each team has anyway.
    #[schemars(length(max = 100))]
    pub(crate) flag: Vec<Flag>,
}

/// Something solid in the water: either `circle` or `polygon`.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Obstacle {
    /// A round one.
    pub(crate) circle: Option<Circle>,
    /// Corners [x, y] in order, either way round, with no two sides crossing.
    #[schemars(length(min = 3, max = 1000), inner(inner(range(min = -1000000, max = 1000000))))]
    pub(crate) polygon: Option<Vec<[f64; 2]>>,
}

/// A round obstacle.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Circle {
    /// Its centre, [x, y] in m, on the field or at most 50 m outside.
    #[schemars(inner(range(min = -1000000, max = 1000000)))]
    pub(crate) centre: [f64; 2],
    /// Its radius, m.
    #[schemars(range(min = 0.01, max = 10000))]
    pub(crate) radius_m: f64,
}

/// An extra flag.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Flag {
    /// The team that defends it.
    pub(crate) team: Side,
    /// Where it stands, [x, y] in m, inside the field.
    #[schemars(inner(range(min = -1000000, max = 1000000)))]
    pub(crate) at: [f64; 2],
}

/// A field does not know the teams' names, only their order in the game file.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Side {
    /// The team listed first, with the end at `corner`.
    First,
    /// The team listed second.
    Second,
}
