//! The JSON Schema of each kind of scenario file: the single source of every key's type, range,
//! default and meaning.
//!
//! A key is a field of a type, and is declared only once, there:
//!
//! ```text
//! /// Maximum distance for a tag, m.
//! #[schemars(range(min = 0.1, max = 1000), extend("default" = 10))]
//! pub tag_radius_m: f64,
//! ```
//!
//! * Its doc comment is the description, with the unit; its name also ends with the unit.
//! * `range` (of numbers), `length` (of lists) and `inner(range(…))` (of the numbers in a list)
//!   define the allowed values.
//! * `extend("default" = …)` is the value of an omitted key. Without it the key is required, unless
//!   the field is an `Option`. A list or a table without required parts may be omitted too, and is
//!   then empty.
//! * Choices are enums with `rename_all = "snake_case"` and a doc comment for each choice.
//! * `extend("x-expected" = "…")` states the expected value in messages where the type alone is not
//!   enough.
//! * `rename` with `extend("x-field" = "…")` gives the key a name that differs from the field's,
//!   and thereby a different unit.
//! * `extend("x-drawn" = true)` allows distributions in place of all numbers in a table.
//!
//! [`declared`] is the schema in this form, used for reading files (see `validate`); [`schema`] is
//! the schema for editors.

use super::kind::Kind;
use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// The schema for reading files of a kind, created once per process.
pub(super) fn declared(kind: Kind) -> &'static Value {
    static SCHEMAS: Mutex<BTreeMap<&str, &Value>> = Mutex::new(BTreeMap::new());
    let mut schemas = SCHEMAS.lock().unwrap_or_else(PoisonError::into_inner);
    // Leaked: there is one per kind, needed until the process ends.
    schemas
        .entry(kind.name())
        .or_insert_with(|| Box::leak(Box::new((kind.keys)(kind))))
}

/// The JSON Schema of a kind of file, for editors.
///
/// Keys are required only where no base can supply them: at the top of a file without a base, and
/// in lists.
///
/// # Panics
/// Never: the schema of a distribution is JSON.
pub fn schema(kind: Kind) -> Value {
    let mut schema = declared(kind).clone();
    let has_drawn = schema.to_string().contains(DRAWN);
    schema
        .as_object_mut()
        .map(|schema| schema.remove("definitions"));
    publish(&mut schema, false, true);
    if has_drawn {
        let distribution: Value = serde_json::from_str(DISTRIBUTION).expect("it is JSON");
        schema["definitions"] = json!({ "Distribution": distribution });
    }
    let required = schema
        .as_object_mut()
        .and_then(|schema| schema.remove("required"));
    if let Some(required) = required.filter(|required| *required != json!([])) {
        schema["if"] = json!({ "not": { "required": ["base"] } });
        schema["then"] = json!({ "required": required });
    }
    schema
}

/// The keys of a table and their schemas; empty for other values.
pub(super) fn properties(schema: &Value) -> impl Iterator<Item = (&str, &Value)> {
    let keys = schema["properties"].as_object().into_iter().flatten();
    keys.map(|(key, about)| (key.as_str(), about))
}

/// The entries of a list in a schema, such as `oneOf`.
pub(super) fn entries<'a>(schema: &'a Value, list: &str) -> impl Iterator<Item = &'a Value> {
    schema[list].as_array().into_iter().flatten()
}

/// Whether a key is required in a table.
pub(super) fn is_required(schema: &Value, key: &str) -> bool {
    entries(schema, "required").any(|known| known == key)
}

/// Whether a list may be empty, or a table may have no keys.
pub(super) fn may_be_empty(schema: &Value) -> bool {
    let is_optional = |(key, about)| !is_required(schema, key) || may_be_empty(about);
    match schema["type"].as_str() {
        Some("array") => schema["minItems"].as_u64().unwrap_or(0) == 0,
        Some("object") => schema.get("oneOf").is_none() && properties(schema).all(is_optional),
        _ => false,
    }
}

const DISTRIBUTION: &str = include_str!("distribution.schema.json");
/// The mark of tables whose numbers may be distributions.
pub(super) const DRAWN: &str = "x-drawn";
/// The description of a table whose key also has a description.
pub(super) const TABLE: &str = "x-table";

