//! Checks a game file and the files it refers to.

use super::boat::{FASTEST_PER_TICK, fastest_decay};
use super::file_cache::FileCache;
use super::start_position;
use super::strategy::strategy_file;
use crate::boat::Boat;
use crate::diagnostics::{Diagnostics, is_name};
use crate::kind::ScenarioFile;
use crate::link::Link;
use crate::problem::Problems;
use crate::raw;
use crate::read::{self, Document};
use crate::sea::Sea;
use crate::size::VEHICLES_MAX;
use crate::strategy::Strategy;
use crate::{Kind, Scenario, Source, StartPosition, Team, Vehicle};
use primitives::id::TeamId;
use primitives::time::SimTime;
use rules::Rules;
use rules::field::Field;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A vehicle whose start position is not yet known.
pub(super) struct Entry {
    pub(super) name: String,
    /// Its offset in the virtual text.
    pub(super) place: usize,
    pub(super) team: TeamId,
    pub(super) boat: usize,
    strategy: usize,
    /// The start position in its file; `None`: on the team's line.
    pub(super) start_position: Option<StartPosition>,
    pub(super) heading_deg: Option<f64>,
    source: Source,
}

/// The vehicles so far, and the files that they refer to.
struct Fleet<'a> {
    document: &'a Document<raw::Game>,
    field: Option<&'a Field>,
    boats: FileCache<Boat>,
    strategies: FileCache<Strategy>,
    names: BTreeSet<String>,
    entries: Vec<Entry>,
}

impl ScenarioFile for Scenario {
    type Keys = raw::Game;
    const NAME: &'static str = "game";
    const FOLDER: &'static str = "games";

    fn check(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) -> Option<Scenario> {
        let raw = &document.raw;
        let field = diagnostics.referenced::<Field, _>(document, "field", &raw.field.0);
        let rules = diagnostics.referenced::<Rules, _>(document, "rules", &raw.rules.0);
        let sea = sea(diagnostics, document);
        let (tick, ticks_per_decision) = clock(diagnostics, document);
        check_teams(diagnostics, document);
        let mut fleet = Fleet {
            document,
            field: field.as_ref(),
            boats: FileCache::new(Diagnostics::read),
            strategies: FileCache::by_owner(strategy_file),
            names: BTreeSet::new(),
            entries: vec![],
        };
        fleet.fill(diagnostics);
        check_tick(diagnostics, document, tick, &fleet.boats.items);
        check_looks(diagnostics, document, tick, rules.as_ref());
        check_reseed(diagnostics, document);
        let Fleet {
            boats,
            strategies,
            entries,
            ..
        } = fleet;
        let field = field?;
        let mut rules = rules?;
        let sea = sea?;
        if !document.is_faultless(diagnostics) {
            return None;
        }
        let start_positions = start_position::all(&entries, &field);
        start_position::check_clear(
            diagnostics,
            &entries,
            &start_positions,
            &boats.items,
            &field,
        );
        check_models(diagnostics, &entries, &strategies.items);
        check_duration(diagnostics, document);
        rules.time_limit = raw.duration_s.map_or(rules.time_limit, SimTime::from_s);
        let vehicles = entries
            .into_iter()
            .zip(start_positions)
            .map(|(entry, start_position)| Vehicle {
                name: entry.name,
                team: entry.team,
                boat: entry.boat,
                strategy: entry.strategy,
                start_position,
                source: entry.source,
            });
        let vehicles: Vec<Vehicle> = vehicles.collect();
        let faults = super::fault::faults(diagnostics, document, &vehicles, &boats.items);
        let link = link(document, &field);
        let scenario = Scenario {
            name: document.name.clone(),
            seed: raw.seed,
            reseed: raw.reseed.clone(),
            tick,
            ticks_per_decision,
            patience_s: raw.patience_s,
            order_ttl_s: raw.order_ttl_s,
            link,
            field,
            rules,
            sea,
            teams: raw
                .team
                .iter()
                .map(|team| Team {
                    name: team.name.0.clone(),
                })
                .collect(),
            boats: boats.items,
            strategies: strategies.items,
            vehicles,
            faults,
            drawn: vec![],
            recipe: None,
        };
        if let Err(problem) = scenario.check_sizes() {
            diagnostics.note(document.at("team"), problem);
        }
        document.is_faultless(diagnostics).then_some(scenario)
    }

