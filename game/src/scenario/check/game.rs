//! A game file and all the files it names, checked.

use super::boat::{FASTEST_PER_TICK, fastest_decay};
use super::link::link;
use super::missing_path;
use super::start_position;
use crate::boat::Boat;
use crate::field::Field;
use crate::id::TeamId;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawBoat, RawFleet, RawGame, RawSource, RawStrategy, RawVehicle};
use crate::scenario::read::{self, Document, Typed};
use crate::scenario::source::tidied;
use crate::scenario::{Kind, Scenario, Source, StartPosition, Team, Vehicle};
use crate::sea::Sea;
use crate::strategy::Strategy;
use crate::time::SimTime;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The most vehicles of a game.
const MOST_VEHICLES: usize = 10_000;

/// A vehicle on the way to its start_position.
pub(super) struct Entry {
    pub(super) name: String,
    /// Where it stands in the files.
    pub(super) place: usize,
    pub(super) team: TeamId,
    pub(super) boat: usize,
    strategy: usize,
    /// The start_position it states; `None` is the team's line.
    pub(super) start_position: Option<StartPosition>,
    pub(super) heading_deg: Option<f64>,
    source: Source,
}

/// Files of one kind that the game names. Each is read once, or once for each owner if it has numbers to be drawn.
pub(super) struct Shelf<R, T> {
    items: Vec<T>,
    path_of: BTreeMap<String, PathBuf>,
    /// Of files without numbers to be drawn.
    index_of: BTreeMap<PathBuf, Option<usize>>,
    check: fn(&mut Diagnostics, &Document<R>) -> Option<T>,
}

impl<R: Typed, T> Shelf<R, T> {
    pub(super) fn new(check: fn(&mut Diagnostics, &Document<R>) -> Option<T>) -> Shelf<R, T> {
        Shelf { items: vec![], path_of: BTreeMap::new(), index_of: BTreeMap::new(), check }
    }

    /// The index of the file that `given` names, as `owner` has it.
    fn index(&mut self, diagnostics: &mut Diagnostics, given: &At<String>, owner: &str) -> Option<usize> {
        let path = diagnostics.sources.resolve(given.at, &given.value);
        let is_new = !self.index_of.contains_key(&path);
        let index = self.index_at(diagnostics, &path, Some(given.at), owner)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if is_new && *self.path_of.entry(name.clone()).or_insert_with(|| path.clone()) != path {
            let message = format!("{} is the second file named {name:?}, expected different names", given.value);
            diagnostics.note(given.at, message);
        }
        Some(index)
    }

    /// The index of the file at `path`, whatever it is named: two versions of one strategy may meet.
    pub(super) fn index_at(
        &mut self,
        diagnostics: &mut Diagnostics,
        path: &Path,
        asked_at: Option<usize>,
        owner: &str,
    ) -> Option<usize> {
        let path = tidied(path);
        if let Some(index) = self.index_of.get(&path) {
            return *index;
        }
        let drawn = diagnostics.drawn.len();
        let index = self.fetch(diagnostics, &path, asked_at, owner);
        if diagnostics.drawn.len() == drawn {
            self.index_of.insert(path, index);
        }
        index
    }

    fn fetch(
        &mut self,
        diagnostics: &mut Diagnostics,
        path: &Path,
        asked_at: Option<usize>,
        owner: &str,
    ) -> Option<usize> {
        let document = read::document_of(diagnostics, path, asked_at, owner)?;
        self.items.push((self.check)(diagnostics, &document)?);
        Some(self.items.len() - 1)
    }
}

/// What the entries of the roster refer to.
struct Roster<'a> {
    raw: &'a RawGame,
    field: Option<&'a Field>,
    teams: Vec<(String, Option<At<String>>)>,
    boats: Shelf<RawBoat, Boat>,
    strategies: Shelf<RawStrategy, Strategy>,
    names: BTreeSet<String>,
    entries: Vec<Entry>,
}

