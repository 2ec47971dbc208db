//! Checks a game file and the files it refers to.

use super::boat::{FASTEST_PER_TICK, fastest_decay};
use super::file_cache::FileCache;
use super::rules::keepout_faults;
use super::start_position;
use crate::boat::Boat;
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
    /// Its path in the file.
    pub(super) path: String,
    pub(super) team: TeamId,
    pub(super) boat: usize,
    strategy: usize,
    /// The start position in its file; `None` means on the team's line.
    pub(super) start_position: Option<StartPosition>,
    pub(super) heading_deg: Option<f64>,
    joins_s: f64,
    source: Source,
}

/// The vehicles so far, and the files that they refer to.
struct Fleet<'a> {
    document: &'a Document<'a, raw::Game>,
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

    fn check(document: &Document<raw::Game>) -> Option<Scenario> {
        let raw = &document.raw;
        let field = document.referenced::<Field>("field", &raw.field.0);
        let rules = document.referenced::<Rules>("rules", &raw.rules.0);
        let sea = sea(document);
        let (tick, ticks_per_decision) = clock(document);
        check_teams(document);
        let mut fleet = Fleet {
            document,
            field: field.as_ref(),
            boats: FileCache::new(),
            strategies: FileCache::new(),
            names: BTreeSet::new(),
            entries: vec![],
        };
        fleet.fill();
        check_tick(document, tick, &fleet.boats.items);
        check_looks(document, tick, rules.as_ref());
        check_reseed(document);
        check_flags(document, field.as_ref(), rules.as_ref());
        let Fleet {
            boats,
            strategies,
            entries,
            ..
        } = fleet;
        let field = field?;
        let mut rules = rules?;
        let sea = sea?;
        if !document.is_faultless() {
            return None;
        }
        let start_positions = start_position::all(&entries, &field);
        start_position::check_clear(document, &entries, &start_positions, &boats.items, &field);
        check_models(document, &entries, &strategies.items);
        check_duration(document);
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
                joins: SimTime::from_s(entry.joins_s),
                source: entry.source,
            });
        let vehicles: Vec<Vehicle> = vehicles.collect();
        let faults = super::fault::faults(document, &vehicles, &boats.items);
        let link = link(document, &field);
        let teams = raw.team.iter().map(|team| team.name.0.clone());
        let teams = teams.map(|name| Team { name }).collect();
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
            teams,
            boats: boats.items,
            strategies: strategies.items,
            vehicles,
            faults,
            drawn: vec![],
            recipe: None,
        };
        if let Err(problem) = scenario.check_sizes() {
            document.note("team", problem);
        }
        document.is_faultless().then_some(scenario)
    }

    fn load(path: &Path) -> Result<Scenario, Problems> {
        crate::load(path)
    }
}

/// The radio links; the station is at the centre of the field unless the file gives its position.
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

/// Reports a time-limit setting that the game's own duration overrides.
fn check_duration(document: &Document<raw::Game>) {
    let mut settings = document.loader.overrides.settings.iter();
    if document.raw.duration_s.is_some()
        && settings.any(|setting| setting.key == "rules.time_limit_s")
    {
        let message =
            "duration_s of the game overrides rules.time_limit_s; set game.duration_s instead";
        document.note("duration_s", message);
    }
}

/// Checks the flags' own radii together with those of the rules.
fn check_flags(document: &Document<raw::Game>, field: Option<&Field>, rules: Option<&Rules>) {
    let Some((field, rules)) = field.zip(rules) else {
        return;
    };
    let special = field.flags.iter().enumerate();
    for (i, flag) in special.filter(|(_, flag)| !flag.settings.is_empty()) {
        for fault in keepout_faults(rules, rules.radii_of(flag)) {
            document.note(
                "field",
                format!("flag {i} of field {}: {fault}", field.plan.name),
            );
        }
    }
}

/// Checks that reseeds are in ascending order.
fn check_reseed(document: &Document<raw::Game>) {
    for (i, [last, next]) in document.raw.reseed.array_windows().enumerate() {
        if next.after_s <= last.after_s {
            let message = format!(
                "after_s is {}, expected more than {} of the previous entry",
                next.after_s, last.after_s
            );
            document.note(&format!("reseed.{}", i + 1), message);
        }
    }
}

