//! JSON laid flat: a column for every path that occurs in any message of the topic.

use super::SheetError;
use super::row::Row;
use recording::{Recording, Said};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn write(recording: &Recording, topic: &str, row: &mut Row<'_>) -> Result<(), SheetError> {
    // Which columns there are is known only when all is read; the messages are few.
    let mut columns = BTreeSet::new();
    for said in recording.on(topic) {
        columns.extend(flat(&said)?.into_keys());
    }
    for said in recording.on(topic) {
        let mut cells = flat(&said)?;
        super::begin(row, &said);
        for column in &columns {
            row.put(column, cells.remove(column).unwrap_or_default());
        }
        row.end()?;
    }
    Ok(())
}

fn flat(said: &Said<'_>) -> Result<BTreeMap<String, String>, SheetError> {
    let strange = |reason| SheetError::Json { topic: said.topic.to_owned(), number: said.number, reason };
    let value: Value = serde_json::from_slice(said.bytes).map_err(strange)?;
    let mut cells = BTreeMap::new();
    lay("", &value, &mut cells);
    Ok(cells)
}

fn lay(path: &str, value: &Value, cells: &mut BTreeMap<String, String>) {
    let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| lay(&below(name), value, cells)),
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                match named(item) {
                    Some((name, value)) => lay(&below(name), value, cells),
                    None => lay(&below(&i.to_string()), item, cells),
                }
            }
        }
        Value::Null => {}
        Value::String(text) => drop(cells.insert(word(path), text.clone())),
        other => drop(cells.insert(word(path), other.to_string())),
    }
}

/// A list of a name and a number is a number with a name: counts are told so.
fn named(item: &Value) -> Option<(&str, &Value)> {
    match item.as_array()?.as_slice() {
        [Value::String(name), value @ Value::Number(_)] => Some((name, value)),
        _ => None,
    }
}

/// What is not within anything is called what it is.
fn word(path: &str) -> String {
    if path.is_empty() { "value".to_owned() } else { path.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_values_become_paths() {
        let value = serde_json::json!({
            "a": {"b": 1.5, "none": null}, "list": [true, {"c": "x"}], "counts": [["sentences in", 7], ["lost", 0]],
        });
        let mut cells = BTreeMap::new();
        lay("", &value, &mut cells);
        let cells: Vec<(&str, &str)> = cells.iter().map(|(name, cell)| (name.as_str(), cell.as_str())).collect();
        let want =
            [("a.b", "1.5"), ("counts.lost", "0"), ("counts.sentences in", "7"), ("list.0", "true"), ("list.1.c", "x")];
        assert_eq!(cells, want);
        let mut cells = BTreeMap::new();
        lay("", &serde_json::json!("pause"), &mut cells);
        assert_eq!(cells.get("value").map(String::as_str), Some("pause"));
    }
}