/// Checks a game.
pub(in crate::scenario) fn game(diagnostics: &mut Diagnostics, document: &Document<RawGame>) -> Option<Scenario> {
    let faults = diagnostics.faults();
    let (raw, start) = (&document.raw, document.start);
    let field = referenced(diagnostics, start, "field", raw.field.as_ref(), super::field);
    let rules = referenced(diagnostics, start, "rules", raw.rules.as_ref(), super::rules);
    let sea = sea(diagnostics, document);
    let (tick, ticks_per_decision) = clock(diagnostics, raw);
    let seed = diagnostics.whole("seed", raw.seed.as_ref(), 0..=i64::MAX, 1);
    let duration_s = diagnostics.number("duration_s", raw.duration_s.as_ref(), 1.0..=86400.0);
    let patience_s = diagnostics.number("patience_s", raw.patience_s.as_ref(), 0.001..=3600.0);
    let order_ttl_s = diagnostics.number("order_ttl_s", raw.order_ttl_s.as_ref(), 0.01..=3600.0);
    let mut roster = Roster {
        raw,
        field: field.as_ref(),
        teams: teams(diagnostics, document),
        boats: Shelf::new(super::boat),
        strategies: Shelf::new(super::strategy),
        names: BTreeSet::new(),
        entries: vec![],
    };
    roster.fill(diagnostics, start);
    check_tick(diagnostics, raw, tick, &roster.boats.items);
    let Roster { teams, boats, strategies, entries, .. } = roster;
    let (field, mut rules, sea) = (field?, rules?, sea?);
    if diagnostics.faults() != faults {
        return None;
    }
    let start_positions = start_position::all(&entries, &field);
    start_position::check_clear(diagnostics, &entries, &start_positions, &boats.items, &field);
    let link = raw.link.as_ref().map(|given| link(diagnostics, &given.value, &field));
    rules.time_limit = duration_s.map_or(rules.time_limit, SimTime::from_s);
    let vehicles = entries.into_iter().zip(start_positions).map(|(entry, start_position)| Vehicle {
        name: entry.name,
        team: entry.team,
        boat: entry.boat,
        strategy: entry.strategy,
        start_position,
        source: entry.source,
    });
    let scenario = Scenario {
        name: document.name.clone(),
        seed: seed as u64,
        tick,
        ticks_per_decision,
        patience_s: patience_s.unwrap_or(5.0),
        order_ttl_s: order_ttl_s.unwrap_or(1.0),
        field,
        rules,
        sea,
        link,
        teams: teams.into_iter().map(|(name, _)| Team { name }).collect(),
        boats: boats.items,
        strategies: strategies.items,
        vehicles: vehicles.collect(),
        drawn: vec![],
        recipe: None,
    };
    (diagnostics.faults() == faults).then_some(scenario)
}

/// The game's sea, or the one that takes its place.
fn sea(diagnostics: &mut Diagnostics, document: &Document<RawGame>) -> Option<Sea> {
    if let Some(path) = diagnostics.overrides.sea.clone() {
        let document = read::document(diagnostics, &path, None)?;
        return super::sea(diagnostics, &document);
    }
    match &document.raw.sea {
        Some(given) => referenced(diagnostics, document.start, "sea", Some(given), super::sea),
        None => Some(Sea::at_rest()),
    }
}

pub(super) fn referenced<R: Typed, T>(
    diagnostics: &mut Diagnostics,
    owner: usize,
    key: &str,
    given: Option<&At<String>>,
    check: fn(&mut Diagnostics, &Document<R>) -> Option<T>,
) -> Option<T> {
    let Some(given) = given else {
        missing_path(diagnostics, owner, key);
        return None;
    };
    let path = diagnostics.sources.resolve(given.at, &given.value);
    let document = read::document(diagnostics, &path, Some(given.at))?;
    check(diagnostics, &document)
}

/// The physics tick, and how many of them a decision lasts.
fn clock(diagnostics: &mut Diagnostics, raw: &RawGame) -> (SimTime, u32) {
    let tick_s = diagnostics.number("tick_s", raw.tick_s.as_ref(), 0.001..=0.5).unwrap_or(0.05);
    let decision_s = diagnostics.number("decision_s", raw.decision_s.as_ref(), 0.001..=10.0).unwrap_or(0.1);
    let (tick, decision) = (SimTime::from_s(tick_s), SimTime::from_s(decision_s));
    if decision.0 % tick.0 != 0 {
        let place = raw.decision_s.as_ref().or(raw.tick_s.as_ref()).map_or(0, |given| given.at);
        diagnostics.note(place, format!("decision_s is {decision_s}, expected a multiple of tick_s, {tick_s}"));
    }
    (tick, (decision.0 / tick.0) as u32)
}

/// A boat that is stable at the usual tick may not be at a longer one.
fn check_tick(diagnostics: &mut Diagnostics, raw: &RawGame, tick: SimTime, boats: &[Boat]) {
    let Some(given) = &raw.tick_s else { return };
    for boat in boats {
        let (motion, rate_per_s) = fastest_decay(boat);
        if rate_per_s * tick.as_s() > FASTEST_PER_TICK {
            let message = format!(
                "tick_s is {}, expected at most {:.4}: the {motion} of boat {} dies out at {rate_per_s:.1} 1/s",
                given.value,
                FASTEST_PER_TICK / rate_per_s,
                boat.name
            );
            diagnostics.note(given.at, message);
        }
    }
}

