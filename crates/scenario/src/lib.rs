//! The definition of a game: read from TOML files, and checked once.
//!
//! [`Scenario`] is the checked form, in SI and radians, and is sent to every process that joins the
//! game. [`load`] creates it. Its types and those in `raw` declare the keys of files, and `schema`
//! generates their JSON Schemas. `read` finds the files and merges them with their bases,
//! `validate` reads them by their schema, and `check` converts them to the checked types. A
//! `Loader` is the context for reading one game; its `diagnostics` collect every [`Problem`].

pub mod action;
pub mod boat;
mod built_in;
mod chance;
mod check;
mod diagnostics;
mod digest;
mod draw;
pub mod entry;
pub mod fault;
mod field_value;
mod files;
mod guess;
pub mod keys;
mod kind;
pub mod link;
mod load;
mod loader;
pub mod observation;
pub mod outcome;
mod overrides;
pub mod policy;
mod problem;
mod raw;
mod read;
mod real_boats;
mod reference;
mod schema;
pub mod sea;
pub mod sensor;
mod setting;
mod size;
mod source;
pub mod strategy;
mod syntax;
mod tree;
mod unit;
mod validate;

pub use boat::Boat;
pub use built_in::{BuiltIn, OnOverride, argument_for, built_in, set_built_in};
pub use check::{check_corners, check_thrust_map};
pub use digest::digest_of;
pub use draw::{Drawn, Recipe};
pub use files::Files;
pub use guess::did_you_mean;
pub use kind::{Kind, ScenarioFile};
pub use load::{
    check_file, check_variants, default_of, draw_file, load, load_file, load_with, load_with_files,
    other_kind,
};
pub use outcome::Outcome;
pub use overrides::Overrides;
pub use problem::{Problem, Problems};
pub use read::Document;
pub use real_boats::RealBoats;
pub use reference::{file_reference, meaning, reference};
pub use schema::schema;
pub use setting::Setting;
pub use source::tidied as tidied_path;

use crate::fault::Fault;
use crate::link::Link;
use crate::sea::Sea;
use crate::strategy::Strategy;
use primitives::frame::Pose;
use primitives::id::{TeamId, VehicleId};
use primitives::reseed::{Reseed, Seeds};
use primitives::time::SimTime;
use rules::field::Field;
use rules::{Event, Rules};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A game, ready to be played.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scenario {
    /// The game file's stem.
    pub name: String,
    /// Random seed; each seed gives a different game. `--seed` overrides it.
    pub seed: u64,
    /// Later seeds that replace `seed` during the game, by ascending time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reseed: Vec<Reseed>,
    /// Physics tick.
    pub tick: SimTime,
    /// Physics ticks per decision of a mind.
    pub ticks_per_decision: u32,
    /// Lockstep: wall-clock time that the sim waits for a mind before treating it as lost, s.
    pub patience_s: f64,
    /// In real-time games: maximum age of an order, in simulated seconds, before the boat holds.
    pub order_ttl_s: f64,
    /// The field of play.
    pub field: Field,
    /// The rules of the game.
    pub rules: Rules,
    /// The sea.
    pub sea: Sea,
    /// The radio links between minds and boats; `None` means no delay and no loss.
    pub link: Option<Link>,
    /// Faults during the game.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<Fault>,
    /// The opposing teams.
    pub teams: Vec<Team>,
    /// The kinds of boat in the game.
    pub boats: Vec<Boat>,
    /// The strategies in the game.
    pub strategies: Vec<Strategy>,
    /// The vehicles, in processing order.
    pub vehicles: Vec<Vehicle>,
    /// Numbers drawn for this game.
    pub drawn: Vec<Drawn>,
    /// The data for redrawing the numbers, if there are any.
    pub recipe: Option<Recipe>,
}

impl Scenario {
    /// The vehicle with this name.
    pub fn vehicle_by_name(&self, name: &str) -> Option<VehicleId> {
        let mut vehicles = self.vehicles.iter();
        let index = vehicles.position(|vehicle| vehicle.name == name);
        index.map(VehicleId::at)
    }

    /// The vehicle with a name given by a user.
    ///
    /// # Errors
    /// [`UnknownVehicle`] with the existing names.
    pub fn vehicle_named(&self, name: &str) -> Result<VehicleId, UnknownVehicle> {
        self.vehicle_by_name(name).ok_or_else(|| {
            let known = self.vehicles.iter().map(|vehicle| vehicle.name.clone());
            UnknownVehicle {
                name: name.to_owned(),
                known: known.collect(),
            }
        })
    }

