//! A field file as written.

use rules::field::{FlagRadii, Plan};
use schemars::JsonSchema;
use serde::Deserialize;

/// A rectangle on the water, which determines the default flags, the scrimmage line and the named
/// points. Positions are [x east, y north] in m from the datum.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Field {
    #[serde(flatten)]
    pub(crate) plan: Plan<Option<f64>>,
    /// Obstacles.
    pub(crate) obstacle: Vec<Obstacle>,
    /// Flags in addition to each team's default flag, and the settings of those.
    #[schemars(length(max = 100))]
    pub(crate) flag: Vec<Flag>,
}

/// A solid obstacle: either `circle` or `polygon`.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Obstacle {
    /// A circle.
    pub(crate) circle: Option<Circle>,
    /// Corners [x, y] in m, in order, in either direction; sides must not cross.
    #[schemars(length(min = 3, max = 1000), inner(inner(range(min = -1000000, max = 1000000))))]
    pub(crate) polygon: Option<Vec<[f64; 2]>>,
}

#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Circle {
    /// Centre, [x, y] in m, at most 50 m outside the field.
    #[schemars(inner(range(min = -1000000, max = 1000000)))]
    pub(crate) centre: [f64; 2],
    /// Radius, m.
    #[schemars(range(min = 0.01, max = 10000))]
    pub(crate) radius_m: f64,
}

#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Flag {
    /// The team that defends it.
    pub(crate) team: Side,
    /// Position, [x, y] in m, inside the field. Default: the entry describes the team's default
    /// flag instead of an additional one.
    #[schemars(inner(range(min = -1000000, max = 1000000)))]
    pub(crate) at: Option<[f64; 2]>,
    #[serde(flatten)]
    pub(crate) radii: FlagRadii,
    /// The closed path along which the flag's home moves from the start of the game. Default: it
    /// does not move.
    pub(crate) route: Option<Route>,
}

/// A closed path at constant speed.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Route {
    /// Corners after the flag's position, [x, y] in m, inside the field; the last leg leads back.
    #[schemars(length(min = 1, max = 100), inner(inner(range(min = -1000000, max = 1000000))))]
    pub(crate) points: Vec<[f64; 2]>,
    /// Speed, m/s.
    #[schemars(range(min = 0.001, max = 60))]
    pub(crate) speed_m_s: f64,
}

/// A team, by its order in the game file; a field does not know the teams' names.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Side {
    /// The team listed first, with the end at `corner`.
    First,
    /// The team listed second.
    Second,
}
