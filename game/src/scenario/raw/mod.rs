//! Scenario files as people type them: degrees, relative paths, and most of it optional.
//!
//! The doc comments here are the descriptions in the JSON Schemas, so they are written for people who
//! write files. `check` turns these types into those the program believes.

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

pub(super) use boat::{RawAutopilot, RawBattery, RawBoat, RawHull, RawPropeller, RawThruster, RawVentilation};
pub(super) use field::{RawField, RawObstacle, RawSide, RawWalls};
pub(super) use game::{RawFleet, RawGame, RawSource, RawSpawn, RawVehicle, Whereabouts};
pub(super) use gateway::{
    RawBatteryWatch, RawControlWatch, RawGateway, RawGeofence, RawHalt, RawLimits, RawLoops, RawNavWatch,
};
pub(super) use kinematic::{RawKinematic, RawPid};
pub(super) use link::{RawLink, RawLoss, RawSharing};
pub(super) use rules::RawRules;
pub(super) use sea::{
    RawCurrent, RawEddies, RawEddy, RawGusts, RawSea, RawShear, RawSpectrum, RawSpreading, RawTide, RawWander,
    RawWaves, RawWind,
};
pub(super) use sensor::{RawCompass, RawFault, RawGps, RawImu, RawJump};
pub(super) use strategy::{
    Amount, COMMON_KEYS, Given, RawAttractor, RawAvoidCollision, RawAvoidObstacle, RawBehaviour, RawBehaviours,
    RawCommon, RawConstantHeading, RawConstantSpeed, RawCutRange, RawEllipse, RawHelm, RawIntercept, RawLoiter,
    RawMaxSpeed, RawMemoryTurnLimit, RawMode, RawOpRegion, RawPolicy, RawRule, RawSet, RawShield, RawStationKeep,
    RawStrategy, RawTask, RawTrail, RawVariable, RawWaypoint, Stated, keys_of, kinds,
};
pub(super) use tournament::{RawEntry, RawTournament};

use super::diagnostics::Diagnostics;
use super::draw::Drawable;
use super::read::Typed;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::DeValue;

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

impl Typed for RawGame {
    const DRAWABLE: Drawable = Drawable::Table("link");
    const OWNER: &'static str = "game";
}

impl Typed for RawRules {
    const DRAWABLE: Drawable = Drawable::Table("sharing");
    const OWNER: &'static str = "rules";
}

impl Typed for RawBoat {
    const DRAWABLE: Drawable = Drawable::Everything;
    const OWNER: &'static str = "boat";
}

impl Typed for RawSea {
    const DRAWABLE: Drawable = Drawable::Everything;
    const OWNER: &'static str = "sea";
}

impl Typed for RawField {
    const DRAWABLE: Drawable = Drawable::Nothing;
    const OWNER: &'static str = "field";
}

impl Typed for RawStrategy {
    const DRAWABLE: Drawable = Drawable::Nothing;
    const OWNER: &'static str = "strategy";
    const APART: Option<&'static str> = Some("behaviour");
    const OWN: &'static [&'static str] = &["unsafe_i_know", "unsafe_because"];

    fn put_apart(&mut self, diagnostics: &mut Diagnostics, value: Spanned<DeValue<'_>>) {
        self.behaviour = RawBehaviours::of(diagnostics, value);
    }
}

impl Typed for RawTournament {
    const DRAWABLE: Drawable = Drawable::Nothing;
    const OWNER: &'static str = "tournament";
}

impl Typed for RawGateway {
    const DRAWABLE: Drawable = Drawable::Nothing;
    const OWNER: &'static str = "gateway";
}
