//! Compares two games: the same boats on the water and in simulation, or the same game played
//! twice.

use crate::response::{Response, response};
use crate::series::{BoatSeries, GameSeries};
use crate::track::{TrackDifference, apart};
use recording::Header;
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use thiserror::Error;

/// The differences between two games, A and B.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The duration of each game, s.
    pub durations_s: [f64; 2],
    /// Length of the compared part, from the start of both to the end of the shorter, s.
    pub common_s: f64,
    /// Differences in the set-up, in plain words.
    pub notes: Vec<String>,
    /// Boats in both games.
    pub boats: Vec<Pair>,
    /// Points by team, at the end of each file.
    pub score: BTreeMap<String, [Option<u32>; 2]>,
    /// Events in only one of the games.
    pub events: EventDifference,
}

/// A boat in both games.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Its name.
    pub boat: String,
    /// Its team in A.
    pub team: String,
    /// The distance between its tracks.
    pub apart: TrackDifference,
    /// Its response to orders in each game.
    pub response: [Response; 2],
}

/// Events in one game but not in the other. Two events match if kind, boats and team are equal and
/// their times are within the tolerance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventDifference {
    /// The tolerance, s.
    pub tolerance_s: f64,
    /// Number of matched events.
    pub in_both: u32,
    /// Events only in A.
    pub only_in_a: Vec<EventOutcome>,
    /// Events only in B.
    pub only_in_b: Vec<EventOutcome>,
    /// Number of events in each game, by kind.
    pub counts: BTreeMap<String, [u32; 2]>,
}

/// Reason why two games cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Incomparable {
    /// Their positions have different origins.
    #[error("the fields {a} and {b} have different datums, so their positions cannot be compared")]
    Datum {
        /// The field of A.
        a: String,
        /// The field of B.
        b: String,
    },
    /// No boat is in both games.
    #[error("no boat is in both recordings: A has {a}, B has {b}")]
    Boats {
        /// The boats of A.
        a: String,
        /// The boats of B.
        b: String,
    },
    /// The games do not overlap in time.
    #[error("the games do not overlap in time: one of the recordings has no frames")]
    Time,
}

/// Tolerance between two datums, degrees: about a millimetre.
const DATUM_DEG: f64 = 1e-8;

impl Comparison {
    /// Compares two games.
    ///
    /// # Errors
    /// [`Incomparable`] if nothing can be compared.
    pub fn of(
        [head_a, head_b]: [&Header; 2],
        [a, b]: [&GameSeries; 2],
        tolerance_s: f64,
    ) -> Result<Comparison, Incomparable> {
        let [scenario_a, scenario_b] = [head_a, head_b].map(|header| &header.info.scenario);
        let [plan_a, plan_b] = [scenario_a, scenario_b].map(|scenario| &scenario.field.plan);
        let off_deg = f64::max(
            (plan_a.datum.lat_deg - plan_b.datum.lat_deg).abs(),
            (plan_a.datum.lon_deg - plan_b.datum.lon_deg).abs(),
        );
        if off_deg > DATUM_DEG {
            return Err(Incomparable::Datum {
                a: plan_a.name.clone(),
                b: plan_b.name.clone(),
            });
        }
        let both: Vec<(&BoatSeries, &BoatSeries)> = a
            .boats
            .iter()
            .filter_map(|boat| Some((boat, b.boat(&boat.name)?)))
            .collect();
        if both.is_empty() {
            return Err(Incomparable::Boats {
                a: names(&a.boats),
                b: names(&b.boats),
            });
        }
        let pair = |(in_a, in_b): &(&BoatSeries, &BoatSeries)| {
            Some(Pair {
                boat: in_a.name.clone(),
                team: a.teams.get(in_a.team).cloned().unwrap_or_default(),
                apart: apart((a, in_a), (b, in_b))?,
                response: [response(a, in_a), response(b, in_b)],
            })
        };
        let boats = both
            .iter()
            .map(pair)
            .collect::<Option<Vec<Pair>>>()
            .ok_or(Incomparable::Time)?;
        let end_s = [a, b].map(|series| series.times_s.last().copied().unwrap_or(0.0));
        let until_s = end_s[0].min(end_s[1]);
        Ok(Comparison {
            durations_s: [a.span_s(), b.span_s()],
            common_s: a.span_s().min(b.span_s()),
            notes: notes([head_a, head_b], [a, b]),
            boats,
            score: score(a, b),
            events: events(
                [(a, scenario_a), (b, scenario_b)].map(named_events),
                until_s,
                tolerance_s,
            ),
        })
    }
}

