//! The reference page of strategy files: every key and every name, made from the types that read them.

use super::kind::Kind;
use super::raw::{COMMON_KEYS, RawEllipse, RawHelm, RawMode, RawRule, RawStrategy, Stated, keys_of, kinds};
use super::schema::schema;
use crate::strategy::{Boat, Fact, Mark, Measure, What, Who};
use serde_json::Value;
use std::fmt::Write;

/// What stands before the tables.
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

/// The page, in Markdown.
#[must_use]
pub fn reference() -> String {
    let schema = schema(Kind::Strategy);
    let mut page = OPENING.to_owned();
    table(&mut page, &schema, "## The file", "", &schema, &keys_of::<RawStrategy>());
    for (name, keys, heading) in [
        ("Helm", keys_of::<RawHelm>(), "## `helm`"),
        ("Variable", keys_of::<Stated>(), "## A variable as a table"),
        ("Mode", keys_of::<RawMode>(), "## `[[mode]]`"),
        ("Rule", keys_of::<RawRule>(), "## `[[rule]]`"),
    ] {
        table(&mut page, &schema, heading, "", &schema["definitions"][name], &keys);
    }
    events(&mut page);
    page.push('\n');
    page.push_str(EXPRESSIONS);
    names(&mut page);
    behaviours(&mut page, &schema);
    choices(&mut page, &schema);
    page
}

/// The keys that have a few words to choose from, and what each means.
fn choices(page: &mut String, schema: &Value) {
    page.push_str("\n## Choices\n\n| key | choice | meaning |\n|---|---|---|\n");
    for (key, name) in [("assignment", "Assignment"), ("turn", "Turn"), ("contacts", "Contacts"), ("grade", "Grade")] {
        for choice in schema["definitions"][name]["oneOf"].as_array().into_iter().flatten() {
            let (word, meaning) = (choice["const"].as_str(), choice["description"].as_str());
            let (word, meaning) = (word.unwrap_or_default(), meaning.unwrap_or_default());
            let _ = writeln!(page, "| `{key}` | `{word:?}` | {meaning} |");
        }
    }
}

fn events(page: &mut String) {
    let quoted = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let (who, what) = (quoted(&Who::ALL.map(Who::name)), quoted(&What::ALL.map(What::name)));
    let _ = write!(page, "\n`on` is one of {who}, then one of {what}: `\"enemy grabs\"`.\n");
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

fn behaviours(page: &mut String, schema: &Value) {
    let definitions = &schema["definitions"];
    let mut common = vec!["kind".to_owned()];
    common.extend(COMMON_KEYS.map(str::to_owned));
    // The keys of all are those of each.
    let any = &definitions["behaviour_timer"];
    table(page, schema, "## `[behaviour.NAME]`", "What every kind has.", any, &common);
    for kind in kinds() {
        let about = &definitions[format!("behaviour_{}", kind.name)];
        let says = about["description"].as_str().unwrap_or_default();
        table(page, schema, &format!("### `{}`", kind.name), says, about, &(kind.keys)());
        if kind.name == "loiter" {
            let ellipse = keys_of::<RawEllipse>();
            table(page, schema, "#### `ellipse`", "", &definitions["Ellipse"], &ellipse);
        }
    }
}

/// A heading, what it says below, and a table of keys.
fn table(page: &mut String, schema: &Value, heading: &str, says: &str, about: &Value, keys: &[String]) {
    let _ = write!(page, "\n{heading}\n");
    if !says.is_empty() {
        let _ = write!(page, "\n{says}\n");
    }
    if keys.is_empty() {
        return;
    }
    page.push_str("\n| key | type | range | default | meaning |\n|---|---|---|---|---|\n");
    for key in keys {
        let about = &about["properties"][key];
        let description = about["description"].as_str().unwrap_or_default().replace('\n', " ");
        let (range, default, meaning) = parts(&description);
        let kind = match key.as_str() {
            "kind" => "text: one of those below".to_owned(),
            "when" => "expression".to_owned(),
            _ => type_of(schema, about),
        };
        let _ = writeln!(page, "| `{key}` | {kind} | {range} | {default} | {meaning} |");
    }
}

/// Range, default and meaning out of a description: `Speed, m/s: 0 to 60. Default 5.`
fn parts(description: &str) -> (String, String, String) {
    let split = |word: &str| description.split_once(&format!(" {word}"));
    let (meaning, default) = match (split("Default "), split("Required")) {
        (Some((meaning, default)), _) => (meaning, default.trim_end_matches('.').to_owned()),
        (None, Some((meaning, rest))) => (meaning, format!("*required{}*", rest.trim_end_matches('.'))),
        (None, None) => (description, String::new()),
    };
    let meaning = meaning.trim_end_matches('.');
    let starts_with_number = |range: &str| range.trim_start_matches('-').starts_with(|c: char| c.is_ascii_digit());
    match meaning.rsplit_once(": ") {
        Some((head, range)) if starts_with_number(range) && range.contains(" to ") => {
            let (range, rest) = range.split_once(". ").unwrap_or((range, ""));
            let rest = if rest.is_empty() { String::new() } else { format!(". {rest}") };
            (range.trim_end_matches(" of them").to_owned(), default, format!("{head}{rest}."))
        }
        _ => (String::new(), default, format!("{meaning}.")),
    }
}

/// The type that a schema describes, in words.
fn type_of(schema: &Value, about: &Value) -> String {
    let about = match about["allOf"][0]["$ref"].as_str() {
        Some(name) => &schema["definitions"][name.rsplit('/').next().unwrap_or_default()],
        None => about,
    };
    if let Some(choices) = about["oneOf"].as_array().or(about["enum"].as_array()) {
        let name = |choice: &Value| choice["const"].as_str().or(choice.as_str()).unwrap_or_default().to_owned();
        let names: Vec<String> = choices.iter().map(|choice| format!("`{:?}`", name(choice))).collect();
        return if names.len() > 4 { "text: a boat".to_owned() } else { names.join(", ") };
    }
    if about.get("anyOf").is_some() {
        return "place".to_owned();
    }
    match &about["type"] {
        Value::Array(types) if types.len() > 2 => "number, truth or text".to_owned(),
        Value::Array(_) => "number or expression".to_owned(),
        Value::String(name) => match name.as_str() {
            "integer" => "whole number".to_owned(),
            "boolean" => "truth".to_owned(),
            "string" => "text".to_owned(),
            "object" => "table".to_owned(),
            "array" => list_of(schema, &about["items"]),
            name => name.to_owned(),
        },
        _ => "text".to_owned(),
    }
}

fn list_of(schema: &Value, items: &Value) -> String {
    match items.get("$ref") {
        Some(_) => "list of tables".to_owned(),
        None => format!("list of {}s", type_of(schema, items)),
    }
}
