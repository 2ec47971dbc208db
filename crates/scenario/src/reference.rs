//! The reference pages: every key of every kind of file, and every name in strategies, generated
//! from the types that declare them.

use super::kind::Kind;
use super::schema::{TABLE, declared, may_be_empty};
use crate::strategy::{Boat, Fact, Mark, Measure, Named, What, Who};
use serde_json::Value;
use std::fmt::Write;

/// Introduction to the tables of all files but strategies.
const FILES: &str = include_str!("reference/files.md");

/// Introduction to the tables of strategies.
const OPENING: &str = include_str!("reference/strategies.md");

/// The syntax of expressions.
const EXPRESSIONS: &str = include_str!("reference/expressions.md");

/// The page of these kinds of files except strategies, in Markdown.
#[must_use]
pub fn file_reference(kinds: &[Kind]) -> String {
    let mut page = FILES.to_owned();
    for kind in kinds.iter().filter(|kind| **kind != Kind::STRATEGY) {
        let root = declared(*kind);
        tables(&mut page, &format!("## `{}/`", kind.folder()), "", root);
    }
    page
}

/// The table of the keys at `path`, and those of the tables in it.
fn tables(page: &mut String, heading: &str, path: &str, about: &Value) {
    table(
        page,
        &format!("{heading}\n\n{}", in_a_line(about.get(TABLE).unwrap_or(&about["description"]))),
        about,
        |key| key != "base",
    );
    for (key, about) in about["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        for (about, heading) in [(about, format!("### `{path}`")), (&about["items"], format!("### `[[{path}]]`"))] {
            if about.get("properties").is_some() {
                tables(page, &heading, &path, about);
            }
        }
    }
}

/// The page of strategies, in Markdown.
#[must_use]
pub fn reference() -> String {
    let root = declared(Kind::STRATEGY);
    let mut page = OPENING.to_owned();
    table(&mut page, "## The file", root, |_| true);
    for (name, heading) in [
        ("Helm", "## `helm`"),
        ("Variable", "## A variable as a table"),
        ("Mode", "## `[[mode]]`"),
        ("Rule", "## `[[rule]]`"),
    ] {
        table(&mut page, heading, &root["definitions"][name], |_| true);
    }
    let quoted = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let (who, what) = (quoted(&Who::names()), quoted(&What::names()));
    let _ = write!(page, "\n`on` is one of {who}, then one of {what}: `\"enemy grabs\"`.\n\n{EXPRESSIONS}");
    names(&mut page);
    behaviours(&mut page, root);
    choices(&mut page, root);
    page
}

/// The keys with a choice of words, and the meaning of each word.
fn choices(page: &mut String, root: &Value) {
    page.push_str("\n## Choices\n\n| key | choice | meaning |\n|---|---|---|\n");
    for (key, name) in [
        ("assignment", "Assignment"),
        ("turn", "Turn"),
        ("contacts", "Contacts"),
        ("grade", "Grade"),
        ("by", "Proposer"),
    ] {
        for choice in root["definitions"][name]["oneOf"].as_array().into_iter().flatten() {
            let _ = writeln!(page, "| `{key}` | `{}` | {} |", choice["const"], description(choice));
        }
    }
}

fn names(page: &mut String) {
    let kind = |is_truth: bool| if is_truth { "truth" } else { "number" };
    page.push_str("\n### Facts\n\n| name | is a | meaning |\n|---|---|---|\n");
    for fact in Fact::all() {
        let _ = writeln!(page, "| `{}` | {} | {} |", fact.name(), kind(fact.is_truth()), fact.meaning());
    }
    page.push_str("\n### Measures\n\nOf a place or a boat, by its name.\n\n| call | is a | meaning |\n|---|---|---|\n");
    for measure in Measure::all() {
        let (name, meaning) = (measure.name(), measure.meaning());
        let two = if measure.is_of_two() { format!(" `{name}(place, place)`") } else { String::new() };
        let _ = writeln!(page, "| `{name}(place)`{two} | {} | {meaning} |", kind(measure.is_truth()));
    }
    page.push_str(
        "\n## Places\n\nA place is `[x, y]`, a named point of the own team such as `CFX`, or one of these.\n",
    );
    page.push_str("\n| place | what it is |\n|---|---|\n");
    for mark in Mark::all() {
        let _ = writeln!(page, "| `{}` | {} |", mark.name(), mark.meaning());
    }
    page.push_str("\n| boat | which it is |\n|---|---|\n");
    for boat in Boat::all() {
        let _ = writeln!(page, "| `{}` | {} |", boat.name(), boat.meaning());
    }
}

