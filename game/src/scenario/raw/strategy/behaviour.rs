//! Behaviours as typed: keys that all of them have, and those of each kind.

use super::{
    Amount, RawAttractor, RawAvoidCollision, RawAvoidObstacle, RawConstantHeading, RawConstantSpeed, RawCutRange,
    RawFullStop, RawIntercept, RawLoiter, RawMaxSpeed, RawMemoryTurnLimit, RawOpRegion, RawPolicy, RawSet, RawShield,
    RawStationKeep, RawTimer, RawTrail, RawWaypoint,
};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::At;
use crate::scenario::strategy_read::deserialised;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Deserializer};
use serde_json::{Value, json};
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// All behaviours of a file, by name.
#[derive(Clone, Debug, Default)]
pub(in crate::scenario) struct RawBehaviours(pub(in crate::scenario) Vec<At<RawBehaviour>>);

/// A behaviour.
#[derive(Clone, Debug)]
pub(in crate::scenario) struct RawBehaviour {
    pub(in crate::scenario) name: String,
    pub(in crate::scenario) common: RawCommon,
    /// What it does; none if its kind is wrong, which has been noted.
    pub(in crate::scenario) task: Option<RawTask>,
}

/// What every behaviour may say.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::scenario) struct RawCommon {
    /// The modes in which it may run; a mode means it and all its parts. Default all modes.
    pub(in crate::scenario) r#in: Option<At<Vec<At<String>>>>,
    /// It runs only while this expression is true. Default always.
    pub(in crate::scenario) when: Option<At<String>>,
    /// How much its wishes count against those of others, a number or an expression; no more than the op_region and the
    /// avoid_collision on guard have: 0 to 1000. Default 100; of op_region, avoid_collision and avoid_obstacle 300.
    pub(in crate::scenario) weight: Option<At<Amount>>,
    /// It is complete after running for this long, s: 0 to 86400. Default never.
    pub(in crate::scenario) duration_s: Option<At<Amount>>,
    /// Whether it starts again after it was complete. Default false.
    pub(in crate::scenario) perpetual: Option<At<bool>>,
    /// Values given to variables when it begins to run.
    pub(in crate::scenario) on_run: Option<RawSet>,
    /// Values given to variables when it stops running.
    pub(in crate::scenario) on_idle: Option<RawSet>,
    /// Values given to variables when it begins to influence the helm.
    pub(in crate::scenario) on_active: Option<RawSet>,
    /// Values given to variables when it stops doing so.
    pub(in crate::scenario) on_inactive: Option<RawSet>,
    /// Values given to variables when it reaches one of its points, or its time.
    pub(in crate::scenario) on_reach: Option<RawSet>,
    /// Values given to variables when it is complete.
    pub(in crate::scenario) on_complete: Option<RawSet>,
}

/// The keys of [`RawCommon`], in order.
pub(in crate::scenario) const COMMON_KEYS: [&str; 11] = [
    "in",
    "when",
    "weight",
    "duration_s",
    "perpetual",
    "on_run",
    "on_idle",
    "on_active",
    "on_inactive",
    "on_reach",
    "on_complete",
];

/// What a behaviour does.
#[derive(Clone, Debug)]
pub(in crate::scenario) enum RawTask {
    Waypoint(RawWaypoint),
    Loiter(RawLoiter),
    StationKeep(RawStationKeep),
    CutRange(RawCutRange),
    Trail(RawTrail),
    Intercept(RawIntercept),
    AvoidCollision(RawAvoidCollision),
    AvoidObstacle(RawAvoidObstacle),
    OpRegion(RawOpRegion),
    MaxSpeed(RawMaxSpeed),
    ConstantHeading(RawConstantHeading),
    ConstantSpeed(RawConstantSpeed),
    MemoryTurnLimit(RawMemoryTurnLimit),
    Timer(RawTimer),
    FullStop(RawFullStop),
    Shield(RawShield),
    Attractor(RawAttractor),
    Policy(RawPolicy),
}