fn names(boats: &[BoatSeries]) -> String {
    boats
        .iter()
        .map(|boat| boat.name.as_str())
        .collect::<Vec<_>>()
        .join(", ")
}

/// Other differences between the games, so that they are not attributed to the boats.
fn notes(heads: [&Header; 2], [a, b]: [&GameSeries; 2]) -> Vec<String> {
    let [one, other] = heads.map(|header| &header.info.scenario);
    let mut notes = vec![];
    let mut differ = |what: &str, in_a: &str, in_b: &str| {
        if in_a != in_b {
            notes.push(format!("{what}: {in_a} in A, {in_b} in B"));
        }
    };
    differ("scenario", &one.name, &other.name);
    differ("seed", &one.seed.to_string(), &other.seed.to_string());
    differ("field", &one.field.plan.name, &other.field.plan.name);
    differ("rules", &one.rules.name, &other.rules.name);
    differ("sea", &one.sea.name, &other.sea.name);
    differ("commit", &heads[0].commit, &heads[1].commit);
    let kind = |is_real: bool| if is_real { "real" } else { "simulated" };
    for (i, boat) in a.boats.iter().enumerate() {
        let Some(j) = b.boats.iter().position(|there| there.name == boat.name) else {
            continue;
        };
        let of = |scenario: &Scenario, i: usize| {
            scenario.boat_of(primitives::VehicleId::at(i)).name.clone()
        };
        differ(&boat.name, &of(one, i), &of(other, j));
        differ(&boat.name, kind(boat.is_real), kind(b.boats[j].is_real));
    }
    let alone = |of: &GameSeries, without: &GameSeries| -> Vec<String> {
        of.boats
            .iter()
            .filter(|boat| without.boat(&boat.name).is_none())
            .map(|boat| boat.name.clone())
            .collect()
    };
    for (name, alone) in [("A", alone(a, b)), ("B", alone(b, a))] {
        if !alone.is_empty() {
            notes.push(format!("only in {name}: {}", alone.join(", ")));
        }
    }
    if one.field.plan.name == other.field.plan.name && one.field.plan != other.field.plan {
        notes.push(format!(
            "the field {} is laid out differently",
            one.field.plan.name
        ));
    }
    for (name, series) in [("A", a), ("B", b)] {
        notes.extend(series.remark().map(|remark| format!("{name}: {remark}")));
    }
    if (a.span_s() - b.span_s()).abs() > 0.05 {
        notes.push(format!(
            "A lasts {:.1} s, B {:.1} s: compared up to the end of the shorter",
            a.span_s(),
            b.span_s()
        ));
    }
    notes
}

fn score(a: &GameSeries, b: &GameSeries) -> BTreeMap<String, [Option<u32>; 2]> {
    let mut score: BTreeMap<String, [Option<u32>; 2]> = BTreeMap::new();
    for (i, series) in [a, b].into_iter().enumerate() {
        let last = series.score.last().map_or(&[][..], Vec::as_slice);
        for (team, points) in series.teams.iter().zip(last) {
            score.entry(team.clone()).or_default()[i] = Some(*points);
        }
    }
    score
}

fn named_events((series, scenario): (&GameSeries, &Scenario)) -> Vec<EventOutcome> {
    series
        .events
        .iter()
        .map(|logged| EventOutcome::new(scenario, logged))
        .collect()
}

/// The attributes of an event, other than its time, that must match.
type Kind = (String, Option<String>, Option<String>, Option<String>);

