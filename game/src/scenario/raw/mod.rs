//! Scenario files as people type them: degrees, relative paths, and most of it optional.
//!
//! The doc comments here are the descriptions in the JSON Schemas, so they are written for people who
//! write files. `check` turns these types into those the program believes.

mod boat;
mod field;
mod game;
mod rules;
mod sea;
mod strategy;

pub(super) use boat::{RawAutopilot, RawBoat, RawHull, RawPropeller, RawThruster};
pub(super) use field::{RawField, RawObstacle, RawSide, RawWalls};
pub(super) use game::{RawFleet, RawGame, RawSpawn, RawVehicle, Whereabouts};
pub(super) use rules::RawRules;
pub(super) use sea::RawSea;
pub(super) use strategy::RawStrategy;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use toml::Spanned;

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

/// Two numbers, no more and no fewer.
#[derive(Clone, Copy, Debug, JsonSchema)]
#[schemars(inline)]
pub(super) struct Pair(pub(super) [f64; 2]);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Pair, D::Error> {
        // Arrays proper let surplus numbers pass in silence.
        let numbers = Vec::<f64>::deserialize(deserializer)?;
        let wrong = |numbers: Vec<f64>| D::Error::invalid_length(numbers.len(), &"a pair of numbers [a, b]");
        numbers.try_into().map(Pair).map_err(wrong)
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