/// A kind of behaviour: its name in files, how its own keys are read, and their schema.
pub(in crate::scenario) struct RawKind {
    pub(in crate::scenario) name: &'static str,
    read: fn(&mut Diagnostics, Own<'_>) -> RawTask,
    schema: fn(&mut SchemaGenerator) -> Schema,
    /// Its own keys, in order.
    pub(in crate::scenario) keys: fn() -> Vec<String>,
}

/// All kinds, in the order in which they are explained.
pub(in crate::scenario) fn kinds() -> [RawKind; 18] {
    [
        kind::<RawWaypoint>("waypoint", |diagnostics, own| RawTask::Waypoint(own.read(diagnostics))),
        kind::<RawLoiter>("loiter", |diagnostics, own| RawTask::Loiter(own.read(diagnostics))),
        kind::<RawStationKeep>("station_keep", |diagnostics, own| RawTask::StationKeep(own.read(diagnostics))),
        kind::<RawCutRange>("cut_range", |diagnostics, own| RawTask::CutRange(own.read(diagnostics))),
        kind::<RawTrail>("trail", |diagnostics, own| RawTask::Trail(own.read(diagnostics))),
        kind::<RawIntercept>("intercept", |diagnostics, own| RawTask::Intercept(own.read(diagnostics))),
        kind::<RawShield>("shield", |diagnostics, own| RawTask::Shield(own.read(diagnostics))),
        kind::<RawAttractor>("attractor", |diagnostics, own| RawTask::Attractor(own.read(diagnostics))),
        kind::<RawAvoidCollision>("avoid_collision", |diagnostics, own| RawTask::AvoidCollision(own.read(diagnostics))),
        kind::<RawAvoidObstacle>("avoid_obstacle", |diagnostics, own| RawTask::AvoidObstacle(own.read(diagnostics))),
        kind::<RawOpRegion>("op_region", |diagnostics, own| RawTask::OpRegion(own.read(diagnostics))),
        kind::<RawMaxSpeed>("max_speed", |diagnostics, own| RawTask::MaxSpeed(own.read(diagnostics))),
        kind::<RawConstantHeading>("constant_heading", |diagnostics, own| {
            RawTask::ConstantHeading(own.read(diagnostics))
        }),
        kind::<RawConstantSpeed>("constant_speed", |diagnostics, own| RawTask::ConstantSpeed(own.read(diagnostics))),
        kind::<RawMemoryTurnLimit>("memory_turn_limit", |diagnostics, own| {
            RawTask::MemoryTurnLimit(own.read(diagnostics))
        }),
        kind::<RawTimer>("timer", |diagnostics, own| RawTask::Timer(own.read(diagnostics))),
        kind::<RawFullStop>("full_stop", |diagnostics, own| RawTask::FullStop(own.read(diagnostics))),
        kind::<RawPolicy>("policy", |diagnostics, own| RawTask::Policy(own.read(diagnostics))),
    ]
}

fn kind<T: DeserializeOwned + JsonSchema>(
    name: &'static str,
    read: fn(&mut Diagnostics, Own<'_>) -> RawTask,
) -> RawKind {
    RawKind { name, read, schema: T::json_schema, keys: keys_of::<T> }
}

/// The keys of a behaviour that are those of its kind.
struct Own<'i> {
    /// Where the behaviour stands.
    at: usize,
    table: Spanned<DeTable<'i>>,
}

impl Own<'_> {
    /// Reads them; one that the kind does not know is noted with all that may stand there.
    fn read<T: DeserializeOwned + Default>(mut self, diagnostics: &mut Diagnostics) -> T {
        let own = keys_of::<T>();
        let known: Vec<&str> =
            std::iter::once("kind").chain(own.iter().map(String::as_str)).chain(COMMON_KEYS).collect();
        let table = std::mem::take(self.table.get_mut());
        for (key, value) in table {
            if known.contains(&key.get_ref().as_ref()) {
                self.table.get_mut().insert(key, value);
                continue;
            }
            let guess = nearest(key.get_ref(), &known).map(|guess| format!(" (did you mean {guess}?)"));
            let (name, guess) = (key.get_ref(), guess.unwrap_or_default());
            let at = key.span().start;
            diagnostics.note_if_intact(at, format!("{name} is unknown, expected one of {}{guess}", known.join(", ")));
        }
        deserialised(diagnostics, self.at, self.table)
    }
}

/// The keys that `T` knows, in the order of its fields: serde lists them when it meets another one.
pub(in crate::scenario) fn keys_of<T: DeserializeOwned>() -> Vec<String> {
    let none = toml::de::Deserializer::parse("'' = 0").expect("this is a key and a value");
    match T::deserialize(none) {
        Ok(_) => vec![],
        Err(error) => error.message().split('`').skip(3).step_by(2).map(str::to_owned).collect(),
    }
}

