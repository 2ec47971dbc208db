//! Encounters: boats that come too close, and their relation at that time.

use super::{Quality, strategy_name};
use crate::hull_overlap::HullRectangle;
use crate::step::{Sample, Step};
use primitives::VehicleId;
use rules::event::{Event, TagCause};
use scenario::Scenario;
use serde::Serialize;

/// How long a tagger and the boat it tagged keep that relation, s.
const TAG_REMEMBERED_S: f64 = 10.0;
/// Hysteresis of encounters, m: boats that bounce off each other have one encounter.
const APART_M: f64 = 1.0;

/// The relation between two boats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    /// Teammates.
    Mate,
    /// Boats of different teams.
    Enemy,
    /// One tagged the other at most 10 s ago.
    TaggerAndTagged,
}

/// Number of encounters, by relation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Encounters {
    /// Teammates.
    pub mate: Nearness,
    /// Boats of different teams, except those below.
    pub enemy: Nearness,
    /// One tagged the other at most 10 s before.
    pub tagger_and_tagged: Nearness,
}

/// Encounters by severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Nearness {
    /// Hulls touched.
    pub contacts: u64,
    /// Hulls did not touch, but boats were closer than the collision distance of the rules.
    pub near_misses: u64,
}

impl Nearness {
    fn merge(&mut self, other: Nearness) {
        self.contacts += other.contacts;
        self.near_misses += other.near_misses;
    }
}

impl Encounters {
    /// The sum over all relations.
    pub fn all(&self) -> Nearness {
        let mut sum = self.mate;
        sum.merge(self.enemy);
        sum.merge(self.tagger_and_tagged);
        sum
    }

    pub(super) fn merge(&mut self, other: &Encounters) {
        self.mate.merge(other.mate);
        self.enemy.merge(other.enemy);
        self.tagger_and_tagged.merge(other.tagger_and_tagged);
    }

    fn count(&mut self, encounter: Encounter) {
        let nearness = match encounter.relation {
            Relation::Mate => &mut self.mate,
            Relation::Enemy => &mut self.enemy,
            Relation::TaggerAndTagged => &mut self.tagger_and_tagged,
        };
        *(if encounter.touched {
            &mut nearness.contacts
        } else {
            &mut nearness.near_misses
        }) += 1;
    }
}

/// An ongoing encounter.
#[derive(Clone, Copy, Debug)]
struct Encounter {
    /// The relation at its start.
    relation: Relation,
    touched: bool,
}

/// Counts the encounters of a game.
pub(super) struct EncounterCounter {
    scenario: Scenario,
    /// Ongoing encounters by pair: lower vehicle times number of vehicles, plus the higher.
    open: Vec<Option<Encounter>>,
    /// The last tagger and the time of the tag, s, by vehicle index.
    tagged_by: Vec<Option<(usize, f64)>>,
}

impl EncounterCounter {
    pub(super) fn new(scenario: &Scenario) -> EncounterCounter {
        let count = scenario.vehicles.len();
        EncounterCounter {
            scenario: scenario.clone(),
            open: vec![None; count * count],
            tagged_by: vec![None; count],
        }
    }

    /// Adds the next step; counts the encounters that end.
    pub(super) fn add(&mut self, step: &Step, quality: &mut Quality) {
        for logged in &step.events {
            if let Event::Tagged {
                vehicle,
                cause: TagCause::Opponent(by),
            } = logged.event
            {
                self.tagged_by[vehicle.index()] = Some((by.index(), logged.at.as_s()));
            }
        }
        let count = self.tagged_by.len();
        for b in 0..count {
            for a in 0..b {
                self.look_at(step, a, b, quality);
            }
        }
    }

    /// Updates the encounter of two boats, the lower vehicle first.
    fn look_at(&mut self, step: &Step, a: usize, b: usize, quality: &mut Quality) {
        let near_m = self.scenario.rules.collision_distance_m;
        let (Some(one), Some(other)) = (step.samples.get(a), step.samples.get(b)) else {
            return;
        };
        let distance_m = one.truth.at().distance(other.truth.at());
        let touched = self.touches((a, one), (b, other), distance_m);
        let place = a * self.tagged_by.len() + b;
        if let Some(open) = &mut self.open[place] {
            open.touched |= touched;
            if distance_m > near_m + APART_M && !touched {
                self.close(place, quality);
            }
        } else if touched || distance_m < near_m {
            let relation = self.relation(a, b, step.time_s);
            self.open[place] = Some(Encounter { relation, touched });
        }
    }

    /// Ends every encounter at the end of the game.
    pub(super) fn end(&mut self, quality: &mut Quality) {
        (0..self.open.len()).for_each(|place| self.close(place, quality));
    }

    fn close(&mut self, place: usize, quality: &mut Quality) {
        let Some(encounter) = self.open[place].take() else {
            return;
        };
        quality.encounters.count(encounter);
        let count = self.tagged_by.len();
        let names =
            [place / count, place % count].map(|vehicle| strategy_name(&self.scenario, vehicle));
        let both_count = encounter.relation != Relation::Mate || names[0] != names[1];
        for name in names.into_iter().take(if both_count { 2 } else { 1 }) {
            quality
                .strategies
                .entry(name.to_owned())
                .or_default()
                .encounters
                .count(encounter);
        }
    }

    fn touches(
        &self,
        (a, one): (usize, &Sample),
        (b, other): (usize, &Sample),
        distance_m: f64,
    ) -> bool {
        let hull = |vehicle: usize, sample: &Sample| {
            let boat = self.scenario.boat_of(VehicleId::at(vehicle));
            HullRectangle {
                pose: sample.truth.pose(),
                length_m: boat.length_m,
                beam_m: boat.beam_m,
            }
        };
        let one = hull(a, one);
        let other = hull(b, other);
        let reach_m = one.length_m + one.beam_m + other.length_m + other.beam_m;
        distance_m < reach_m && one.overlaps(&other)
    }

    fn relation(&self, a: usize, b: usize, now_s: f64) -> Relation {
        let team_of = |vehicle: usize| self.scenario.team_of(VehicleId::at(vehicle));
        let tagged_by = |on: usize, by: usize| {
            self.tagged_by[on].is_some_and(|(b, at)| b == by && now_s - at <= TAG_REMEMBERED_S)
        };
        if team_of(a) == team_of(b) {
            Relation::Mate
        } else if tagged_by(a, b) || tagged_by(b, a) {
            Relation::TaggerAndTagged
        } else {
            Relation::Enemy
        }
    }
}