/// The game's sea, or its override.
fn sea(document: &Document<raw::Game>) -> Option<Sea> {
    let loader = document.loader;
    match (&loader.overrides.sea, &document.raw.sea) {
        (Some(path), _) => loader.read(path, None, Sea::NAME),
        (None, Some(given)) => document.referenced("sea", &given.0),
        (None, None) if loader.overrides.has_settings(Sea::NAME) => {
            let path = Path::new("at_rest.toml");
            let text = "water_density_kg_m3 = 1000";
            Sea::check(&read::document_of_text(loader, Kind::SEA, path, text)?)
        }
        (None, None) => Some(Sea::at_rest()),
    }
}

/// The physics tick, and the number of ticks per decision.
fn clock(document: &Document<raw::Game>) -> (SimTime, u32) {
    let raw::Game {
        tick_s, decision_s, ..
    } = document.raw;
    let tick = SimTime::from_s(tick_s);
    let decision = SimTime::from_s(decision_s);
    if decision.0 % tick.0 != 0 {
        let given = document.has("decision_s");
        document.note(
            if given { "decision_s" } else { "tick_s" },
            format!("decision_s is {decision_s}, expected a multiple of tick_s, {tick_s}"),
        );
    }
    (tick, (decision.0 / tick.0) as u32)
}

/// Checks the tick: a boat that is stable at the default tick may be unstable at a longer one.
fn check_tick(document: &Document<raw::Game>, tick: SimTime, boats: &[Boat]) {
    for boat in boats.iter().filter(|_| document.has("tick_s")) {
        let (motion, rate_per_s) = fastest_decay(boat);
        if rate_per_s * tick.as_s() > FASTEST_PER_TICK {
            let message = format!(
                "tick_s is {}, expected at most {:.4}: the {motion} of boat {} decays at {rate_per_s:.1} 1/s",
                document.raw.tick_s,
                FASTEST_PER_TICK / rate_per_s,
                boat.name
            );
            document.note("tick_s", message);
        }
    }
}

/// Checks that the referee's checks fall on whole ticks.
fn check_looks(document: &Document<raw::Game>, tick: SimTime, rules: Option<&Rules>) {
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
            document.note("rules", message);
        }
    }
}

/// Checks that models fit the team sizes: the number of inputs is fixed unless they have spare
/// slots.
fn check_models(document: &Document<raw::Game>, entries: &[Entry], strategies: &[Strategy]) {
    for Entry {
        name,
        path,
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
                    "the model {} has {takes} inputs, expected {size}: {name} has {mates} teammates and {enemies} enemies",
                    model.name
                );
                document.note(path, message);
            }
        }
    }
}

fn check_teams(document: &Document<raw::Game>) {
    let teams = document.raw.team.iter();
    let teams: Vec<&str> = teams.map(|team| team.name.0.as_str()).collect();
    for (i, name) in teams.iter().enumerate() {
        if !name.is_empty() && teams[..i].contains(name) {
            document.note(
                &format!("team.{i}.name"),
                format!("name {name:?} is used twice, expected a unique name for each team"),
            );
        }
    }
    let is_unknown = |team: &&str| !teams.contains(team);
    let overrides = &document.loader.overrides;
    let names = teams.join(", ");
    let mut replaced = overrides.strategies.keys().map(String::as_str);
    let replaced = replaced.find(is_unknown).map(|team| {
        let option = PathBuf::from(format!("--strategy {team}"));
        let message = format!("unknown team {team:?}, expected one of {names}");
        (option, message)
    });
    let unknown = replaced.or_else(|| {
        let mut settings = overrides.settings.iter();
        let changed = settings.find(|setting| setting.team().as_ref().is_some_and(is_unknown))?;
        let message = format!(
            "{}: unknown team, expected one of {names} after strategy",
            changed.key
        );
        Some((changed.path.clone(), message))
    });
    let diagnostics = &document.loader.diagnostics;
    let is_broken = || diagnostics.sources.borrow().is_broken_file(document.at(""));
    if let Some((path, message)) = unknown.filter(|_| !is_broken()) {
        diagnostics.note_file(path, message);
    }
}

