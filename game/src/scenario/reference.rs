//! The reference pages: every key of every kind of file, and every name in strategies, made from the types that declare them.

use super::kind::Kind;
use super::schema::{declared, may_be_empty, resolved};
use crate::strategy::{Boat, Fact, Mark, Measure, Named, What, Who};
use serde_json::Value;
use std::fmt::Write;

/// What stands before the tables of all files but strategies.
const FILES: &str = "\
# Scenario files: reference

Every key, with its range, its default and its meaning; examples stand in [the handbook](README.md), and strategies have [a
page of their own](strategies/REFERENCE.md). This page is made from the program's types:
`SQUALL_BLESS=1 cargo test -p squall-game --test strategy_reference` brings it into step.

Any file may name another one of its kind as `base`. In boat and sea files, and in the tables `link` and `sharing`, a number may
be a distribution.
";

/// What stands before the tables of strategies.
const OPENING: &str = "\
# Strategy files: reference

Every key and every name, with what it means. How they work together is told in [the handbook](../README.md), section
*A strategy*. This page is made from the program's types: `squall strategy --reference` prints it, and
`SQUALL_BLESS=1 cargo test -p squall-game --test strategy_reference` brings it into step.

Where a type is *number or expression*, a text is an [expression](#expressions), evaluated anew at every decision; a
value outside of the range then counts as the nearest one inside.
";

/// How expressions are written.
const EXPRESSIONS: &str = "\
## Expressions

Expressions are written in [CEL](https://cel.dev), the Common Expression Language, of which these are allowed. All
numbers are doubles: `5 / 2` is 2.5, and `5` and `5.0` are the same. Division by 0 gives 0. At most 1000 characters, and
30 levels of nesting.

| binds | operators | meaning |
|---|---|---|
| tightest | `!a` `-a` | not, minus |
| | `a * b` `a / b` | product, quotient |
| | `a + b` `a - b` | sum, difference |
| | `a < b` `a <= b` `a > b` `a >= b` `a == b` `a != b` | comparisons; texts only with `==` and `!=`, and one of the values of the variable |
| | `a && b` | both |
| | `a \\|\\| b` | one at least |
| loosest | `a ? b : c` | b if a is true, else c |

| value | meaning |
|---|---|
| `2` `0.5` `1e3` | a number |
| `true` `false` | a truth |
| `'go'` `\"go\"` | a text, beside a text variable |
| a name | a variable or a fact |
| `min(a, b)` `max(a, b)` | the smaller and the greater one |
| `mates(condition)` | how many other boats of the own team there are for which the condition holds, with their values of shared variables; nothing but shared variables is known in it |
";

/// The page of all kinds of files but strategies, in Markdown.
#[must_use]
pub fn file_reference() -> String {
    let mut page = FILES.to_owned();
    for kind in Kind::ALL.into_iter().filter(|kind| *kind != Kind::Strategy) {
        let root = declared(kind);
        tables(&mut page, root, &format!("## `{}/`", kind.folder()), "", root);
    }
    page
}

/// The table of what stands at `path`, and those of the tables in it.
fn tables(page: &mut String, root: &Value, heading: &str, path: &str, about: &Value) {
    table(page, root, &format!("{heading}\n\n{}", description(about)), about, |key| key != "base");
    for (key, about) in about["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let (one, item) = (resolved(about, root), resolved(&resolved(about, root)["items"], root));
        for (about, heading) in [(one, format!("### `{path}`")), (item, format!("### `[[{path}]]`"))] {
            if about.get("properties").is_some() {
                tables(page, root, &heading, &path, about);
            }
        }
    }
}

/// The page of strategies, in Markdown.
#[must_use]
pub fn reference() -> String {
    let root = declared(Kind::Strategy);
    let mut page = OPENING.to_owned();
    table(&mut page, root, "## The file", root, |_| true);
    for (name, heading) in [
        ("Helm", "## `helm`"),
        ("Variable", "## A variable as a table"),
        ("Mode", "## `[[mode]]`"),
        ("Rule", "## `[[rule]]`"),
    ] {
        table(&mut page, root, heading, &root["definitions"][name], |_| true);
    }
    let quoted = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let (who, what) = (quoted(&Who::names()), quoted(&What::names()));
    let _ = write!(page, "\n`on` is one of {who}, then one of {what}: `\"enemy grabs\"`.\n\n{EXPRESSIONS}");
    names(&mut page);
    behaviours(&mut page, root);
    choices(&mut page, root);
    page
}

/// The keys that have a few words to choose from, and what each means.
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
        let _ = writeln!(page, "| `{name}(place)` | {} | {meaning} |", kind(measure.is_truth()));
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
    // A full stop has the keys of all kinds and none of its own.
    let common = &root["definitions"]["FullStop"];
    table(page, root, "## `[behaviour.NAME]`\n\nWhat every kind has.", common, |_| true);
    for kind in root["properties"]["behaviour"]["additionalProperties"]["oneOf"].as_array().into_iter().flatten() {
        let about = resolved(kind, root);
        let name = about["properties"]["kind"]["const"].as_str().unwrap_or_default();
        let heading = format!("### `{name}`\n\n{}", description(about));
        table(page, root, &heading, about, |key| common["properties"].get(key).is_none());
        if name == "loiter" {
            table(page, root, "#### `ellipse`", &root["definitions"]["Ellipse"], |_| true);
        }
    }
}

/// A heading and a table of the keys that are `wanted`, first those that are required.
fn table(page: &mut String, root: &Value, heading: &str, about: &Value, wanted: impl Fn(&str) -> bool) {
    let _ = write!(page, "\n{heading}\n");
    let required: Vec<&str> = about["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let keys = about["properties"].as_object().into_iter().flatten().filter(|(key, _)| wanted(key));
    let is_required = |key: &str, about| required.contains(&key) && !may_be_empty(about, root);
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
            _ => type_of(about, root),
        };
        let _ = writeln!(page, "| `{key}` | {kind} | {} | {default} | {} |", range(about), description(about));
    }
}

fn description(about: &Value) -> String {
    about["description"].as_str().unwrap_or_default().replace('\n', " ")
}

/// From the least to the most that a number may be, or a list long.
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
    about["minItems"] == 2 && about["maxItems"] == 2 && about["items"].get("$ref").is_none()
}

/// The type that a schema describes, in words.
fn type_of(about: &Value, root: &Value) -> String {
    let about = resolved(about, root);
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
        "array" => format!("list of {}s", type_of(&about["items"], root)),
        name => name.to_owned(),
    }
}
