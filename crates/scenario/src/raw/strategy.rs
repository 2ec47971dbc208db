//! A strategy file as written.

use super::{FilePath, Name};
use crate::schema::{self, entries, properties};
use crate::strategy::{self, Assignment, Helm, Moment, Named, Task};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// How a team's boats play: roles and their assignment, or one program for all.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Strategy {
    /// Description, in one line.
    #[schemars(extend("default" = ""))]
    pub(crate) about: String,
    /// Program files, assigned to the team's boats in turn. Without this key, the file is a
    /// program.
    #[schemars(length(min = 1, max = 1000))]
    pub(crate) roles: Option<Vec<FilePath>>,
    /// How roles are assigned to boats.
    #[schemars(extend("default" = "fixed"))]
    pub(crate) assignment: Assignment,
    /// How the helm decides.
    pub(crate) helm: Helm,
    /// Allows modes without `op_region` or `avoid_collision`.
    #[schemars(extend("default" = false))]
    pub(crate) unsafe_i_know: bool,
    /// The reason; required with `unsafe_i_know`.
    pub(crate) unsafe_because: Option<String>,
    /// Variables by name: an initial number or boolean, or a table.
    #[schemars(extend("default" = {}))]
    pub(crate) variables: BTreeMap<String, Variable>,
    /// Modes, parents before children. Among siblings, the first whose condition holds is active.
    /// Default: one mode, "active".
    #[schemars(length(max = 1000))]
    pub(crate) mode: Vec<Mode>,
    /// Behaviours by name; the helm weighs them.
    #[schemars(extend("default" = {}, "x-expected" = "tables [behaviour.NAME]"))]
    pub(crate) behaviour: BTreeMap<String, Behaviour>,
    /// Rules that set variables at every decision, in order.
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
    /// For a string variable one of its values, otherwise an expression.
    Text(String),
}

/// A variable: its initial value, or all its keys.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "a number, true, false, or a table { values = [...], initial = ..., shared = ... }"))]
pub(crate) enum Variable {
    Number(f64),
    Truth(bool),
    Table(VariableTable),
}

/// A variable with all its keys.
#[derive(Debug, Deserialize, JsonSchema)]
#[schemars(rename = "Variable")]
pub(crate) struct VariableTable {
    /// Allowed strings; required for string variables only.
    #[schemars(length(min = 1, max = 100))]
    pub(crate) values: Option<Vec<Name>>,
    /// Initial value; required except for strings. Default: the first string.
    pub(crate) initial: Option<Value>,
    /// Whether it is shared with the team.
    #[schemars(extend("default" = false))]
    pub(crate) shared: bool,
}

/// A mode of the boat.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Mode {
    /// Name, unique in the program.
    pub(crate) name: Name,
    /// Parent mode, which must precede this one. Default: none.
    pub(crate) r#in: Option<String>,
    /// Condition; required, except for the last sibling, which has none.
    pub(crate) when: Option<String>,
    /// Values assigned to variables when the mode begins.
    #[schemars(extend("default" = {}))]
    pub(crate) set: Values,
}

/// Sets variables.
#[derive(Debug, Deserialize, JsonSchema)]
pub(crate) struct Rule {
    /// Event, for example "enemy grabs". Required without `when`.
    pub(crate) on: Option<String>,
    /// Condition under which the rule applies. Required without `on`.
    pub(crate) when: Option<String>,
    /// New values by variable.
    #[schemars(extend("x-expected" = "values for variables"))]
    pub(crate) set: Values,
}

/// A behaviour: the keys of [`strategy::Behaviour`], one key for each [`Moment`], and those of its
/// [`Task`].
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
            values["description"] = format!("Sets variables when {when}").into();
            values["default"] = json!({});
            common["properties"][moment.name()] = values;
        }
        let tasks = Task::json_schema(generator).to_value();
        let mut kinds = vec![];
        for (kind, reference) in entries(&tasks, "oneOf").flat_map(properties) {
            let name = reference["$ref"].as_str().unwrap_or_default();
            let name = name.rsplit('/').next().unwrap_or_default();
            complete(&mut generator.definitions_mut()[name], kind, &common);
            kinds.push(reference.clone());
        }
        json_schema!({ "type": "object", "oneOf": kinds, "x-expected": "a table with kind = ..." })
    }
}

/// Adds the common keys to those of one kind.
fn complete(definition: &mut Json, kind: &str, common: &Json) {
    let mut properties = common["properties"].clone();
    let description = "Kind of behaviour.";
    properties["kind"] = json!({ "type": "string", "description": description, "const": kind });
    if let Some(weight) = definition.get("x-weight") {
        properties["weight"]["default"] = weight.clone();
    }
    let mut required = vec![json!("kind")];
    required.extend((kind == "timer").then(|| json!("duration_s")));
    for about in [common, &*definition] {
        required.extend(entries(about, "required").cloned());
    }
    for (key, about) in schema::properties(definition) {
        properties[key] = about.clone();
    }
    definition["properties"] = properties;
    definition["required"] = required.into();
}
