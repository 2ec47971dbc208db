//! The outcome of a game, as written by `--json`.

use crate::{Scenario, Vehicle};
use primitives::id::{TeamId, VehicleId};
use rules::count::{Counts, Tally};
use rules::event::{Event, Logged, TagCause};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The result of a game.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The scenario's name.
    pub scenario: String,
    /// The game's seed.
    pub seed: u64,
    /// The version of Squall that played it.
    pub version: String,
    /// Digest of the final state and all events, in hex.
    pub digest: String,
    /// Simulated time played, s.
    pub duration_s: f64,
    /// Physics ticks played.
    pub ticks: u64,
    /// Numbers drawn for this game, by name, in the units of the files.
    #[serde(skip_serializing_if = "BTreeMap::is_empty", default)]
    pub drawn: BTreeMap<String, f64>,
    /// Whether the game depends on the seed.
    #[serde(default)]
    pub random: bool,
    /// Whether wind, waves or current may favour one end of the field. If so, a single game does
    /// not show which team is better.
    #[serde(default)]
    pub ends_differ: bool,
    /// The winning team's name; `None` for a draw or an unfinished game.
    pub winner: Option<String>,
    /// The team of each boat.
    pub boats: BTreeMap<String, String>,
    /// Points.
    pub score: Standings<u32>,
    /// Counts of events.
    pub counts: Standings<Counts>,
    /// All events, in order.
    pub events: Vec<EventOutcome>,
}

/// A value for each team and each boat, by name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Standings<T> {
    /// By team name.
    pub teams: BTreeMap<String, T>,
    /// By boat name.
    pub boats: BTreeMap<String, T>,
}

/// An event with names in place of indices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EventOutcome {
    /// Physics tick.
    pub tick: u64,
    /// Simulated time, s.
    pub at_s: f64,
    /// The kind of event, for example `tagged`.
    pub event: String,
    /// The boat that the event concerns.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub vehicle: Option<String>,
    /// The tagger or the other boat.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub other: Option<String>,
    /// The team whose flag is involved, or the winner.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub team: Option<String>,
}

impl EventOutcome {
    /// The event with the scenario's names.
    pub fn new(scenario: &Scenario, logged: &Logged) -> EventOutcome {
        let name = |vehicle: VehicleId| scenario.vehicles[vehicle.index()].name.clone();
        let team = |team: TeamId| scenario.teams[team.index()].name.clone();
        let word = match logged.event {
            Event::Tagged {
                cause: TagCause::Boundary,
                ..
            } => "tagged_by_boundary",
            Event::Tagged {
                cause: TagCause::Obstacle,
                ..
            } => "tagged_by_obstacle",
            event => event.into(),
        };
        let whose = match logged.event {
            Event::Ended { winner } => winner,
            event => event
                .flag()
                .map(|flag| scenario.field.flags[flag.index()].team),
        };
        EventOutcome {
            tick: logged.tick,
            at_s: logged.at.as_s(),
            event: word.to_owned(),
            vehicle: logged.event.vehicle().map(name),
            other: logged.event.other().map(name),
            team: whose.map(team),
        }
    }

    /// The event as a sentence, without its time.
    pub fn sentence(&self) -> String {
        let who = self.vehicle.as_deref().unwrap_or("nobody");
        let other = self.other.as_deref().unwrap_or("nobody");
        let team = self.team.as_deref().unwrap_or("nobody");
        match self.event.as_str() {
            "grabbed" => format!("{who} grabs the {team} flag"),
            "captured" => format!("{who} CAPTURES the {team} flag"),
            "flag_returned" => format!("{who} loses the {team} flag"),
            "tagged" => format!("{who} is tagged by {other}"),
            "tagged_by_boundary" => format!("{who} is tagged by the boundary"),
            "tagged_by_obstacle" => format!("{who} is tagged by an obstacle"),
            "untagged" => format!("{who} is untagged and back in play"),
            "left_field" => format!("{who} leaves the field"),
            "returned_to_field" => format!("{who} is back on the field"),
            "collided" => format!("{who} and {other} collide"),
            "entered_keepout" => format!("{who} enters the keep-out of its own flag"),
            "disabled" => format!("{who} is out of action"),
            "enabled" => format!("{who} is back in action"),
            "agent_lost" => format!("{who} has LOST ITS AGENT and holds"),
            "agent_back" => format!("{who} has an agent again"),
            "quarantined" => format!("{who} is QUARANTINED: its state is not finite"),
            "nav_lost" => format!("{who} is LOST: its position is no longer reported"),
            "nav_back" => format!("{who} reports its position again"),
            "e_stopped" => "E-STOP: all boats hold".to_owned(),
            "released" => "the E-stop is released".to_owned(),
            "halted" => "all boats hold".to_owned(),
            "went_on" => "boats continue".to_owned(),
            "ended" if self.team.is_none() => "the game ends in a draw".to_owned(),
            "ended" => format!("{team} wins"),
            other => other.to_owned(),
        }
    }
}

impl Outcome {
    /// The outcome of a game. `digest` covers its final state and all events, and `score` is by
    /// team index.
    pub fn new(
        scenario: &Scenario,
        digest: u128,
        ticks: u64,
        score: &[u32],
        events: &[Logged],
    ) -> Outcome {
        let mut tally = Tally::new(scenario.vehicles.len());
        events.iter().for_each(|logged| tally.add(logged.event));
        let team_counts =
            |team: usize| tally.team(TeamId(team as u8), |i| scenario.vehicles[i].team);
        let team_names = || scenario.teams.iter().map(|team| team.name.clone());
        let boat_names = || scenario.vehicles.iter().map(|vehicle| vehicle.name.clone());
        let boats = || boat_names().zip(&tally.vehicles);
        let team_of = |vehicle: &Vehicle| scenario.teams[vehicle.team.index()].name.clone();
        let winner = events.iter().rev().find_map(|logged| match logged.event {
            Event::Ended { winner } => winner,
            _ => None,
        });
        let drawn = scenario.drawn.iter();
        let drawn = drawn.map(|drawn| (drawn.parameter.clone(), drawn.value));
        let points = boats().map(|(name, counts)| (name, scenario.rules.points.of(counts)));
        let events = events.iter();
        let events = events.map(|logged| EventOutcome::new(scenario, logged));
        Outcome {
            scenario: scenario.name.clone(),
            seed: scenario.seed,
            version: primitives::VERSION.to_owned(),
            digest: format!("{:032x}", digest),
            duration_s: (scenario.tick * ticks as i64).as_s(),
            ticks,
            drawn: drawn.collect(),
            random: scenario.is_random(),
            ends_differ: !scenario.sea.is_at_rest(),
            winner: winner.map(|team| scenario.teams[team.index()].name.clone()),
            boats: boat_names()
                .zip(scenario.vehicles.iter().map(team_of))
                .collect(),
            score: Standings {
                teams: team_names().zip(score.iter().copied()).collect(),
                boats: points.collect(),
            },
            counts: Standings {
                teams: team_names().zip((0..).map(team_counts)).collect(),
                boats: boats().map(|(name, counts)| (name, *counts)).collect(),
            },
            events: events.collect(),
        }
    }
}
