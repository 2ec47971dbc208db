//! The reference pages: every key of every kind of file, and every name in strategies, generated
//! from the types that declare them.

use super::kind::Kind;
use super::schema::{TABLE, declared, entries, is_required, may_be_empty, properties};
use super::setting::target_of;
use crate::strategy::{Boat, Fact, Mark, Measure, Named, What, Who};
use serde_json::Value;
use std::fmt::Write;

/// Introduction to the tables of all files except strategies.
const FILES: &str = include_str!("reference/files.md");

/// Introduction to the tables of strategies.
const OPENING: &str = include_str!("reference/strategies.md");

/// The syntax of expressions.
const EXPRESSIONS: &str = include_str!("reference/expressions.md");

/// The page of these kinds of files except strategies, in Markdown.
pub fn file_reference(kinds: &[Kind]) -> String {
    let mut page = FILES.to_owned();
    for kind in kinds.iter().filter(|kind| **kind != Kind::STRATEGY) {
        let mut sections = vec![];
        collect(
            &mut sections,
            &format!("## `{}/`", kind.folder()),
            "",
            (declared(*kind), ""),
        );
        for section in sections {
            let _ = write!(page, "\n{}\n{}", section.heading, section.text);
        }
    }
    page
}

/// A heading, with the text and the table below it.
struct Section {
    heading: String,
    text: String,
}

/// Collects the section for the keys at `path`, described as `said` in the table above, and the
/// sections for nested tables. Equal tables share a section.
fn collect(sections: &mut Vec<Section>, heading: &str, path: &str, (about, said): (&Value, &str)) {
    let mut text = in_a_line(about.get(TABLE).unwrap_or(&about["description"]));
    text = if text.is_empty() || text == said {
        String::new()
    } else {
        format!("\n{text}\n")
    };
    table(&mut text, about, |key, about| {
        key != "base" && about.get("const").is_none()
    });
    match sections.iter_mut().find(|section| section.text == text) {
        Some(section) => section.heading.push_str(&heading.replacen("###", ",", 1)),
        None => sections.push(Section {
            heading: heading.to_owned(),
            text,
        }),
    }
    for (key, about) in properties(about) {
        let path = if path.is_empty() {
            key.to_owned()
        } else {
            format!("{path}.{key}")
        };
        let said = description(about);
        for (about, heading) in [
            (about, format!("### `{path}`")),
            (&about["items"], format!("### `[[{path}]]`")),
            (
                &about["additionalProperties"],
                format!("### `[{path}.NAME]`"),
            ),
        ] {
            if about.get("properties").is_some() {
                collect(sections, &heading, &path, (about, &said));
            }
        }
        for choice in entries(about, "oneOf") {
            if properties(choice).nth(1).is_some() {
                let heading = format!(
                    "### `{path}` of kind {}",
                    choice["properties"]["kind"]["const"]
                );
                collect(sections, &heading, &path, (choice, &said));
            }
        }
    }
}

/// The page of strategies, in Markdown.
pub fn reference() -> String {
    let root = declared(Kind::STRATEGY);
    let mut page = OPENING.to_owned();
    page.push_str("\n## The file\n");
    table(&mut page, root, |_, _| true);
    for (name, heading) in [
        ("Helm", "`helm`"),
        ("Variable", "A variable as a table"),
        ("Mode", "`[[mode]]`"),
        ("Rule", "`[[rule]]`"),
    ] {
        let _ = write!(page, "\n## {heading}\n");
        table(&mut page, &root["definitions"][name], |_, _| true);
    }
    let quoted = |names: &[&str]| {
        let names: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
        names.join(", ")
    };
    let who = quoted(&Who::names());
    let what = quoted(&What::names());
    let _ = write!(
        page,
        "\n`on` is one of {who}, then one of {what}: `\"enemy grabs\"`.\n\n{EXPRESSIONS}"
    );
    names(&mut page);
    behaviours(&mut page, root);
    choices(&mut page, root);
    page
}

/// The keys with a choice of words, and the meaning of each word.
fn choices(page: &mut String, root: &Value) {
    page.push_str("\n## Choices\n\n| key | choices |\n|---|---|\n");
    for (key, name) in [
        ("assignment", "Assignment"),
        ("turn", "Turn"),
        ("contacts", "Contacts"),
        ("grade", "Grade"),
        ("beyond_halt", "BeyondHalt"),
        ("by", "Proposer"),
    ] {
        let choices: Vec<_> = entries(&root["definitions"][name], "oneOf")
            .map(|choice| format!("`{}`: {}", choice["const"], description(choice)))
            .collect();
        let _ = writeln!(page, "| `{key}` | {} |", choices.join("<br>"));
    }
}