impl Fleet<'_> {
    fn fill(&mut self) {
        let document = self.document;
        for (i, vehicle) in document.raw.vehicle.iter().enumerate() {
            self.add_vehicle(&format!("vehicle.{i}"), vehicle);
        }
        for (i, fleet) in document.raw.fleet.iter().enumerate() {
            self.add_fleet(&format!("fleet.{i}"), fleet);
        }
        if document.raw.vehicle.is_empty()
            && document.raw.fleet.is_empty()
            && document.is_sound("vehicle")
        {
            let message = "vehicle is missing, expected at least one [[vehicle]] or [[fleet]]";
            document.note_if_intact("", message);
        }
        // The teams' strategies are checked even if no boat follows them.
        let followed = self.strategies.items.len();
        for i in 0..document.raw.team.len() {
            self.strategy_of_team(i);
        }
        self.strategies.items.truncate(followed);
    }

    fn add_vehicle(&mut self, path: &str, raw: &raw::Vehicle) {
        let document = self.document;
        let team = self.team(path, &raw.team);
        let boat = self.boat(path, raw.boat.as_ref(), &raw.name.0);
        let strategy = self.strategy(path, raw.strategy.as_ref(), team);
        let stated = team
            .zip(self.field)
            .map(|(team, field)| start_position::stated(document, path, raw, team, field));
        let name_path = format!("{path}.name");
        if document.is_sound(&name_path)
            && self.is_new_name(&name_path, &raw.name.0)
            && self.is_room(path, 1)
            && let (Some(team), Some(boat), Some(strategy)) = (team, boat, strategy)
        {
            let is_simulated = document.loader.overrides.simulate_all;
            let at = raw.at.as_ref().map(|_| format!("{path}.at"));
            self.entries.push(Entry {
                name: raw.name.0.clone(),
                path: at.unwrap_or_else(|| path.to_owned()),
                team,
                boat,
                strategy,
                start_position: stated.flatten(),
                heading_deg: raw.heading_deg,
                joins_s: raw.joins_s,
                source: if is_simulated {
                    Source::Simulated
                } else {
                    raw.source
                },
            });
        }
    }

    fn add_fleet(&mut self, path: &str, raw: &raw::Fleet) {
        let document = self.document;
        let team = self.team(path, &raw.team);
        let strategy = self.strategy(path, raw.strategy.as_ref(), team);
        let spawn = raw.spawn.as_ref().zip(self.field);
        let start_position = spawn.and_then(|(spawn, field)| {
            let path = format!("{path}.spawn");
            start_position::somewhere(document, &path, spawn, raw.count, field)
        });
        let usual = || format!("{}_{{}}", raw.team);
        let pattern = raw.name.clone().unwrap_or_else(usual);
        let boat = self.boat(path, raw.boat.as_ref(), &pattern.replace("{}", "1"));
        let (Some(team), Some(first), Some(strategy)) = (team, boat, strategy) else {
            return;
        };
        let name_path = format!("{path}.name");
        if !pattern.contains("{}") {
            let message = format!("name is {pattern:?}, expected {{}} in place of the number");
            document.note(&name_path, message);
            return;
        }
        if !document.is_sound(&format!("{path}.count")) || !self.is_room(path, raw.count) {
            return;
        }
        for number in 1..=raw.count {
            let name = pattern.replace("{}", &number.to_string());
            if !self.is_new_name(&name_path, &name) {
                return;
            }
            let boat = match number {
                1 => Some(first),
                _ => self.boat(path, raw.boat.as_ref(), &name),
            };
            let Some(boat) = boat else { return };
            self.entries.push(Entry {
                name,
                path: path.to_owned(),
                team,
                boat,
                strategy,
                start_position: start_position.clone(),
                heading_deg: None,
                joins_s: raw.joins_s,
                source: Source::Simulated,
            });
        }
    }

    fn is_new_name(&mut self, path: &str, name: &str) -> bool {
        if !self.document.is_name(path, "name", name) {
            return false;
        }
        let is_new = self.names.insert(name.to_owned());
        if !is_new {
            let message =
                format!("name {name:?} is used twice, expected a unique name for each vehicle");
            self.document.note(path, message);
        }
        is_new
    }

    /// Whether there is room for `count` more vehicles, given at `path`; reports it if not.
    fn is_room(&self, path: &str, count: usize) -> bool {
        let total = self.entries.len() + count;
        if total > VEHICLES_MAX {
            let message = format!(
                "{total} vehicles up to and including this one, expected at most {VEHICLES_MAX}"
            );
            self.document.note(path, message);
        }
        total <= VEHICLES_MAX
    }

    /// The team of the vehicle or fleet at `path`.
    fn team(&self, path: &str, name: &str) -> Option<TeamId> {
        let path = format!("{path}.team");
        let teams = &self.document.raw.team;
        let index = teams.iter().position(|team| team.name.0 == name);
        if index.is_none() && self.document.is_sound(&path) {
            let names: Vec<&str> = teams.iter().map(|team| team.name.0.as_str()).collect();
            let message = format!("team is {name:?}, expected one of {}", names.join(", "));
            self.document.note_if_intact(&path, message);
        }
        index.map(|index| TeamId(index as u8))
    }

    /// The boat of the vehicle `name` at `path`.
    fn boat(&mut self, path: &str, given: Option<&raw::FilePath>, name: &str) -> Option<usize> {
        let document = self.document;
        let own_path = format!("{path}.boat");
        let (given, path) = match (given, &document.raw.boat) {
            (Some(given), _) => (given, own_path.as_str()),
            (None, Some(given)) => (given, "boat"),
            (None, None) => {
                let expected = "the path of a boat file here or for the game";
                document.note_missing(&own_path, expected);
                return None;
            }
        };
        self.boats.index(document, path, &given.0, name)
    }

    /// The strategy of the vehicle or fleet at `path`.
    fn strategy(
        &mut self,
        path: &str,
        given: Option<&raw::FilePath>,
        team: Option<TeamId>,
    ) -> Option<usize> {
        let document = self.document;
        let overrides = &document.loader.overrides;
        let path = format!("{path}.strategy");
        let name_of = |team: TeamId| &document.raw.team[team.index()].name.0;
        let is_replaced = |team: Option<TeamId>| {
            team.is_some_and(|team| overrides.strategies.contains_key(name_of(team)))
        };
        let given = given.filter(|_| !is_replaced(team));
        if let (Some(given), true) = (given, overrides.exchange_strategies) {
            let message = format!(
                "strategy is {}, expected none here because the teams exchange strategies",
                given.0
            );
            document.note(&path, message);
            return None;
        }
        // The team whose strategy this team's boats follow.
        let is_exchanged = overrides.exchange_strategies && document.raw.team.len() == 2;
        let other = |team: TeamId| TeamId(1 - team.0);
        let team = team.map(|team| if is_exchanged { other(team) } else { team });
        let owner = team.map_or("", |team| overrides.owner_of_strategy(name_of(team)));
        let states_one = |team: TeamId| document.raw.team[team.index()].strategy.is_some();
        match (given, team) {
            (Some(given), _) => {
                let given = strategy_path(&given.0);
                self.strategies.index(document, &path, &given, owner)
            }
            (None, Some(owner)) if is_replaced(team) || states_one(owner) => {
                self.strategy_of_team(owner.index())
            }
            (None, Some(_)) => {
                let expected = "the path of a strategy file here or for the team";
                document.note_missing(&path, expected);
                None
            }
            (None, None) => None,
        }
    }

    /// The strategy of a team's file, or its override.
    fn strategy_of_team(&mut self, team: usize) -> Option<usize> {
        let document = self.document;
        let raw::Team { name, strategy } = &document.raw.team[team];
        let overrides = &document.loader.overrides;
        let owner = overrides.owner_of_strategy(&name.0);
        if let Some(file) = overrides.strategies.get(&name.0) {
            return self.strategies.index_at(document, file, None, owner);
        }
        let given = strategy_path(&strategy.as_ref()?.0);
        let path = format!("team.{team}.strategy");
        self.strategies.index(document, &path, &given, owner)
    }
}

/// The path of a strategy given by path, or by its name in the folder of strategies.
fn strategy_path(given: &str) -> String {
    let is_name = !given.contains(['/', '\\', '.']);
    if is_name {
        format!("../{}/{given}.toml", Kind::STRATEGY.folder())
    } else {
        given.to_owned()
    }
}
