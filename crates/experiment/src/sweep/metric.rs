//! The measurements of a game, from the point of view of one entry.

use serde::Serialize;

/// A measurement of a game: a column of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Metric {
    /// The metric's name.
    pub name: &'static str,
    /// The metric's unit; empty for counts and fractions.
    pub unit: &'static str,
    /// The metric's description.
    pub about: &'static str,
}

impl Metric {
    /// The index of the metric with this name in [`METRICS`] and in lists by metric.
    pub fn place(name: &str) -> Option<usize> {
        METRICS.iter().position(|metric| metric.name == name)
    }
}

/// The measurements of a game, in the order of [`METRICS`]; NaN where undefined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metrics(pub [f64; METRICS.len()]);

impl Metrics {
    /// The measurement with this name.
    ///
    /// # Panics
    /// If there is none.
    pub fn of(&self, name: &str) -> f64 {
        self.0[Metric::place(name).expect("a metric has this name")]
    }

    /// The points of the entry and of its opponent.
    pub fn score(&self) -> [f64; 2] {
        ["score", "opponent_score"].map(|name| self.of(name))
    }
}

const fn metric(name: &'static str, unit: &'static str, about: &'static str) -> Metric {
    Metric { name, unit, about }
}

/// All metrics in the order of the columns: those of the entry's team, of its opponent's, and of
/// the game.
pub const METRICS: [Metric; 30] = [
    metric("win_share", "", "1 for a win, 0.5 for a draw"),
    metric("score", "", "points"),
    metric("grabs", "", "flags grabbed"),
    metric("captures", "", "flags captured"),
    metric("tags", "", "opponents tagged"),
    metric("tagged", "", "times tagged, by an opponent or the boundary"),
    metric("out_of_bounds", "", "times a boat left the field"),
    metric(
        "collisions",
        "",
        "times one of its boats was within the collision distance of another",
    ),
    metric("tagged_s", "s", "time tagged, sum over its boats"),
    metric(
        "outside_s",
        "s",
        "time outside the field, sum over its boats",
    ),
    metric(
        "distance_m",
        "m",
        "distance over the ground, sum over its boats",
    ),
    metric(
        "energy_kj",
        "kJ",
        "energy drawn from batteries, sum over its boats; empty without batteries",
    ),
    metric(
        "edge_m",
        "m",
        "smallest distance of its boats from the edge of the field, negative outside",
    ),
    metric("opponent_score", "", "the opponent's points"),
    metric("opponent_grabs", "", "flags that the opponent grabbed"),
    metric("opponent_captures", "", "flags that the opponent captured"),
    metric(
        "opponent_tags",
        "",
        "boats of the entry that the opponent tagged",
    ),
    metric(
        "opponent_tagged",
        "",
        "times that boats of the opponent were tagged",
    ),
    metric(
        "opponent_out_of_bounds",
        "",
        "times that a boat of the opponent left the field",
    ),
    metric(
        "opponent_collisions",
        "",
        "times that one of the opponent's boats was within the collision distance of another",
    ),
    metric(
        "opponent_tagged_s",
        "s",
        "time that the opponent's boats were tagged",
    ),
    metric(
        "opponent_outside_s",
        "s",
        "time that the opponent's boats were outside the field",
    ),
    metric(
        "opponent_distance_m",
        "m",
        "distance of the opponent's boats over the ground",
    ),
    metric(
        "opponent_energy_kj",
        "kJ",
        "energy that the opponent's boats drew from batteries",
    ),
    metric(
        "opponent_edge_m",
        "m",
        "smallest distance of the opponent's boats from the edge of the field, negative outside",
    ),
    metric("score_difference", "", "points minus the opponent's"),
    metric(
        "contacts",
        "",
        "times that the hulls of any two boats touched",
    ),
    metric(
        "near_misses",
        "",
        "times that any two boats were within the collision distance without touching",
    ),
    metric(
        "closest_m",
        "m",
        "smallest distance between the centres of any two boats",
    ),
    metric("duration_s", "s", "duration of the game"),
];

/// The metrics shown in a summary and tested for interactions.
pub(crate) const HEADLINES: [&str; 5] = [
    "win_share",
    "score",
    "opponent_score",
    "out_of_bounds",
    "contacts",
];
