//! Scenario files as people type them: degrees and relative paths. Every key is declared here, and only here; how, is
//! told in `schema`.
//!
//! The doc comments are the descriptions in the JSON Schemas and the reference, so they are written for people who
//! write files. Where units do not differ, a type of the checked scenario stands for itself. `check` turns these types
//! into those the program believes.

mod boat;
mod field;
mod game;
mod gateway;
mod kinematic;
mod link;
mod rules;
mod sea;
mod sensor;
mod strategy;
mod tournament;

pub(super) use boat::{Boat, SettingAndThrust, Thruster};
pub(super) use field::{Circle, Field, Flag, Obstacle, Side};
pub(super) use game::{Fleet, Game, Spawn, Team, Vehicle};
pub(super) use gateway::Gateway;
pub(super) use kinematic::{Kinematic, ThrustAndSpeed};
pub(super) use link::{Link, Sharing};
pub(super) use rules::Rules;
pub(super) use sea::{Current, Eddy, Gusts, Sea, Spectrum, Spreading, Waves, Wind};
pub(super) use sensor::{Compass, Fault, Gps, Imu};
pub(super) use strategy::{
    Amount, COMMON_KEYS, Given, RawAttractor, RawAvoidCollision, RawAvoidObstacle, RawBehaviour, RawBehaviours,
    RawCommon, RawConstantHeading, RawConstantSpeed, RawCutRange, RawEllipse, RawHelm, RawIntercept, RawLoiter,
    RawMaxSpeed, RawMemoryTurnLimit, RawMode, RawOpRegion, RawPolicy, RawRule, RawSet, RawShield, RawStationKeep,
    RawStrategy, RawTask, RawTrail, RawVariable, RawWaypoint, Stated, keys_of, kinds,
};
pub(super) use tournament::{Entry, Tournament};

use super::Kind;
use super::diagnostics::{Diagnostics, NAME_PATTERN};
use super::read::Declared;
use super::strategy_read::Typed;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::fmt;
use toml::Spanned;
use toml::de::DeValue;

/// The path of another file, relative to the one it stands in. Empty where it was wrong or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("minLength" = 1, "x-expected" = "the path of a file"))]
pub(super) struct FilePath(pub(super) String);

/// A name. Empty where it was wrong or missing.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[schemars(inline, extend("pattern" = NAME_PATTERN))]
pub(super) struct Name(pub(super) String);

/// A position, or the name of one.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "[x, y] or the name of a point such as \"CH\""))]
pub(super) enum Position {
    /// [x east, y north] in metres from the datum.
    At(#[schemars(inner(range(min = -1000000, max = 1000000)))] [f64; 2]),
    /// A named point of the own team.
    Point(String),
}

impl Declared for Game {
    const KIND: Kind = Kind::Game;
}

impl Declared for Field {
    const KIND: Kind = Kind::Field;
}

impl Declared for Rules {
    const KIND: Kind = Kind::Rules;
}

impl Declared for Boat {
    const KIND: Kind = Kind::Boat;
}

impl Declared for Sea {
    const KIND: Kind = Kind::Sea;
}

impl Declared for Tournament {
    const KIND: Kind = Kind::Tournament;
}

impl Declared for Gateway {
    const KIND: Kind = Kind::Gateway;
}

// What follows is for strategy files, as long as they are read by `strategy_read`.

/// A value and where it stands in the virtual text of all files.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<T> {
    pub(super) value: T,
    pub(super) at: usize,
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<At<T>, D::Error> {
        let spanned = Spanned::<T>::deserialize(deserializer)?;
        Ok(At { at: spanned.span().start, value: spanned.into_inner() })
    }
}

/// In a schema the place does not show.
impl<T: JsonSchema> JsonSchema for At<T> {
    fn inline_schema() -> bool {
        T::inline_schema()
    }
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn schema_id() -> Cow<'static, str> {
        T::schema_id()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
}

impl Typed for RawStrategy {
    const APART: Option<&'static str> = Some("behaviour");
    const OWN: &'static [&'static str] = &["unsafe_i_know", "unsafe_because"];

    fn put_apart(&mut self, diagnostics: &mut Diagnostics, value: Spanned<DeValue<'_>>) {
        self.behaviour = RawBehaviours::of(diagnostics, value);
    }
}

/// A position, or the name of one.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged, inline)]
pub(super) enum Whereabouts {
    /// [x east, y north] in metres from the datum.
    Position([f64; 2]),
    /// A named point of the own team.
    Point(String),
}

impl<'de> Deserialize<'de> for Whereabouts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Whereabouts, D::Error> {
        deserializer.deserialize_any(WhereaboutsVisitor)
    }
}

struct WhereaboutsVisitor;

impl<'de> Visitor<'de> for WhereaboutsVisitor {
    type Value = Whereabouts;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[x, y] or the name of a point such as \"CH\"")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Whereabouts, E> {
        Ok(Whereabouts::Point(name.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Whereabouts, A::Error> {
        let mut numbers = [0.0; 2];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = seq.next_element()?.ok_or_else(|| serde::de::Error::invalid_length(i, &self))?;
        }
        match seq.next_element::<f64>()? {
            None => Ok(Whereabouts::Position(numbers)),
            Some(_) => Err(serde::de::Error::invalid_length(3, &self)),
        }
    }
}