fn behaviours(page: &mut String, root: &Value) {
    // A full stop has the common keys of all kinds and none of its own.
    let common = &root["definitions"]["FullStop"];
    table(page, "## `[behaviour.NAME]`\n\nWhat every kind has.", common, |_| true);
    for about in root["properties"]["behaviour"]["additionalProperties"]["oneOf"].as_array().into_iter().flatten() {
        let name = about["properties"]["kind"]["const"].as_str().unwrap_or_default();
        let heading = format!("### `{name}`\n\n{}", description(about));
        table(page, &heading, about, |key| common["properties"].get(key).is_none());
        if name == "loiter" {
            table(page, "#### `ellipse`", &root["definitions"]["Ellipse"], |_| true);
        }
    }
}

/// A heading and a table of the keys that are `wanted`, required ones first.
fn table(page: &mut String, heading: &str, about: &Value, wanted: impl Fn(&str) -> bool) {
    let _ = write!(page, "\n{heading}\n");
    let required: Vec<&str> = about["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let keys = about["properties"].as_object().into_iter().flatten().filter(|(key, _)| wanted(key));
    let is_required = |key: &str, about| required.contains(&key) && !may_be_empty(about);
    let (first, rest): (Vec<_>, Vec<_>) = keys.partition(|(key, about)| is_required(key, about));
    if first.is_empty() && rest.is_empty() {
        return;
    }
    page.push_str("\n| key | type | range | default | meaning |\n|---|---|---|---|---|\n");
    for (key, about) in first.into_iter().chain(rest) {
        let default = match about.get("default") {
            None if is_required(key, about) => "*required*".to_owned(),
            None | Some(Value::Object(_)) => String::new(),
            Some(default) => default.to_string(),
        };
        let kind = match key.as_str() {
            "kind" => "text: one of those below".to_owned(),
            "when" => "expression".to_owned(),
            _ => type_of(about),
        };
        let _ = writeln!(page, "| `{key}` | {kind} | {} | {default} | {} |", range(about), description(about));
    }
}

fn description(about: &Value) -> String {
    in_a_line(&about["description"])
}

fn in_a_line(text: &Value) -> String {
    text.as_str().unwrap_or_default().replace('\n', " ")
}

/// The allowed range of a number, or of a list's length.
fn range(about: &Value) -> String {
    let about = if is_pair(about) { &about["items"] } else { about };
    let bound = |keys: [&str; 2]| {
        let bound = keys.into_iter().find_map(|key| about.get(key))?;
        bound.as_i64().map(|whole| whole.to_string()).or(bound.as_f64().map(|number| number.to_string()))
    };
    match (bound(["minimum", "minItems"]), bound(["maximum", "maxItems"])) {
        (Some(least), Some(most)) if least == most => least,
        (Some(least), Some(most)) => format!("{least} to {most}"),
        (Some(least), None) => format!("at least {least}"),
        (None, Some(most)) => format!("at most {most}"),
        (None, None) => String::new(),
    }
}

/// Whether it is a list of two numbers.
fn is_pair(about: &Value) -> bool {
    about["minItems"] == 2 && about["maxItems"] == 2 && about["items"].get("properties").is_none()
}

/// The type in a schema, in words.
fn type_of(about: &Value) -> String {
    match about["title"].as_str() {
        Some("a number or an expression") => return "number or expression".to_owned(),
        Some(title @ ("boat" | "place")) => return title.to_owned(),
        _ => {}
    }
    if let Some(choices) = about["oneOf"].as_array() {
        return choices.iter().map(|choice| format!("`{}`", choice["const"])).collect::<Vec<_>>().join(", ");
    }
    match about["anyOf"][0]["type"].as_str() {
        Some("array") => return "pair of numbers, or text".to_owned(),
        Some(_) => return "number, truth or text".to_owned(),
        None => {}
    }
    match about["type"].as_str().unwrap_or_default() {
        "integer" => "whole number".to_owned(),
        "boolean" => "truth".to_owned(),
        "string" => "text".to_owned(),
        "object" => "table".to_owned(),
        "array" if is_pair(about) => "pair of numbers".to_owned(),
        "array" if is_pair(&about["items"]) => "list of pairs of numbers".to_owned(),
        "array" => format!("list of {}s", type_of(&about["items"])),
        name => name.to_owned(),
    }
}
