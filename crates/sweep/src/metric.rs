//! What is measured of a game, from the side of the entry that is looked at.

use serde::Serialize;

/// A number that every game gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Metric {
    /// Its name: a column of the tables.
    pub name: &'static str,
    /// Its unit; empty for counts and shares.
    pub unit: &'static str,
    /// What it is.
    pub about: &'static str,
}

const fn metric(name: &'static str, unit: &'static str, about: &'static str) -> Metric {
    Metric { name, unit, about }
}

/// All of them, in the order of the columns: of the entry's team, of its opponent's, and of the game. [`crate::play_one`] measures
/// them in this order.
pub const METRICS: [Metric; 30] = [
    metric("win_share", "", "1 for a game won, half of that for a draw"),
    metric("score", "", "points"),
    metric("grabs", "", "flags taken"),
    metric("captures", "", "flags brought in"),
    metric("tags", "", "opponents tagged"),
    metric("tagged", "", "times tagged, by an opponent or the boundary"),
    metric("out_of_bounds", "", "times a boat left the field"),
    metric("collisions", "", "times a boat was nearer to another than the collision distance"),
    metric("tagged_s", "s", "time tagged, all boats together"),
    metric("outside_s", "s", "time outside of the field, all boats together"),
    metric("distance_m", "m", "distance over the ground, all boats together"),
    metric("energy_kj", "kJ", "energy taken from batteries, all boats together; none without batteries"),
    metric("edge_m", "m", "the least distance of its boats to the edge of the field, below 0 outside"),
    metric("opponent_score", "", "the opponent's points"),
    metric("opponent_grabs", "", "flags that the opponent took"),
    metric("opponent_captures", "", "flags that the opponent brought in"),
    metric("opponent_tags", "", "boats of the entry that the opponent tagged"),
    metric("opponent_tagged", "", "times that boats of the opponent were tagged"),
    metric("opponent_out_of_bounds", "", "times that a boat of the opponent left the field"),
    metric(
        "opponent_collisions",
        "",
        "times that one of the opponent's was nearer to another than the collision distance",
    ),
    metric("opponent_tagged_s", "s", "time that the opponent's boats were tagged"),
    metric("opponent_outside_s", "s", "time that the opponent's boats were outside of the field"),
    metric("opponent_distance_m", "m", "distance of the opponent's boats over the ground"),
    metric("opponent_energy_kj", "kJ", "energy that the opponent's boats took from batteries"),
    metric(
        "opponent_edge_m",
        "m",
        "the least distance of the opponent's boats to the edge of the field, below 0 outside",
    ),
    metric("score_difference", "", "points less the opponent's"),
    metric("contacts", "", "times that two hulls touched, of any boats"),
    metric(
        "near_misses",
        "",
        "times that two boats were nearer than the collision distance and did not touch, of any boats",
    ),
    metric("closest_m", "m", "the least distance of any two boats' centres"),
    metric("duration_s", "s", "how long the game lasted"),
];

/// The metrics that a summary shows, and of which interactions are looked for.
pub(crate) const HEADLINES: [&str; 5] = ["win_share", "score", "opponent_score", "out_of_bounds", "contacts"];

/// The place of a metric among all.
pub(crate) fn index_of(name: &str) -> Option<usize> {
    METRICS.iter().position(|metric| metric.name == name)
}