fn kind(event: &EventOutcome) -> Kind {
    (
        event.event.clone(),
        event.vehicle.clone(),
        event.other.clone(),
        event.team.clone(),
    )
}

/// Pairs the events of each kind in order. If the times of two differ too much, the earlier one has
/// no match, because all following events of the other game are later still.
fn events([a, b]: [Vec<EventOutcome>; 2], until_s: f64, tolerance_s: f64) -> EventDifference {
    let mut counts: BTreeMap<String, [u32; 2]> = BTreeMap::new();
    let mut kinds: BTreeMap<Kind, [Vec<EventOutcome>; 2]> = BTreeMap::new();
    for (i, all) in [a, b].into_iter().enumerate() {
        for event in all {
            counts.entry(event.event.clone()).or_default()[i] += 1;
            kinds.entry(kind(&event)).or_default()[i].push(event);
        }
    }
    let mut only_in_a = vec![];
    let mut only_in_b = vec![];
    let mut in_both = 0;
    for [of_a, of_b] in kinds.into_values() {
        let mut of_a = of_a.into_iter().peekable();
        let mut of_b = of_b.into_iter().peekable();
        while let (Some(a), Some(b)) = (of_a.peek(), of_b.peek()) {
            let later_s = b.at_s - a.at_s;
            if later_s.abs() <= tolerance_s {
                in_both += 1;
                of_a.next();
                of_b.next();
            } else if later_s > 0.0 {
                only_in_a.extend(of_a.next());
            } else {
                only_in_b.extend(of_b.next());
            }
        }
        only_in_a.extend(of_a);
        only_in_b.extend(of_b);
    }
    // Events after the end of the shorter game are not counted as missing.
    for only in [&mut only_in_a, &mut only_in_b] {
        only.retain(|event: &EventOutcome| event.at_s <= until_s);
        only.sort_by(|one, other| one.at_s.total_cmp(&other.at_s));
    }
    EventDifference {
        tolerance_s,
        in_both,
        only_in_a,
        only_in_b,
        counts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(at_s: f64, event: &str, vehicle: &str) -> EventOutcome {
        let vehicle = Some(vehicle.to_owned());
        EventOutcome {
            tick: 0,
            at_s,
            event: event.to_owned(),
            vehicle,
            other: None,
            team: None,
        }
    }

    fn times(events: &[EventOutcome]) -> Vec<f64> {
        events.iter().map(|event| event.at_s).collect()
    }

    #[test]
    fn events_within_the_tolerance_are_paired_once_up_to_the_end_of_the_shorter_game() {
        let x = |at_s| event(at_s, "tagged", "x");
        let a = vec![event(10.0, "grabbed", "x"), x(20.0), x(50.0)];
        let b = vec![
            event(11.9, "grabbed", "x"),
            event(20.0, "tagged", "y"),
            x(49.0),
        ];
        let found = events([a.clone(), b.clone()], 100.0, 2.0);
        assert_eq!(found.counts.get("tagged"), Some(&[2, 2]));
        for (what, [a, b], until_s, tolerance_s, want) in [
            (
                "another boat",
                [a.clone(), b],
                100.0,
                2.0,
                (2, vec![20.0], vec![20.0]),
            ),
            ("the same", [a.clone(), a], 100.0, 0.0, (3, vec![], vec![])),
            (
                "one of three",
                [vec![x(10.0), x(11.0), x(12.0)], vec![x(11.5)]],
                100.0,
                2.0,
                (1, vec![11.0, 12.0], vec![]),
            ),
            (
                "after the end",
                [vec![x(10.0), x(61.0)], vec![]],
                60.0,
                2.0,
                (0, vec![10.0], vec![]),
            ),
        ] {
            let found = events([a, b], until_s, tolerance_s);
            assert_eq!(
                (
                    found.in_both,
                    times(&found.only_in_a),
                    times(&found.only_in_b)
                ),
                want,
                "{what}"
            );
        }
    }
}