fn names(page: &mut String) {
    page.push_str("\n### Facts\n");
    for (is_truth, kind) in [(true, "truth"), (false, "number")] {
        let _ = write!(page, "\n| {kind} | meaning |\n|---|---|\n");
        for fact in Fact::all()
            .iter()
            .filter(|fact| fact.is_truth() == is_truth)
        {
            let _ = writeln!(page, "| `{}` | {} |", fact.name(), line(fact.meaning()));
        }
    }
    page.push_str("\n### Measures\n\nProperties of a place or boat.\n");
    for (is_truth, kind) in [(true, "truth"), (false, "number")] {
        let _ = write!(page, "\n| {kind} | meaning |\n|---|---|\n");
        for measure in Measure::all()
            .iter()
            .filter(|measure| measure.is_truth() == is_truth)
        {
            let name = measure.name();
            let meaning = line(measure.meaning());
            let two = if measure.is_of_two() {
                format!(" `{name}(from, to)`")
            } else {
                String::new()
            };
            let _ = writeln!(page, "| `{name}(place)`{two} | {meaning} |");
        }
    }
    page.push_str("\n## Places\n\nA place is `[x, y]`, a named point of the team such as `CFX`, or one of the following; if several match, the nearest is used.\n");
    page.push_str("\n| place | meaning |\n|---|---|\n");
    for mark in Mark::all() {
        let _ = writeln!(page, "| `{}` | {} |", mark.name(), line(mark.meaning()));
    }
    page.push_str("\n| boat | meaning |\n|---|---|\n");
    for boat in Boat::all() {
        let _ = writeln!(page, "| `{}` | {} |", boat.name(), line(boat.meaning()));
    }
}

fn behaviours(page: &mut String, root: &Value) {
    // `full_stop` has the common keys of all kinds, and no others.
    let common = &root["definitions"]["FullStop"];
    page.push_str("\n## `[behaviour.NAME]`\n\nKeys of every kind of behaviour. Speeds are limited to the boat's top speed.\n");
    table(page, common, |_, _| true);
    let behaviour = &root["properties"]["behaviour"];
    for about in entries(&behaviour["additionalProperties"], "oneOf") {
        let kind = &about["properties"]["kind"];
        let name = kind["const"].as_str().unwrap_or_default();
        let _ = write!(page, "\n### `{name}`\n\n{}\n", description(about));
        table(page, about, |key, _| {
            common["properties"].get(key).is_none()
        });
        if name == "loiter" {
            page.push_str("\n#### `ellipse`\n");
            table(page, &root["definitions"]["Ellipse"], |_, _| true);
        }
    }
}

/// A table of the keys that are `wanted`, required keys first. The default, in brackets, is that of
/// the schema, or else the last sentence of the description.
fn table(page: &mut String, about: &Value, wanted: impl Fn(&str, &Value) -> bool) {
    let keys = properties(about).filter(|(key, about)| wanted(key, about));
    let is_required = |key: &str, value| is_required(about, key) && !may_be_empty(value);
    let (first, rest): (Vec<_>, Vec<_>) = keys.partition(|(key, about)| is_required(key, about));
    if first.is_empty() && rest.is_empty() {
        return;
    }
    page.push_str("\n| key |||\n|---|---|---|\n");
    for (key, about) in first.into_iter().chain(rest) {
        let text = description(about);
        let (meaning, described) = text.split_once("Default: ").unwrap_or((&text, ""));
        let default = match about.get("default") {
            None | Some(Value::Object(_) | Value::Null) => {
                described.trim_end_matches('.').to_owned()
            }
            Some(default) => default.to_string(),
        };
        let value = if key == "when" {
            "condition".to_owned()
        } else {
            value_of(about)
        };
        let default = if default.is_empty() {
            default
        } else {
            format!(" ({default})")
        };
        let bold = if is_required(key, about) { "**" } else { "" };
        let _ = writeln!(
            page,
            "| {bold}`{key}`{bold} | {value}{default} | {} |",
            meaning.trim_end()
        );
    }
}

/// The meaning of a setting's key, such as `sea.wind.speed_m_s`, as in the reference; `None` for an
/// unknown key.
pub fn meaning(key: &str) -> Option<String> {
    let (kind, key) = target_of(key)?;
    let about = key.split('.').try_fold(declared(kind), key_in)?;
    let text = description(about);
    let meaning = text
        .split_once(" Default: ")
        .map_or(text.as_str(), |(meaning, _)| meaning);
    (!meaning.is_empty()).then(|| meaning.to_owned())
}