fn teams(diagnostics: &mut Diagnostics, document: &Document<RawGame>) -> Vec<(String, Option<At<String>>)> {
    let given = document.raw.team.as_deref().unwrap_or_default();
    if given.len() != 2 {
        let message = format!("team has {} entries, expected exactly two [[team]] for now", given.len());
        match given.get(2) {
            Some(third) => diagnostics.note(third.at, message),
            None => diagnostics.note_if_intact(document.start, message),
        }
    }
    let mut teams: Vec<(String, Option<At<String>>)> = vec![];
    for team in given.iter().take(2) {
        let Some(name) = &team.value.name else {
            diagnostics.note_missing(team.at, "team.name", "1 to 40 of a-z, 0-9 and _");
            continue;
        };
        if diagnostics.is_name(name.at, "name", &name.value) && teams.iter().any(|(other, _)| *other == name.value) {
            diagnostics
                .note(name.at, format!("name is {:?} again, expected a different one for each team", name.value));
        }
        teams.push((name.value.clone(), team.value.strategy.clone()));
    }
    let names = teams.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
    let unknown =
        diagnostics.overrides.strategies.keys().find(|team| teams.iter().all(|(name, _)| name != *team)).cloned();
    if let Some(team) = unknown {
        let message = format!("there is no team {team:?} to give another strategy to, expected one of {names}");
        diagnostics.note_if_intact(document.start, message);
    }
    teams
}