    fn load(path: &Path) -> Result<Scenario, Problems> {
        crate::load(path)
    }
}

/// The radio links; the station stands in the middle of the field if the file names no other place.
fn link(document: &Document<raw::Game>, field: &Field) -> Option<Link> {
    let mut link = document.raw.link.clone();
    if !document.has("link.station") {
        let middle = field.seen_from(
            TeamId(0),
            0.5 * field.plan.width_m,
            0.5 * field.plan.depth_m,
        );
        link.iter_mut().for_each(|link| link.station = middle);
    }
    link
}

/// Reports a setting that the game overrides.
fn check_duration(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) {
    let is_set = |key: &str| {
        diagnostics
            .overrides
            .settings
            .iter()
            .any(|setting| setting.key == key)
    };
    if document.raw.duration_s.is_some() && is_set("rules.time_limit_s") {
        let message =
            "duration_s of the game overrides rules.time_limit_s; set game.duration_s instead";
        diagnostics.note(document.at("duration_s"), message);
    }
}

/// Reseeds must be in ascending order.
fn check_reseed(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) {
    for (i, pair) in document.raw.reseed.windows(2).enumerate() {
        if pair[1].after_s <= pair[0].after_s {
            let place = document.at(&format!("reseed.{}", i + 1));
            let message = format!(
                "after_s is {}, expected more than {} of the previous entry",
                pair[1].after_s, pair[0].after_s
            );
            diagnostics.note(place, message);
        }
    }
}

/// The game's sea, or its override.
fn sea(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) -> Option<Sea> {
    if let Some(path) = diagnostics.overrides.sea.clone() {
        return diagnostics.read(&path, None, Sea::NAME);
    }
    match &document.raw.sea {
        Some(given) => diagnostics.referenced::<Sea, _>(document, "sea", &given.0),
        None if diagnostics.overrides.has_settings(Sea::NAME) => {
            let path = Path::new("at_rest.toml");
            let document =
                read::document_of_text(diagnostics, Kind::SEA, path, "water_density_kg_m3 = 1000")?;
            Sea::check(diagnostics, &document)
        }
        None => Some(Sea::at_rest()),
    }
}

/// The physics tick, and the number of ticks per decision.
fn clock(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) -> (SimTime, u32) {
    let raw::Game {
        tick_s, decision_s, ..
    } = document.raw;
    let tick = SimTime::from_s(tick_s);
    let decision = SimTime::from_s(decision_s);
    if decision.0 % tick.0 != 0 {
        let place = document.at(if document.has("decision_s") {
            "decision_s"
        } else {
            "tick_s"
        });
        diagnostics.note(
            place,
            format!("decision_s is {decision_s}, expected a multiple of tick_s, {tick_s}"),
        );
    }
    (tick, (decision.0 / tick.0) as u32)
}

/// A boat that is stable at the default tick may be unstable at a longer one.
fn check_tick(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Game>,
    tick: SimTime,
    boats: &[Boat],
) {
    for boat in boats.iter().filter(|_| document.has("tick_s")) {
        let (motion, rate_per_s) = fastest_decay(boat);
        if rate_per_s * tick.as_s() > FASTEST_PER_TICK {
            let message = format!(
                "tick_s is {}, expected at most {:.4}: the {motion} of boat {} decays at {rate_per_s:.1} 1/s",
                document.raw.tick_s,
                FASTEST_PER_TICK / rate_per_s,
                boat.name
            );
            diagnostics.note(document.at("tick_s"), message);
        }
    }
}

/// The referee checks only at whole ticks.
fn check_looks(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Game>,
    tick: SimTime,
    rules: Option<&Rules>,
) {
    let Some(rules) = rules else { return };
    for (key, period) in [
        ("tag_look_period_s", rules.tag_look_period),
        ("flag_look_period_s", rules.flag_look_period),
    ] {
        if period.0 % tick.0 != 0 {
            let name = &rules.name;
            let period_s = period.as_s();
            let tick_s = tick.as_s();
            let message = format!(
                "{key} of rules {name} is {period_s}, expected a multiple of tick_s, {tick_s}"
            );
            diagnostics.note(document.at("rules"), message);
        }
    }
}