/// Converts the schema of a table for editors: without Squall's own marks, with distributions where
/// they are allowed, and with each description on one line. Keys are required only in entries of
/// lists, except those that default to an empty list or a table of defaults.
fn publish(value: &mut Value, is_drawn: bool, is_item: bool) {
    let object = match value {
        Value::Array(items) => {
            return items
                .iter_mut()
                .for_each(|item| publish(item, is_drawn, is_item));
        }
        Value::Object(object) => object,
        _ => return,
    };
    let is_drawn = is_drawn || object.contains_key(DRAWN);
    object.retain(|key, _| !key.starts_with("x-") && (is_item || key != "required"));
    if let Some(Value::String(text)) = object.get_mut("description") {
        // These line breaks come from the wrapped comment.
        *text = text.replace('\n', " ");
    }
    if let Some(properties) = object.get("properties").cloned() {
        object.insert("additionalProperties".into(), false.into());
        if let Some(Value::Array(required)) = object.get_mut("required") {
            required.retain(|key| !may_be_empty(&properties[key.as_str().unwrap_or_default()]));
        }
    }
    // A file with a base need not repeat which of several tables it defines.
    if object
        .get("oneOf")
        .is_some_and(|kinds| kinds[0].get("properties").is_some())
    {
        let kinds = object.remove("oneOf").unwrap_or_default();
        object.insert("anyOf".into(), kinds);
    }
    object
        .iter_mut()
        .for_each(|(key, value)| publish(value, is_drawn, key == "items"));
    let is_number = |kind: &Value| kind == "number" || kind == "integer";
    if is_drawn && object.get("type").is_some_and(is_number) {
        let keys = ["type", "minimum", "maximum"].into_iter();
        let number: Map<_, _> = keys.filter_map(|key| object.remove_entry(key)).collect();
        object.insert(
            "anyOf".into(),
            json!([number, { "$ref": "#/definitions/Distribution" }]),
        );
    }
}

/// The schema generated from `T`, with the common keys of all files.
pub(super) fn generated<T: JsonSchema>(kind: Kind) -> Value {
    // Editors' TOML extensions support draft 7.
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<T>().to_value();
    let definitions = schema["definitions"].clone();
    tidy(&mut schema, &definitions);
    schema["title"] = format!("Squall {kind}").into();
    let base = format!(
        "Another {kind} file on which this one builds: its path relative to this file, or its name."
    );
    schema["properties"]["base"] = json!({ "type": "string", "description": base });
    schema
}

/// Replaces references with their definitions. Keys with a default are not required, and must not
/// be null, since TOML has no null.
fn tidy(value: &mut Value, definitions: &Value) {
    let is_null =
        |choice: &Value| *choice == "null" || choice.get("type").is_some_and(|kind| kind == "null");
    if let Value::Array(items) = value {
        items.iter_mut().for_each(|item| tidy(item, definitions));
    }
    let Value::Object(object) = value else { return };
    // Draft 7 ignores siblings of a reference, so the reference is in a list with one entry.
    let reference = object.remove("$ref").or_else(|| {
        object
            .remove("allOf")
            .map(|mut list| list[0]["$ref"].take())
    });
    if let Some(name) = reference
        .as_ref()
        .and_then(|name| name.as_str()?.rsplit('/').next())
    {
        object.insert(TABLE.into(), definitions[name]["description"].clone());
        add(object, definitions[name].clone());
    }
    object
        .values_mut()
        .for_each(|value| tidy(value, definitions));
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
            add(object, only);
        }
    }
    let keys = object.get("properties").cloned().unwrap_or_default();
    if let Some(Value::Array(required)) = object.get_mut("required") {
        required.retain(|key| {
            keys[key.as_str().unwrap_or_default()]
                .get("default")
                .is_none()
        });
    }
}

/// Adds the entries of `other` that are missing in `object`.
fn add(object: &mut Map<String, Value>, other: Value) {
    if let Value::Object(other) = other {
        for (key, value) in other {
            object.entry(key).or_insert(value);
        }
    }
}
