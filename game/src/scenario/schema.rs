//! The JSON Schema of each kind of scenario file: the single owner of every key's type, range, default and meaning.
//!
//! A key is a field of a type in `raw`, and is declared once, there:
//!
//! ```text
//! /// An intruder is tagged closer than this, m.
//! #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
//! pub(crate) tag_radius_m: f64,
//! ```
//!
//! * Its doc comment is the description, with the unit; a unit is also the end of its name.
//! * `range` (of numbers), `length` (of lists) and `inner(range(…))` (of the numbers in a list) say what is allowed.
//! * `extend("default" = …)` is the value of a key that is left out. Without it the key is required, unless the field
//!   is an `Option`. A list or a table of which nothing is required may be left out too, and is then empty.
//! * Choices are enums with `rename_all = "snake_case"` and a doc comment for each choice.
//! * `extend("x-expected" = "…")` says in messages what is expected, where the type alone would not.
//! * `extend("x-drawn" = true)` allows distributions in place of all numbers in a table.
//!
//! [`declared`] is the schema in this form, by which files are read (see `validate`); [`schema`] is the one for editors.

use super::kind::Kind;
use super::{Tournament, raw};
use crate::gateway::Gateway;
use crate::rules::Rules;
use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// The schema that files of a kind are read by.
pub(super) fn declared(kind: Kind) -> &'static Value {
    static SCHEMAS: [OnceLock<Value>; Kind::ALL.len()] = [const { OnceLock::new() }; Kind::ALL.len()];
    SCHEMAS[kind as usize].get_or_init(|| match kind {
        Kind::Game => generated::<raw::Game>(kind),
        Kind::Field => generated::<raw::Field>(kind),
        Kind::Rules => generated::<Rules>(kind),
        Kind::Boat => generated::<raw::Boat>(kind),
        Kind::Sea => generated::<raw::Sea>(kind),
        Kind::Strategy => generated::<raw::Strategy>(kind),
        Kind::Tournament => generated::<Tournament>(kind),
        Kind::Gateway => generated::<Gateway>(kind),
    })
}

/// The JSON Schema of a kind of file, for editors.
///
/// It asks for required keys only where no base can give them: at the top of a file without one, and in lists.
#[must_use]
pub fn schema(kind: Kind) -> Value {
    let declared = declared(kind);
    let mut uses = BTreeMap::new();
    collect_uses(declared, &declared["definitions"], Use::default(), &mut uses);
    let mut schema = declared.clone();
    relax(&mut schema, declared);
    for (name, definition) in schema["definitions"].as_object_mut().into_iter().flatten() {
        let of = uses.get(name.as_str()).copied().unwrap_or_default();
        if !of.is_item {
            definition.as_object_mut().and_then(|definition| definition.remove("required"));
        }
        publish(definition, of.is_drawn);
    }
    let required = schema.as_object_mut().and_then(|schema| schema.remove("required"));
    if let Some(required) = required.filter(|required| *required != json!([])) {
        schema["if"] = json!({ "not": { "required": ["base"] } });
        schema["then"] = json!({ "required": required });
    }
    let definitions = schema.as_object_mut().and_then(|schema| schema.remove("definitions"));
    let mut definitions = definitions.unwrap_or_else(|| json!({}));
    let is_drawn = declared.get(DRAWN).is_some();
    publish(&mut schema, is_drawn);
    if is_drawn || uses.values().any(|of| of.is_drawn) {
        definitions["Distribution"] = distribution();
    }
    if definitions.as_object().is_some_and(|definitions| !definitions.is_empty()) {
        schema["definitions"] = definitions;
    }
    schema
}

/// Stops asking for what may be left out, since it is then an empty list or a table of defaults.
fn relax(value: &mut Value, root: &Value) {
    match value {
        Value::Object(object) => {
            let properties = object.get("properties").cloned().unwrap_or_default();
            if let Some(Value::Array(required)) = object.get_mut("required") {
                required.retain(|key| !may_be_empty(&properties[key.as_str().unwrap_or_default()], root));
            }
            object.values_mut().for_each(|value| relax(value, root));
        }
        Value::Array(items) => items.iter_mut().for_each(|item| relax(item, root)),
        _ => {}
    }
}

/// Whether a list may have no entries, or a table no keys.
pub(super) fn may_be_empty(schema: &Value, root: &Value) -> bool {
    let schema = resolved(schema, root);
    let is_optional = |key: &Value| may_be_empty(&schema["properties"][key.as_str().unwrap_or_default()], root);
    match schema["type"].as_str() {
        Some("array") => schema["minItems"].as_u64().unwrap_or(0) == 0,
        Some("object") => {
            schema.get("oneOf").is_none() && schema["required"].as_array().into_iter().flatten().all(is_optional)
        }
        _ => false,
    }
}

/// The mark of tables whose numbers may be distributions.
pub(super) const DRAWN: &str = "x-drawn";

/// What a schema refers to: the definition itself, or the schema as it stands.
pub(super) fn resolved<'a>(schema: &'a Value, root: &'a Value) -> &'a Value {
    let name = schema.get("$ref").or_else(|| schema.get("allOf")?.get(0)?.get("$ref")).and_then(Value::as_str);
    name.map_or(schema, |name| &root["definitions"][name.rsplit('/').next().unwrap_or_default()])
}