/// Models have a fixed team size, unless they have spare slots.
fn check_models(diagnostics: &mut Diagnostics, entries: &[Entry], strategies: &[Strategy]) {
    for Entry {
        name,
        place,
        team,
        strategy,
        ..
    } in entries
    {
        let mates = entries.iter().filter(|other| other.team == *team).count() - 1;
        let enemies = entries.len() - 1 - mates;
        for model in strategies[*strategy].models() {
            let takes = model.input_size();
            let size = model.spec.observation.size(mates, enemies);
            if takes != size {
                let message = format!(
                    "the model {} has {takes} inputs, expected {size}: {name} has {mates} mates and {enemies} enemies",
                    model.name
                );
                diagnostics.note(*place, message);
            }
        }
    }
}

fn check_teams(diagnostics: &mut Diagnostics, document: &Document<raw::Game>) {
    let teams: Vec<&str> = document
        .raw
        .team
        .iter()
        .map(|team| team.name.0.as_str())
        .collect();
    for (i, name) in teams.iter().enumerate() {
        if !name.is_empty() && teams[..i].contains(name) {
            let place = document.at(&format!("team.{i}.name"));
            diagnostics.note(
                place,
                format!("name {name:?} is used twice, expected a unique name for each team"),
            );
        }
    }
    let is_unknown = |team: &&str| !teams.contains(team);
    let overrides = &diagnostics.overrides;
    let names = teams.join(", ");
    let replaced = overrides
        .strategies
        .keys()
        .map(String::as_str)
        .find(is_unknown);
    let replaced = replaced.map(|team| {
        let option = PathBuf::from(format!("--strategy {team}"));
        (
            option,
            format!("unknown team {team:?}, expected one of {names}"),
        )
    });
    let unknown = replaced.or_else(|| {
        let changed = overrides
            .settings
            .iter()
            .find(|setting| setting.team().as_ref().is_some_and(is_unknown))?;
        let message = format!(
            "{}: unknown team, expected one of {names} after strategy",
            changed.key
        );
        Some((changed.path.clone(), message))
    });
    if let Some((path, message)) =
        unknown.filter(|_| !diagnostics.sources.is_broken_file(document.at("")))
    {
        diagnostics.note_file(path, message);
    }
}