    /// Checks that all references are valid, all names are well-formed and all sizes are within
    /// limits. Scenarios loaded from files satisfy this; those from other sources may not.
    ///
    /// # Errors
    /// The first violation, as a string.
    pub fn check_received(&self) -> Result<(), String> {
        let within = |what: &str, index: usize, count: usize| {
            if index < count {
                Ok(())
            } else {
                Err(format!("{what} is {index}, expected less than {count}"))
            }
        };
        let teams = self.teams.iter().map(|team| &team.name);
        let vehicles = self.vehicles.iter().map(|vehicle| &vehicle.name);
        let mut names = vehicles.chain(teams);
        if let Some(name) = names.find(|name| !diagnostics::is_name(name)) {
            return Err(format!("{name:?} is not a valid name of a vehicle or team"));
        }
        let (teams, strategies) = (self.teams.len(), self.strategies.len());
        for vehicle in &self.vehicles {
            let of = |what: &str| format!("the {what} of {}", vehicle.name);
            within(&of("team"), vehicle.team.index(), teams)?;
            within(&of("boat"), vehicle.boat, self.boats.len())?;
            within(&of("strategy"), vehicle.strategy, strategies)?;
        }
        for (i, flag) in self.field.flags.iter().enumerate() {
            within(&format!("the team of flag {i}"), flag.team.index(), teams)?;
        }
        self.check_sizes()
    }

    /// Whether everything that an event refers to exists in the game. An event from another process
    /// may refer to something else.
    pub fn has(&self, event: Event) -> bool {
        let flag = event.flag();
        let team = match event {
            Event::Ended { winner } => winner,
            _ => None,
        };
        let mut vehicles = [event.vehicle(), event.other()].into_iter().flatten();
        vehicles.all(|vehicle| vehicle.index() < self.vehicles.len())
            && flag.is_none_or(|flag| flag.index() < self.field.flags.len())
            && team.is_none_or(|team| team.index() < self.teams.len())
    }

    /// The simulated time from one decision to the next.
    pub fn decision(&self) -> SimTime {
        self.tick * i64::from(self.ticks_per_decision)
    }

    /// The seeds of randomness during this game.
    pub fn seeds(&self) -> Seeds {
        Seeds::new(self.seed, &self.reseed)
    }

    /// The team of a vehicle.
    pub fn team_of(&self, vehicle: VehicleId) -> TeamId {
        self.vehicles[vehicle.index()].team
    }

    /// The numbers of teammates and enemies of a vehicle.
    pub fn sides_of(&self, vehicle: VehicleId) -> (usize, usize) {
        let team = self.team_of(vehicle);
        let fellows = self.vehicles.iter().filter(|other| other.team == team);
        let mates = fellows.count() - 1;
        (mates, self.vehicles.len() - 1 - mates)
    }

    /// The boat of a vehicle.
    pub fn boat_of(&self, vehicle: VehicleId) -> &Boat {
        &self.boats[self.vehicles[vehicle.index()].boat]
    }

    /// The strategy that a vehicle follows.
    pub fn strategy_of(&self, vehicle: VehicleId) -> &Strategy {
        &self.strategies[self.vehicles[vehicle.index()].strategy]
    }
}

/// A name that no vehicle of the game has.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("no vehicle named {name:?}; the vehicles are: {}", .known.join(", "))]
pub struct UnknownVehicle {
    /// The name.
    pub name: String,
    /// The existing names.
    pub known: Vec<String>,
}

/// A team.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Team {
    /// Its name, for example `blue`.
    pub name: String,
}

/// A boat that takes part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Vehicle {
    /// Its name, unique in the game.
    pub name: String,
    /// Its team.
    pub team: TeamId,
    /// Index into [`Scenario::boats`].
    pub boat: usize,
    /// Index into [`Scenario::strategies`].
    pub strategy: usize,
    /// Start position. Older recordings call this field `berth`.
    #[serde(alias = "berth")]
    pub start_position: StartPosition,
    /// Time at which it joins the game.
    #[serde(default)]
    pub joins: SimTime,
    /// The source of its motion.
    pub source: Source,
}

/// The source of a vehicle's motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Source {
    /// Simulation in the scenario's sea.
    #[default]
    #[serde(alias = "Simulated")]
    Simulated,
    /// A real boat: its gateway reports its position. The game then runs in real time.
    #[serde(alias = "External")]
    External,
}

/// A start position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum StartPosition {
    /// A fixed pose.
    At(Pose),
    /// A random position in a rectangle of the field, from the game's `spawn` stream, facing the
    /// opponent's end.
    Somewhere {
        /// Bounds along the field, m from the team's own end.
        along_m: (f64, f64),
        /// Bounds across the field, m from the port edge as seen from the team's own end. For the
        /// first team, this is the edge between corners 1 and 2 (so `across_m` of `Field::at` is
        /// the field's depth minus this distance); for the second, the edge between corners 0 and 3
        /// (`across_m` is this distance).
        across_m: (f64, f64),
        /// Minimum distance to other vehicles and obstacles, m.
        gap_m: f64,
    },
}
