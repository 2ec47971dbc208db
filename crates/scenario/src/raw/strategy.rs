//! A strategy file as typed.

use super::{FilePath, Name};
use crate::strategy::{self, Assignment, Helm, Moment, Named, Task};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// How the boats of a team play: either roles and how they are dealt, or the program that everybody follows.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Strategy {
    /// What the strategy is, in a line.
    #[schemars(extend("default" = ""))]
    pub(crate) about: String,
    /// The files of the programs, relative to this file, dealt to the team's boats in turn, again from the start. Without
    /// it this file is itself a program.
    #[schemars(length(min = 1, max = 1000))]
    pub(crate) roles: Option<Vec<FilePath>>,
    /// How roles are dealt.
    #[schemars(extend("default" = "fixed"))]
    pub(crate) assignment: Assignment,
    /// How decisions are made.
    pub(crate) helm: Helm,
    /// Lets modes go without op_region or avoid_collision.
    #[schemars(extend("default" = false))]
    pub(crate) unsafe_i_know: bool,
    /// Why they may. Needed with unsafe_i_know.
    pub(crate) unsafe_because: Option<String>,
    /// Variables, by name: a number, true or false, or a table.
    #[schemars(extend("default" = {}))]
    pub(crate) variables: BTreeMap<String, Variable>,
    /// Modes, parents before their parts: of the parts of a mode the first whose condition holds is the one. Default a
    /// single mode, "active".
    #[schemars(length(max = 1000))]
    pub(crate) mode: Vec<Mode>,
    /// What the helm weighs against each other, by name.
    #[schemars(extend("default" = {}, "x-expected" = "tables [behaviour.NAME]"))]
    pub(crate) behaviour: BTreeMap<String, Behaviour>,
    /// What gives values to variables at every decision, in order.
    #[schemars(length(max = 1000))]
    pub(crate) rule: Vec<Rule>,
}

/// Values assigned to variables, by variable name.
pub(crate) type Values = BTreeMap<String, Value>;

/// A value for a variable.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum Value {
    Number(f64),
    Truth(bool),
    /// For a text variable one of its values, else an expression.
    Text(String),
}

/// A variable: what it is at first, or all about it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "a number, true, false, or a table { values = [...], initial = ..., shared = ... }"))]
pub(crate) enum Variable {
    Number(f64),
    Truth(bool),
    Table(VariableTable),
}

/// A variable in full.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(rename = "Variable")]
pub(crate) struct VariableTable {
    /// The texts that it may have. Needed for a text variable, and for no other.
    #[schemars(length(min = 1, max = 100))]
    pub(crate) values: Option<Vec<Name>>,
    /// What it is at first. Needed, but for texts; default their first value.
    pub(crate) initial: Option<Value>,
    /// Whether the team is told of it.
    #[schemars(extend("default" = false))]
    pub(crate) shared: bool,
}

/// A mode: what the boat is at.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Mode {
    /// Its name, unique in the program.
    pub(crate) name: Name,
    /// The mode that it is a part of; that one stands before it. Default none.
    pub(crate) r#in: Option<String>,
    /// The condition for it, an expression. Needed, but for the last part of a mode, which has none.
    pub(crate) when: Option<String>,
    /// Values given to variables when it begins.
    #[schemars(extend("default" = {}))]
    pub(crate) set: Values,
}

/// Gives values to variables.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Rule {
    /// Only at this event: who and what, as in "enemy grabs". Needed, or when.
    pub(crate) on: Option<String>,
    /// Only where this expression is true. Needed, or on.
    pub(crate) when: Option<String>,
    /// The values, by the names of the variables.
    #[schemars(extend("x-expected" = "values for variables"))]
    pub(crate) set: Values,
}

/// A behaviour: the keys of [`strategy::Behaviour`], one for each [`Moment`], and those of its
/// kind, which [`Task`] declares.
#[derive(Debug, Deserialize)]
#[serde(transparent)]
pub(crate) struct Behaviour(pub(crate) Json);

impl JsonSchema for Behaviour {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Behaviour".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut common = strategy::Behaviour::json_schema(generator).to_value();
        for moment in Moment::all() {
            let mut values = generator.subschema_for::<Values>().to_value();
            let when = moment.meaning().replacen("It", "it", 1);
            values["description"] = format!("Values given to variables when {when}").into();
            values["default"] = json!({});
            common["properties"][moment.name()] = values;
        }
        let tasks = Task::json_schema(generator).to_value();
        let tasks = tasks["oneOf"].as_array().into_iter().flatten().filter_map(|task| task["properties"].as_object());
        let mut kinds = vec![];
        for (kind, reference) in tasks.flatten() {
            let name = reference["$ref"].as_str().and_then(|name| name.rsplit('/').next()).unwrap_or_default();
            complete(&mut generator.definitions_mut()[name], kind, &common);
            kinds.push(reference.clone());
        }
        json_schema!({ "type": "object", "oneOf": kinds, "x-expected": "a table with kind = ..." })
    }
}

/// Adds the common keys to those of one kind of behaviour.
fn complete(definition: &mut Json, kind: &str, common: &Json) {
    let mut properties = common["properties"].clone();
    properties["kind"] = json!({ "type": "string", "description": "What it does.", "const": kind });
    if let Some(weight) = definition.get("x-weight") {
        properties["weight"]["default"] = weight.clone();
    }
    let mut required = vec![json!("kind")];
    required.extend((kind == "timer").then(|| json!("duration_s")));
    for about in [common, &*definition] {
        required.extend(about["required"].as_array().cloned().unwrap_or_default());
    }
    let own = definition["properties"].as_object().cloned().unwrap_or_default();
    properties.as_object_mut().into_iter().for_each(|properties| properties.extend(own.clone()));
    definition["properties"] = properties;
    definition["required"] = required.into();
}