impl Fleet<'_> {
    fn fill(&mut self, diagnostics: &mut Diagnostics) {
        let document = self.document;
        for (i, vehicle) in document.raw.vehicle.iter().enumerate() {
            self.add_vehicle(diagnostics, &format!("vehicle.{i}"), vehicle);
        }
        for (i, fleet) in document.raw.fleet.iter().enumerate() {
            self.add_fleet(diagnostics, &format!("fleet.{i}"), fleet);
        }
        if document.raw.vehicle.is_empty()
            && document.raw.fleet.is_empty()
            && document.is_sound("vehicle")
        {
            let message = "vehicle is missing, expected at least one [[vehicle]] or [[fleet]]";
            diagnostics.note_if_intact(document.at(""), message);
        }
        // The teams' strategies are checked even if no boat follows them.
        let followed = self.strategies.items.len();
        for i in 0..document.raw.team.len() {
            self.strategy_of_team(diagnostics, i);
        }
        self.strategies.items.truncate(followed);
    }

    fn add_vehicle(&mut self, diagnostics: &mut Diagnostics, path: &str, raw: &raw::Vehicle) {
        let team = self.team(diagnostics, path, &raw.team);
        let boat = self.boat(diagnostics, path, raw.boat.as_ref(), &raw.name.0);
        let strategy = self.strategy(diagnostics, path, raw.strategy.as_ref(), team);
        let stated = team.zip(self.field).map(|(team, field)| {
            start_position::stated(diagnostics, self.document, path, raw, team, field)
        });
        let place = self.document.at(path);
        if self.document.is_sound(&format!("{path}.name"))
            && self.is_new_name(
                diagnostics,
                self.document.at(&format!("{path}.name")),
                &raw.name.0,
            )
            && is_room(diagnostics, place, self.entries.len() + 1)
            && let (Some(team), Some(boat), Some(strategy)) = (team, boat, strategy)
        {
            self.entries.push(Entry {
                name: raw.name.0.clone(),
                place: if raw.at.is_some() {
                    self.document.at(&format!("{path}.at"))
                } else {
                    place
                },
                team,
                boat,
                strategy,
                start_position: stated.flatten(),
                heading_deg: raw.heading_deg,
                source: if diagnostics.overrides.simulate_all {
                    Source::Simulated
                } else {
                    raw.source
                },
            });
        }
    }

    fn add_fleet(&mut self, diagnostics: &mut Diagnostics, path: &str, raw: &raw::Fleet) {
        let team = self.team(diagnostics, path, &raw.team);
        let strategy = self.strategy(diagnostics, path, raw.strategy.as_ref(), team);
        let spawn_path = format!("{path}.spawn");
        let start_position = raw
            .spawn
            .as_ref()
            .zip(self.field)
            .and_then(|(spawn, field)| {
                start_position::somewhere(
                    diagnostics,
                    self.document,
                    &spawn_path,
                    spawn,
                    raw.count,
                    field,
                )
            });
        let pattern = raw
            .name
            .clone()
            .unwrap_or_else(|| format!("{}_{{}}", raw.team));
        let boat = self.boat(
            diagnostics,
            path,
            raw.boat.as_ref(),
            &pattern.replace("{}", "1"),
        );
        let (Some(team), Some(boat), Some(strategy)) = (team, boat, strategy) else {
            return;
        };
        let place = self.document.at(path);
        let name_path = format!("{path}.name");
        let name_place = self.document.at(&name_path);
        if !pattern.contains("{}") {
            diagnostics.note(
                name_place,
                format!("name is {pattern:?}, expected {{}} in place of the number"),
            );
            return;
        }
        if !self.document.is_sound(&format!("{path}.count"))
            || !is_room(diagnostics, place, self.entries.len() + raw.count)
        {
            return;
        }
        for number in 1..=raw.count {
            let name = pattern.replace("{}", &number.to_string());
            if !self.is_new_name(diagnostics, name_place, &name) {
                return;
            }
            let boat = match number {
                1 => Some(boat),
                _ => self.boat(diagnostics, path, raw.boat.as_ref(), &name),
            };
            let (Some(boat), start_position) = (boat, start_position.clone()) else {
                return;
            };
            let heading_deg = None;
            let source = Source::Simulated;
            self.entries.push(Entry {
                name,
                place,
                team,
                boat,
                strategy,
                start_position,
                heading_deg,
                source,
            });
        }
    }

    fn is_new_name(&mut self, diagnostics: &mut Diagnostics, place: usize, name: &str) -> bool {
        if !is_name(name) {
            return diagnostics.is_name(place, "name", name);
        }
        let is_new = self.names.insert(name.to_owned());
        if !is_new {
            diagnostics.note(
                place,
                format!("name {name:?} is used twice, expected a unique name for each vehicle"),
            );
        }
        is_new
    }

    /// The team of the vehicle or fleet at `path`.
    fn team(&self, diagnostics: &mut Diagnostics, path: &str, name: &str) -> Option<TeamId> {
        let path = format!("{path}.team");
        let teams = &self.document.raw.team;
        let index = teams.iter().position(|team| team.name.0 == name);
        if index.is_none() && self.document.is_sound(&path) {
            let names = teams
                .iter()
                .map(|team| team.name.0.as_str())
                .collect::<Vec<_>>()
                .join(", ");
            diagnostics.note_if_intact(
                self.document.at(&path),
                format!("team is {name:?}, expected one of {names}"),
            );
        }
        index.map(|index| TeamId(index as u8))
    }

    /// The boat of the vehicle `name` at `path`.
    fn boat(
        &mut self,
        diagnostics: &mut Diagnostics,
        path: &str,
        given: Option<&raw::FilePath>,
        name: &str,
    ) -> Option<usize> {
        let own_path = format!("{path}.boat");
        let (given, path) = match (given, &self.document.raw.boat) {
            (Some(given), _) => (given, own_path.as_str()),
            (None, Some(given)) => (given, "boat"),
            (None, None) => {
                self.document.note_missing(
                    diagnostics,
                    &own_path,
                    "the path of a boat file here or for the game",
                );
                return None;
            }
        };
        self.boats
            .index(diagnostics, &given.0, self.document.at(path), name)
    }

    /// The strategy of the vehicle or fleet at `path`.
    fn strategy(
        &mut self,
        diagnostics: &mut Diagnostics,
        path: &str,
        given: Option<&raw::FilePath>,
        team: Option<TeamId>,
    ) -> Option<usize> {
        let path = format!("{path}.strategy");
        let is_replaced = |diagnostics: &Diagnostics, team: Option<TeamId>| {
            let name = team.map(|team| &self.document.raw.team[team.index()].name.0);
            name.is_some_and(|name| diagnostics.overrides.strategies.contains_key(name))
        };
        let given = given.filter(|_| !is_replaced(diagnostics, team));
        if let (Some(given), true) = (given, diagnostics.overrides.exchange_strategies) {
            let message = format!(
                "strategy is {}, expected none here because the teams exchange strategies",
                given.0
            );
            diagnostics.note(self.document.at(&path), message);
            return None;
        }
        let team = team.map(|team| self.whose_strategy(diagnostics, team));
        let owner = team.map_or("", |team| {
            diagnostics
                .overrides
                .owner_of_strategy(&self.document.raw.team[team.index()].name.0)
        });
        let is_replaced = is_replaced(diagnostics, team);
        let states_one = |team: TeamId| self.document.raw.team[team.index()].strategy.is_some();
        match (given, team) {
            (Some(given), _) => self.strategies.index(
                diagnostics,
                &strategy_path(&given.0),
                self.document.at(&path),
                owner,
            ),
            (None, Some(team)) if is_replaced || states_one(team) => {
                self.strategy_of_team(diagnostics, team.index())
            }
            (None, Some(_)) => {
                self.document.note_missing(
                    diagnostics,
                    &path,
                    "the path of a strategy file here or for the team",
                );
                None
            }
            (None, None) => None,
        }
    }

    /// The team whose strategy the boats of a team follow.
    fn whose_strategy(&self, diagnostics: &Diagnostics, team: TeamId) -> TeamId {
        let is_exchanged =
            diagnostics.overrides.exchange_strategies && self.document.raw.team.len() == 2;
        if is_exchanged {
            TeamId(1 - team.0)
        } else {
            team
        }
    }

    /// The strategy of a team's file, or its override.
    fn strategy_of_team(&mut self, diagnostics: &mut Diagnostics, team: usize) -> Option<usize> {
        let raw::Team { name, strategy } = &self.document.raw.team[team];
        let owner = diagnostics.overrides.owner_of_strategy(&name.0);
        if let Some(path) = diagnostics.overrides.strategies.get(&name.0).cloned() {
            return self.strategies.index_at(diagnostics, &path, None, owner);
        }
        let place = self.document.at(&format!("team.{team}.strategy"));
        self.strategies.index(
            diagnostics,
            &strategy_path(&strategy.as_ref()?.0),
            place,
            owner,
        )
    }
}

/// Whether a game may have this many vehicles.
fn is_room(diagnostics: &mut Diagnostics, place: usize, total: usize) -> bool {
    if total > VEHICLES_MAX {
        diagnostics.note(
            place,
            format!("there are {total} vehicles up to this one, expected at most {VEHICLES_MAX}"),
        );
    }
    total <= VEHICLES_MAX
}

/// The path of a strategy given by path, or by name in the folder of strategies.
fn strategy_path(given: &str) -> String {
    let is_name = !given.contains(['/', '\\', '.']);
    if is_name {
        format!("../{}/{given}.toml", Kind::STRATEGY.folder())
    } else {
        given.to_owned()
    }
}