impl RawBehaviours {
    /// Reads the table `behaviour` of a file.
    pub(in crate::scenario) fn of(diagnostics: &mut Diagnostics, value: Spanned<DeValue<'_>>) -> RawBehaviours {
        let at = value.span().start;
        match value.into_inner() {
            DeValue::Table(table) => RawBehaviours(
                table
                    .into_iter()
                    .filter_map(|(name, value)| one(diagnostics, name.get_ref(), name.span().start, value))
                    .collect(),
            ),
            other => {
                diagnostics.note(at, format!("behaviour is {}, expected tables [behaviour.NAME]", found(&other)));
                // Without it nobody can say whether roles are missing.
                diagnostics.mark_unfit(at, "roles");
                RawBehaviours::default()
            }
        }
    }
}

fn one(diagnostics: &mut Diagnostics, name: &str, at: usize, value: Spanned<DeValue<'_>>) -> Option<At<RawBehaviour>> {
    diagnostics.is_name(at, "behaviour", name);
    let span = value.span();
    let table = match value.into_inner() {
        DeValue::Table(table) => table,
        other => {
            let message = format!("behaviour.{name} is {}, expected a table with kind = ...", found(&other));
            diagnostics.note(span.start, message);
            return None;
        }
    };
    let (mut common, mut own, mut kind) = (DeTable::new(), DeTable::new(), None);
    for (key, value) in table {
        match key.get_ref().as_ref() {
            "kind" => kind = Some(value),
            name if COMMON_KEYS.contains(&name) => drop(common.insert(key, value)),
            _ => drop(own.insert(key, value)),
        }
    }
    let common = deserialised(diagnostics, at, Spanned::new(span.clone(), common));
    let kind = kind_of(diagnostics, name, at, kind.as_ref());
    let own = Own { at, table: Spanned::new(span, own) };
    let task = kind.map(|kind| (kind.read)(diagnostics, own));
    Some(At { at, value: RawBehaviour { name: name.to_owned(), common, task } })
}

fn kind_of(
    diagnostics: &mut Diagnostics,
    name: &str,
    at: usize,
    given: Option<&Spanned<DeValue<'_>>>,
) -> Option<RawKind> {
    let names = kinds().map(|kind| kind.name);
    let Some(given) = given else {
        diagnostics
            .note_if_intact(at, format!("behaviour.{name}.kind is missing, expected one of {}", names.join(", ")));
        return None;
    };
    let kind = given.get_ref().as_str().and_then(|name| kinds().into_iter().find(|kind| kind.name == name));
    if kind.is_none() {
        let guess = given.get_ref().as_str().and_then(|name| nearest(name, &names));
        let guess = guess.map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
        let found = found(given.get_ref());
        diagnostics.note(given.span().start, format!("kind is {found}, expected one of {}{guess}", names.join(", ")));
    }
    kind
}

/// What a value is, in words.
fn found(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(number) => number.as_str().to_owned(),
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(is) => is.to_string(),
        DeValue::Datetime(date) => date.to_string(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// Nothing: the table is read by [`RawBehaviours::of`] before serde sees the rest of the file.
impl<'de> Deserialize<'de> for RawBehaviours {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<RawBehaviours, D::Error> {
        IgnoredAny::deserialize(deserializer).map(|_| RawBehaviours::default())
    }
}

impl JsonSchema for RawBehaviours {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Behaviours".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let choices: Vec<Value> = kinds().iter().map(|kind| of_kind(generator, kind)).collect();
        json_schema!({ "type": "object", "additionalProperties": { "anyOf": choices } })
    }
}

/// A reference to the schema of a behaviour of this kind: its own keys and those of all. A file that is laid over a
/// base need not say the kind again, so the schema does not ask for it; the check does.
fn of_kind(generator: &mut SchemaGenerator, kind: &RawKind) -> Value {
    let mut schema = (kind.schema)(generator).to_value();
    let common = RawCommon::json_schema(generator).to_value();
    let mut properties = common["properties"].as_object().cloned().unwrap_or_default();
    properties.extend(schema["properties"].as_object().cloned().unwrap_or_default());
    properties.insert("kind".into(), json!({ "description": "What it does. Required.", "enum": [kind.name] }));
    schema["properties"] = Value::Object(properties);
    let definition = format!("behaviour_{}", kind.name);
    generator.definitions_mut().insert(definition.clone(), schema);
    json!({ "$ref": format!("#/definitions/{definition}") })
}
