//! Converts keys and units of files to fields of types, in SI.
//!
//! A key with an `x-field` is stored in a field with a different name: `"gain.0"` is the first
//! entry of the list `gain`. Its unit is converted, seconds become a time if the field has no unit,
//! and `[x, y]` becomes a position.

use super::schema::properties;
use super::unit::Unit;
use primitives::frame::Ned;
use primitives::time::SimTime;
use serde_json::{Map, Value, json};

/// The schema key that gives the field's name, if its name or unit differs.
const FIELD: &str = "x-field";

/// Converts a table's values by key to values by field.
pub(super) fn by_fields(mut values: Map<String, Value>, schema: &Value) -> Value {
    let keys = properties(schema);
    let marked = keys.filter_map(|(key, about)| Some((key, about.get(FIELD)?.as_str()?)));
    let moved: Vec<_> = marked
        .filter_map(|(key, field)| Some((key, field, values.remove(key)?)))
        .collect();
    let mut table = Value::Object(values);
    for (key, field, value) in moved {
        match field.split_once('.') {
            None => table[field] = of_field(key, field, &value),
            // The schema's keys are sorted, and so are those of a list.
            Some((list, _)) => match &mut table[list] {
                Value::Array(items) => items.push(of_field(key, field, &value)),
                first => *first = json!([of_field(key, field, &value)]),
            },
        }
    }
    table
}

fn of_field(key: &str, field: &str, value: &Value) -> Value {
    if let Some([x, y]) = value.as_array().map(Vec::as_slice) {
        return json!(Ned::from_xy(
            x.as_f64().unwrap_or_default(),
            y.as_f64().unwrap_or_default()
        ));
    }
    let Some(number) = value.as_f64() else {
        return value.clone();
    };
    if key.strip_suffix("_s") == Some(field) {
        return json!(SimTime::from_s(number));
    }
    Unit::of(key)
        .map_or(number, |unit| (unit.to_si)(number))
        .into()
}