impl Roster<'_> {
    fn fill(&mut self, diagnostics: &mut Diagnostics, start: usize) {
        let raw = self.raw;
        for vehicle in raw.vehicle.iter().flatten() {
            self.add_vehicle(diagnostics, vehicle);
        }
        for fleet in raw.fleet.iter().flatten() {
            self.add_fleet(diagnostics, fleet);
        }
        if raw.vehicle.iter().flatten().next().is_none() && raw.fleet.iter().flatten().next().is_none() {
            diagnostics.note_missing(start, "vehicle", "at least one [[vehicle]] or [[fleet]]");
        }
        // The teams' strategies are checked even where no boat of theirs follows them.
        let followed = self.strategies.items.len();
        for (name, strategy) in &self.teams {
            match (diagnostics.overrides.strategies.get(name).cloned(), strategy) {
                (Some(path), _) => drop(self.strategies.index_at(diagnostics, &path, None, RawStrategy::OWNER)),
                (None, Some(given)) => {
                    self.strategies.index(diagnostics, &strategy_path(given), RawStrategy::OWNER);
                }
                (None, None) => {}
            }
        }
        self.strategies.items.truncate(followed);
    }

    fn add_vehicle(&mut self, diagnostics: &mut Diagnostics, vehicle: &At<RawVehicle>) {
        let raw = &vehicle.value;
        let team = self.team(diagnostics, vehicle.at, "vehicle", raw.team.as_ref());
        let called = raw.name.as_ref().map_or("", |name| name.value.as_str());
        let boat = self.boat(diagnostics, (vehicle.at, "vehicle"), raw.boat.as_ref(), called);
        let strategy = self.strategy(diagnostics, vehicle.at, "vehicle", raw.strategy.as_ref(), team);
        let heading_deg = diagnostics.number("heading_deg", raw.heading_deg.as_ref(), -360.0..=360.0);
        let start_position = team
            .zip(self.field)
            .and_then(|(team, field)| start_position::stated(diagnostics, raw, heading_deg, team, field));
        let Some(name) = &raw.name else {
            diagnostics.note_missing(vehicle.at, "vehicle.name", "1 to 40 of a-z, 0-9 and _");
            return;
        };
        if self.is_new_name(diagnostics, name.at, &name.value)
            && self.is_room(diagnostics, vehicle.at, 1)
            && let (Some(team), Some(boat), Some(strategy)) = (team, boat, strategy)
        {
            let (name, place) = (name.value.clone(), raw.at.as_ref().map_or(vehicle.at, |at| at.at));
            let source = match raw.source {
                Some(RawSource::External) if !diagnostics.overrides.simulate_all => Source::External,
                _ => Source::Simulated,
            };
            self.entries.push(Entry { name, place, team, boat, strategy, start_position, heading_deg, source });
        }
    }

    fn add_fleet(&mut self, diagnostics: &mut Diagnostics, fleet: &At<RawFleet>) {
        let raw = &fleet.value;
        let team = self.team(diagnostics, fleet.at, "fleet", raw.team.as_ref());
        let strategy = self.strategy(diagnostics, fleet.at, "fleet", raw.strategy.as_ref(), team);
        if raw.count.is_none() {
            diagnostics.note_missing(fleet.at, "fleet.count", &format!("1 to {MOST_VEHICLES}"));
        }
        let count = diagnostics.whole("count", raw.count.as_ref(), 1..=MOST_VEHICLES as i64, 1) as usize;
        let spawn = raw.spawn.as_ref();
        let start_position = spawn
            .zip(self.field)
            .and_then(|(spawn, field)| start_position::somewhere(diagnostics, spawn, count, field));
        let of_team = team.map(|team| format!("{}_{{}}", self.teams[team.index()].0));
        let pattern = raw.name.as_ref().map(|name| name.value.clone()).or(of_team).unwrap_or_default();
        let boat = self.boat(diagnostics, (fleet.at, "fleet"), raw.boat.as_ref(), &pattern.replace("{}", "1"));
        let (Some(team), Some(boat), Some(strategy)) = (team, boat, strategy) else { return };
        let place = raw.name.as_ref().map_or(fleet.at, |name| name.at);
        if !pattern.contains("{}") {
            diagnostics.note(place, format!("name is {pattern:?}, expected {{}} in it, where the number goes"));
            return;
        }
        if !self.is_room(diagnostics, fleet.at, count) {
            return;
        }
        for number in 1..=count {
            let name = pattern.replace("{}", &number.to_string());
            if !self.is_new_name(diagnostics, place, &name) {
                return;
            }
            let boat = match number {
                1 => Some(boat),
                _ => self.boat(diagnostics, (fleet.at, "fleet"), raw.boat.as_ref(), &name),
            };
            let (Some(boat), start_position) = (boat, start_position.clone()) else { return };
            let (place, heading_deg, source) = (fleet.at, None, Source::Simulated);
            self.entries.push(Entry { name, place, team, boat, strategy, start_position, heading_deg, source });
        }
    }

    fn is_room(&self, diagnostics: &mut Diagnostics, at: usize, count: usize) -> bool {
        let total = self.entries.len() + count;
        if total > MOST_VEHICLES {
            diagnostics.note(at, format!("vehicles are {total} with this one, expected at most {MOST_VEHICLES}"));
        }
        total <= MOST_VEHICLES
    }

    fn is_new_name(&mut self, diagnostics: &mut Diagnostics, at: usize, name: &str) -> bool {
        if !diagnostics.is_name(at, "name", name) {
            return false;
        }
        let is_new = self.names.insert(name.to_owned());
        if !is_new {
            diagnostics.note(at, format!("name is {name:?} again, expected a different one for each vehicle"));
        }
        is_new
    }

    fn team(
        &self,
        diagnostics: &mut Diagnostics,
        owner: usize,
        kind: &str,
        given: Option<&At<String>>,
    ) -> Option<TeamId> {
        let names = self.teams.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>().join(", ");
        let Some(given) = given else {
            diagnostics.note_missing(owner, &format!("{kind}.team"), &format!("one of {names}"));
            return None;
        };
        let index = self.teams.iter().position(|(name, _)| *name == given.value);
        if index.is_none() {
            diagnostics.note_if_intact(given.at, format!("team is {:?}, expected one of {names}", given.value));
        }
        index.map(|index| TeamId(index as u8))
    }

    /// The boat of the vehicle `name`.
    fn boat(
        &mut self,
        diagnostics: &mut Diagnostics,
        (at, kind): (usize, &str),
        given: Option<&At<String>>,
        name: &str,
    ) -> Option<usize> {
        let Some(given) = given.or(self.raw.boat.as_ref()) else {
            diagnostics.note_missing(at, &format!("{kind}.boat"), "the path of a boat file here or for the game");
            return None;
        };
        self.boats.index(diagnostics, given, name)
    }

    fn strategy(
        &mut self,
        diagnostics: &mut Diagnostics,
        owner: usize,
        kind: &str,
        given: Option<&At<String>>,
        team: Option<TeamId>,
    ) -> Option<usize> {
        let instead = team.and_then(|team| diagnostics.overrides.strategies.get(&self.teams[team.index()].0).cloned());
        if let Some(path) = instead {
            return self.strategies.index_at(diagnostics, &path, None, RawStrategy::OWNER);
        }
        let of_team = team.and_then(|team| self.teams[team.index()].1.clone());
        if given.is_none() && of_team.is_none() {
            if team.is_some() {
                let key = format!("{kind}.strategy");
                diagnostics.note_missing(owner, &key, "the path of a strategy file here or for the team");
            }
            return None;
        }
        self.strategies.index(diagnostics, &strategy_path(given.or(of_team.as_ref())?), RawStrategy::OWNER)
    }
}

/// The path of a strategy that is given by a path, or by the name of one in the folder of strategies.
fn strategy_path(given: &At<String>) -> At<String> {
    let is_name = !given.value.contains(['/', '\\', '.']);
    let value =
        if is_name { format!("../{}/{}.toml", Kind::Strategy.folder(), given.value) } else { given.value.clone() };
    At { value, at: given.at }
}