/// How a definition is used.
#[derive(Clone, Copy, Default, PartialEq)]
struct Use {
    is_drawn: bool,
    is_item: bool,
}

/// Finds how each definition is used in `value`, and in the definitions that it uses.
fn collect_uses<'a>(value: &'a Value, definitions: &'a Value, of: Use, uses: &mut BTreeMap<&'a str, Use>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| collect_uses(item, definitions, of, uses)),
        Value::Object(object) => {
            let is_drawn = of.is_drawn || object.contains_key(DRAWN);
            if let Some(name) = object.get("$ref").and_then(|name| name.as_str()?.rsplit('/').next()) {
                let known = uses.entry(name).or_default();
                let now = Use { is_drawn: known.is_drawn || is_drawn, is_item: known.is_item || of.is_item };
                if std::mem::replace(known, now) != now || !is_drawn && !of.is_item {
                    collect_uses(&definitions[name], definitions, Use { is_drawn, is_item: false }, uses);
                }
            }
            for (key, value) in object.iter().filter(|(key, _)| *key != "definitions") {
                let is_item = key == "items" || of.is_item && key == "allOf";
                collect_uses(value, definitions, Use { is_drawn, is_item }, uses);
            }
        }
        _ => {}
    }
}

/// Makes the schema of a table one for editors: without our own marks, with distributions where they are allowed.
fn publish(value: &mut Value, is_drawn: bool) {
    match value {
        Value::Object(object) => {
            object.retain(|key, _| !key.starts_with("x-"));
            if object.contains_key("properties") {
                object.insert("additionalProperties".into(), false.into());
            }
            // A file that is laid over a base need not say again which of several tables this is.
            if object.get("oneOf").is_some_and(|kinds| kinds[0].get("$ref").is_some()) {
                let kinds = object.remove("oneOf").unwrap_or_default();
                object.insert("anyOf".into(), kinds);
            }
            object.values_mut().for_each(|value| publish(value, is_drawn));
            let is_number = |kind: &Value| kind == "number" || kind == "integer";
            if is_drawn && object.get("type").is_some_and(is_number) {
                let keys = ["type", "minimum", "maximum"].into_iter();
                let number: Map<_, _> = keys.filter_map(|key| object.remove_entry(key)).collect();
                object.insert("anyOf".into(), json!([number, { "$ref": "#/definitions/Distribution" }]));
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| publish(item, is_drawn)),
        _ => {}
    }
}

/// The schema that is generated from `T`, with what all files have in common.
fn generated<T: JsonSchema>(kind: Kind) -> Value {
    // Draft 7 is what editors' TOML extensions understand.
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<T>().to_value();
    tidy(&mut schema);
    schema["title"] = format!("Squall {kind}").into();
    let base = format!("Another {kind} file that this one is laid over, relative to this file.");
    schema["properties"]["base"] = json!({ "type": "string", "description": base });
    schema
}

/// What has a default is not required, and may not be null, since TOML has no null.
fn tidy(value: &mut Value) {
    let is_null = |choice: &Value| *choice == "null" || choice.get("type").is_some_and(|kind| kind == "null");
    if let Value::Array(items) = value {
        items.iter_mut().for_each(tidy);
    }
    let Value::Object(object) = value else { return };
    object.remove("format");
    if let Some(Value::Array(types)) = object.get_mut("type") {
        types.retain(|choice| !is_null(choice));
        if let [only] = types.as_slice() {
            let only = only.clone();
            object.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(choices)) = object.get_mut("anyOf") {
        choices.retain(|choice| !is_null(choice));
        if let [only] = choices.as_slice() {
            let only = only.clone();
            object.remove("anyOf");
            match only {
                Value::Object(only) if !only.contains_key("$ref") => {
                    for (key, value) in only {
                        object.entry(key).or_insert(value);
                    }
                }
                // Draft 7 ignores what stands beside a `$ref`, so the reference goes into a list of one.
                only => drop(object.insert("allOf".into(), Value::Array(vec![only]))),
            }
        }
    }
    let has_default: Vec<String> = object.get("properties").and_then(Value::as_object).map_or(vec![], |properties| {
        properties.iter().filter(|(_, about)| about.get("default").is_some()).map(|(key, _)| key.clone()).collect()
    });
    if let Some(Value::Array(required)) = object.get_mut("required") {
        required.retain(|key| has_default.iter().all(|known| key != known));
    }
    object.values_mut().for_each(tidy);
}

fn distribution() -> Value {
    let kind = |name: &str, most: Option<u32>, what: &str| {
        let mut numbers = json!({ "type": "array", "items": { "type": "number" }, "minItems": most.unwrap_or(1) });
        if let Some(most) = most {
            numbers["maxItems"] = most.into();
        }
        json!({
            "type": "object",
            "description": what,
            "properties": { name: numbers, "times": { "type": "number", "description": "A factor.", "default": 1 } },
            "required": [name],
            "additionalProperties": false
        })
    };
    json!({
        "description": "A number that is drawn anew for every game, and for every vehicle.",
        "anyOf": [
            kind("uniform", Some(2), "Between two numbers, all equally likely."),
            kind("normal", Some(2), "Mean and standard deviation; within three of them."),
            kind("log_normal", Some(2), "Median, and standard deviation of the logarithm; within three of them."),
            kind("choice", None, "One of these.")
        ]
    })
}
