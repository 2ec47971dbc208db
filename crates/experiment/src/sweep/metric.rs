//! The measurements of a game, from the side of one entry.

use serde::Serialize;

/// The measurements of a team in a game; NaN where undefined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "METRICS describes them")]
pub struct TeamMetrics {
    pub score: f64,
    pub grabs: f64,
    pub captures: f64,
    pub tags: f64,
    pub tagged: f64,
    pub out_of_bounds: f64,
    pub collisions: f64,
    pub tagged_s: f64,
    pub outside_s: f64,
    pub distance_m: f64,
    pub energy_kj: f64,
    pub edge_m: f64,
}

/// The measurements of a game; NaN where undefined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "METRICS describes them")]
pub struct Metrics {
    pub win_share: f64,
    pub own: TeamMetrics,
    pub opponent: TeamMetrics,
    pub score_difference: f64,
    pub contacts: f64,
    pub near_misses: f64,
    pub closest_m: f64,
    pub duration_s: f64,
}

/// A measurement of a game: a column of the tables.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Metric {
    /// Its name.
    pub name: &'static str,
    /// Its unit; empty for counts and shares.
    pub unit: &'static str,
    /// Its description.
    pub about: &'static str,
    #[serde(skip)]
    field: fn(&mut Metrics) -> &mut f64,
}

impl PartialEq for Metric {
    fn eq(&self, other: &Metric) -> bool {
        self.name == other.name
    }
}

impl Metric {
    /// The metric with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Metric> {
        METRICS.iter().find(|metric| metric.name == name)
    }

    /// The index of the metric with this name in lists by metric.
    pub(crate) fn place(name: &str) -> Option<usize> {
        METRICS.iter().position(|metric| metric.name == name)
    }

    /// Its value in a game.
    #[must_use]
    pub fn of(&self, metrics: &Metrics) -> f64 {
        let mut metrics = *metrics;
        *(self.field)(&mut metrics)
    }
}

impl Metrics {
    /// Builds the measurements from the value of `number` for each metric.
    pub(crate) fn from_each<E>(mut number: impl FnMut(&Metric) -> Result<f64, E>) -> Result<Metrics, E> {
        let mut metrics = Metrics::default();
        for metric in &METRICS {
            *(metric.field)(&mut metrics) = number(metric)?;
        }
        Ok(metrics)
    }

    /// The points of the entry and of its opponent.
    #[must_use]
    pub fn score(&self) -> [f64; 2] {
        [self.own.score, self.opponent.score]
    }

    /// The mean over games.
    pub(crate) fn mean(games: &[Metrics]) -> Metrics {
        let mut mean = Metrics::default();
        for metric in &METRICS {
            *(metric.field)(&mut mean) = games.iter().map(|game| metric.of(game)).sum::<f64>() / games.len() as f64;
        }
        mean
    }
}

const fn metric(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    field: fn(&mut Metrics) -> &mut f64,
) -> Metric {
    Metric { name, unit, about, field }
}

/// All metrics in the order of the columns: of the entry's team, of its opponent's, and of the
/// game.
pub static METRICS: [Metric; 30] = [
    metric("win_share", "", "1 for a win, 0.5 for a draw", |all| &mut all.win_share),
    metric("score", "", "points", |all| &mut all.own.score),
    metric("grabs", "", "flags grabbed", |all| &mut all.own.grabs),
    metric("captures", "", "flags captured", |all| &mut all.own.captures),
    metric("tags", "", "opponents tagged", |all| &mut all.own.tags),
    metric("tagged", "", "times tagged, by an opponent or the boundary", |all| &mut all.own.tagged),
    metric("out_of_bounds", "", "times a boat left the field", |all| &mut all.own.out_of_bounds),
    metric("collisions", "", "times one of its boats was within the collision distance of another", |all| {
        &mut all.own.collisions
    }),
    metric("tagged_s", "s", "time tagged, sum over its boats", |all| &mut all.own.tagged_s),
    metric("outside_s", "s", "time outside the field, sum over its boats", |all| &mut all.own.outside_s),
    metric("distance_m", "m", "distance over the ground, sum over its boats", |all| &mut all.own.distance_m),
    metric("energy_kj", "kJ", "energy drawn from batteries, sum over its boats; empty without batteries", |all| {
        &mut all.own.energy_kj
    }),
    metric("edge_m", "m", "smallest distance of its boats from the edge of the field, negative outside", |all| {
        &mut all.own.edge_m
    }),
    metric("opponent_score", "", "the opponent's points", |all| &mut all.opponent.score),
    metric("opponent_grabs", "", "flags that the opponent grabbed", |all| &mut all.opponent.grabs),
    metric("opponent_captures", "", "flags that the opponent captured", |all| &mut all.opponent.captures),
    metric("opponent_tags", "", "boats of the entry that the opponent tagged", |all| &mut all.opponent.tags),
    metric("opponent_tagged", "", "times that boats of the opponent were tagged", |all| &mut all.opponent.tagged),
    metric("opponent_out_of_bounds", "", "times that a boat of the opponent left the field", |all| {
        &mut all.opponent.out_of_bounds
    }),
    metric(
        "opponent_collisions",
        "",
        "times that one of the opponent's boats was within the collision distance of another",
        |all| &mut all.opponent.collisions,
    ),
    metric("opponent_tagged_s", "s", "time that the opponent's boats were tagged", |all| &mut all.opponent.tagged_s),
    metric("opponent_outside_s", "s", "time that the opponent's boats were outside the field", |all| {
        &mut all.opponent.outside_s
    }),
    metric("opponent_distance_m", "m", "distance of the opponent's boats over the ground", |all| {
        &mut all.opponent.distance_m
    }),
    metric("opponent_energy_kj", "kJ", "energy that the opponent's boats drew from batteries", |all| {
        &mut all.opponent.energy_kj
    }),
    metric(
        "opponent_edge_m",
        "m",
        "smallest distance of the opponent's boats from the edge of the field, negative outside",
        |all| &mut all.opponent.edge_m,
    ),
    metric("score_difference", "", "points minus the opponent's", |all| &mut all.score_difference),
    metric("contacts", "", "times that the hulls of any two boats touched", |all| &mut all.contacts),
    metric("near_misses", "", "times that any two boats were within the collision distance without touching", |all| {
        &mut all.near_misses
    }),
    metric("closest_m", "m", "smallest distance between the centres of any two boats", |all| &mut all.closest_m),
    metric("duration_s", "s", "duration of the game", |all| &mut all.duration_s),
];

/// The metrics shown in a summary and tested for interactions.
pub(crate) const HEADLINES: [&str; 5] = ["win_share", "score", "opponent_score", "out_of_bounds", "contacts"];
