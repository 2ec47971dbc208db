//! The cells of a row: nested values flattened, each under its path.

use primitives::SimTime;
use serde_json::Value;
use std::collections::BTreeMap;

/// Cell contents, by column name.
pub(super) type Cells = BTreeMap<String, String>;

/// The cells in column order, time first.
pub(super) fn in_order(mut cells: Cells, at: SimTime, columns: &[String]) -> Vec<String> {
    let rest = columns
        .iter()
        .skip(1)
        .map(|column| cells.remove(column).unwrap_or_default());
    std::iter::once(time(at)).chain(rest).collect()
}

/// A time in s, without superfluous digits; empty for times before the game.
pub(super) fn time(at: SimTime) -> String {
    if at <= SimTime::LONG_AGO {
        String::new()
    } else {
        (at.0 as f64 / 1e9).to_string()
    }
}

/// A string without quotes; any other value as JSON.
pub(super) fn text(leaf: &Value) -> String {
    leaf.as_str()
        .map_or_else(|| leaf.to_string(), str::to_owned)
}

/// The leaves of a value, by path. Nulls are omitted.
pub(super) fn flat(value: &Value) -> BTreeMap<String, Value> {
    let mut leaves = BTreeMap::new();
    lay("", value, &mut leaves);
    leaves
}

fn lay(path: &str, value: &Value, leaves: &mut BTreeMap<String, Value>) {
    let below = |name: &str| {
        if path.is_empty() {
            name.to_owned()
        } else {
            format!("{path}.{name}")
        }
    };
    match value {
        Value::Object(fields) => fields
            .iter()
            .for_each(|(name, value)| lay(&below(name), value, leaves)),
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                match named(item) {
                    Some((name, value)) => lay(&below(name), value, leaves),
                    None => lay(&below(&i.to_string()), item, leaves),
                }
            }
        }
        Value::Null => {}
        // A value at the top level has no path.
        leaf => drop(leaves.insert(
            if path.is_empty() { "value" } else { path }.to_owned(),
            leaf.clone(),
        )),
    }
}

/// A list of a name and a number is a named number: counts are written in this form.
fn named(item: &Value) -> Option<(&str, &Value)> {
    match item.as_array()?.as_slice() {
        [Value::String(name), value @ Value::Number(_)] => Some((name, value)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn nested_values_become_paths() {
        let value = json!({
            "a": {"b": 1.5, "none": null}, "list": [true, {"c": "x"}], "counts": [["sentences in", 7], ["lost", 0]],
        });
        let cells: Vec<(String, String)> = flat(&value)
            .iter()
            .map(|(name, leaf)| (name.clone(), text(leaf)))
            .collect();
        let want = [
            ("a.b", "1.5"),
            ("counts.lost", "0"),
            ("counts.sentences in", "7"),
            ("list.0", "true"),
            ("list.1.c", "x"),
        ];
        assert_eq!(
            cells,
            want.map(|(name, cell)| (name.to_owned(), cell.to_owned()))
        );
        assert_eq!(flat(&json!("pause")).get("value"), Some(&json!("pause")));
    }
}