/// The schema of a key of a table: one of its own keys, any name, or a key of one of its kinds.
fn key_in<'a>(about: &'a Value, key: &str) -> Option<&'a Value> {
    let named = || Some(&about["additionalProperties"]).filter(|named| named.is_object());
    let mut kinds = entries(about, "oneOf").chain(entries(about, "anyOf"));
    let own = about["properties"].get(key).or_else(named);
    own.or_else(|| kinds.find_map(|kind| key_in(kind, key)))
}

fn description(about: &Value) -> String {
    in_a_line(&about["description"])
}

fn in_a_line(text: &Value) -> String {
    line(text.as_str().unwrap_or_default())
}

/// A string on one line, as a cell of a table.
fn line(text: &str) -> String {
    text.trim().replace('\n', " ").replace('|', "\\|")
}

/// The allowed range of a number, or of a list's length.
fn range(about: &Value) -> String {
    let bound = |keys: [&str; 2]| {
        let bound = keys.into_iter().find_map(|key| about.get(key))?;
        let number = || bound.as_f64().map(|number| number.to_string());
        let whole = bound.as_i64().map(|whole| whole.to_string());
        whole.or_else(number)
    };
    match (
        bound(["minimum", "minItems"]),
        bound(["maximum", "maxItems"]),
    ) {
        (Some(least), Some(most)) if least == most => least,
        (Some(least), Some(most)) => format!("{least}..{most}"),
        (Some(least), None) => format!("{least} or more"),
        (None, Some(most)) => format!("up to {most}"),
        (None, None) => String::new(),
    }
}

/// Whether a list contains exactly two numbers.
fn is_pair(about: &Value) -> bool {
    about["minItems"] == 2 && about["maxItems"] == 2 && about["items"].get("properties").is_none()
}

/// The allowed values, in plain language; for numbers, the range alone.
fn value_of(about: &Value) -> String {
    if let Some(choices) = about["oneOf"].as_array() {
        return choices.iter().map(choice).collect::<Vec<_>>().join(", ");
    }
    let is_expression = about["title"] == "a number or an expression";
    let (kind, range) = match about["type"].as_str() {
        Some("array") if !is_pair(about) => {
            let list = [range(about), items_of(&about["items"])].join(" ");
            return list.trim().to_owned();
        }
        Some("array") => ("pair".to_owned(), range(&about["items"])),
        _ => (kind_of(about), range(about)),
    };
    match (kind.as_str(), range.as_str()) {
        (_, "") => kind,
        _ if is_expression => format!("{range}\\*"),
        ("number", _) => range,
        _ => format!("{kind}, {range}"),
    }
}

/// One of several values: a string, or a table by its kind and keys.
fn choice(about: &Value) -> String {
    match about["properties"].as_object() {
        Some(keys) => {
            let others = keys.keys().filter(|key| *key != "kind");
            let others: String = others.map(|key| format!(", {key}")).collect();
            format!("`{{ kind = {}{others} }}`", keys["kind"]["const"])
        }
        None => format!("`{}`", about["const"]),
    }
}

/// The type of a list's entries.
fn items_of(about: &Value) -> String {
    match about["oneOf"].as_array() {
        Some(choices) => format!(
            "of {}",
            choices.iter().map(choice).collect::<Vec<_>>().join(", ")
        ),
        None if about.get("anyOf").is_some() && about.get("title").is_none() => "values".to_owned(),
        None if is_pair(about) => "pairs".to_owned(),
        None if about["type"] == "array" => format!("lists of {}", items_of(&about["items"])),
        None => format!("{}s", kind_of(about)),
    }
}

/// The type in a schema, in plain language.
fn kind_of(about: &Value) -> String {
    if let Some(title @ ("boat" | "place")) = about["title"].as_str() {
        return title.to_owned();
    }
    match about["anyOf"][0]["type"].as_str() {
        Some("array") => return "pair or string".to_owned(),
        Some(_) => return "number, boolean or string".to_owned(),
        None => {}
    }
    match about["type"].as_str().unwrap_or_default() {
        "string" if about.get("const").is_some() => "one of those below".to_owned(),
        "string" if about["x-expected"] == "the path of a file" => "path".to_owned(),
        "object" => "table".to_owned(),
        name => name.to_owned(),
    }
}
