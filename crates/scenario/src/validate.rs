//! Reads a tree by the schema of its kind: reports every mistake, draws distributions, fills in
//! defaults.
//!
//! The result always satisfies the schema. A default, or else the minimum or an empty string,
//! replaces a faulty or missing value, so that later checks can find more faults.
//! `Document::is_sound` returns whether a value is from the file.

use super::diagnostics::{NAME_EXPECTED, NAME_PATTERN, is_name, keys_of};
use super::draw::{Owner, distribution_kind, draw};
use super::field_value::by_fields;
use super::guess::did_you_mean;
use super::loader::Loader;
use super::schema::{DRAWN, entries, is_required, properties};
use super::tree::{Node, Table, Value};
use super::unit::Unit;
use serde_json::{Map, Value as Json};

/// Reads `tree` by the schema `root`, with numbers drawn for `owner`; also returns the paths of
/// faults.
pub(super) fn validated<'a>(
    loader: &'a Loader,
    tree: &'a Node,
    root: &'a Json,
    owner: &'a str,
) -> (Json, Vec<String>) {
    let file = Owner {
        name: owner,
        path_from: 0,
    };
    let mut validator = Validator {
        loader,
        path: String::new(),
        file,
        owner: root.get(DRAWN).map(|_| file),
        wrong: vec![],
    };
    let value = validator.value(tree, root);
    (
        value.unwrap_or_else(|| validator.stand_in(root)),
        validator.wrong,
    )
}

struct Validator<'a> {
    loader: &'a Loader,
    /// Path from the root of the file to the current value, as in `team.1.name`.
    path: String,
    /// The owner of numbers that belong to the file as a whole.
    file: Owner<'a>,
    /// The owner for which numbers are drawn; `None` where distributions are not allowed.
    owner: Option<Owner<'a>>,
    /// The paths of faulty or missing values.
    wrong: Vec<String>,
}

impl<'a> Validator<'a> {
    /// The value of `node`, if it satisfies the schema.
    fn value(&mut self, node: &'a Node, schema: &'a Json) -> Option<Json> {
        // The crate `jsonschema` is not suitable: it checks JSON values, which have no positions
        // and cannot be NaN. If a table matches none of several kinds, it reports only that. It
        // also depends on regular expressions, host names and big fractions. This file covers the
        // part of JSON Schema that Squall's types use.
        if let Some(branches) = schema.get("anyOf").and_then(Json::as_array) {
            return match branches.iter().find(|branch| self.fits(node, branch)) {
                Some(branch) => self.value(node, branch),
                None => self.wrong_type(node, schema),
            };
        }
        match &node.value {
            Value::Table(table) if distribution_kind(table).is_some() && is_number(schema) => {
                self.distribution(node, table, schema)
            }
            _ if !self.fits(node, schema) => self.wrong_type(node, schema),
            Value::Table(table) if schema.get("oneOf").is_some() => {
                self.tagged(node, table, schema)
            }
            Value::Table(table) => Some(self.table(node, table, schema)),
            Value::List(items) => self.list(node, items, schema),
            Value::Text(text) => self.text(node, text, schema),
            Value::Truth(truth) => Some((*truth).into()),
            Value::Whole(_) | Value::Number(_) => self.number(node, schema),
            Value::Date(_) => None,
        }
    }

    /// Runs `read` one level deeper.
    fn below<T>(&mut self, part: &str, read: impl FnOnce(&mut Self) -> T) -> T {
        let length = self.path.len();
        if length > 0 {
            self.path.push('.');
        }
        self.path.push_str(part);
        let value = read(self);
        self.path.truncate(length);
        value
    }

    fn number(&mut self, node: &Node, schema: &Json) -> Option<Json> {
        let number = node.as_number()?;
        let bound = |key: &str, none: f64| schema.get(key).and_then(Json::as_f64).unwrap_or(none);
        if !number.is_finite()
            || !(bound("minimum", f64::MIN)..=bound("maximum", f64::MAX)).contains(&number)
        {
            let found = match number {
                // Written out, such a number would have up to 300 digits.
                large if large.is_finite() && large.abs() >= 1e15 => format!("{large:e}"),
                nan if nan.is_nan() => "nan".to_owned(),
                number => number.to_string(),
            };
            return self.wrong(node, &found, &allowed(schema));
        }
        Some(if let Value::Whole(whole) = node.value {
            whole.into()
        } else {
            number.into()
        })
    }

    /// A distribution in place of a number.
    fn distribution(&mut self, node: &Node, table: &Table, schema: &Json) -> Option<Json> {
        let Some(owner) = &self.owner else {
            return self.wrong_type(node, schema);
        };
        let is_whole = takes(schema, "integer");
        match draw(self.loader, node, table, owner, (&self.path, is_whole)) {
            Some(value) => {
                let drawn = Node { value, ..*node };
                if self.fits(&drawn, schema) {
                    self.number(&drawn, schema)
                } else {
                    self.wrong_type(&drawn, schema)
                }
            }
            None => {
                self.wrong.push(self.path.clone());
                None
            }
        }
    }

    fn text(&mut self, node: &Node, text: &str, schema: &Json) -> Option<Json> {
        let choices = choices(schema);
        let is_allowed = match schema.get("pattern") {
            // The only pattern in use, so regular expressions are not needed.
            Some(pattern) => pattern == NAME_PATTERN && is_name(text),
            None if choices.is_empty() => schema.get("minLength").is_none() || !text.is_empty(),
            None => choices.contains(&text),
        };
        if is_allowed {
            return Some(text.into());
        }
        let expected = format!("{}{}", allowed(schema), did_you_mean(text, &choices));
        self.wrong(node, &format!("{text:?}"), &expected)
    }

    fn list(&mut self, node: &Node, items: &'a [Node], schema: &'a Json) -> Option<Json> {
        let about = &schema["items"];
        if !counts(schema).contains(&items.len()) {
            // With too many tables, report the first surplus table.
            let is_table = |item: &&Node| matches!(item.value, Value::Table(_));
            let surplus = items.get(*counts(schema).end()).filter(is_table);
            let message = format!(
                "{} has {} item{}, expected {}",
                self.key(),
                items.len(),
                if items.len() == 1 { "" } else { "s" },
                allowed(schema)
            );
            self.loader
                .diagnostics
                .note(surplus.unwrap_or(node).at, message);
            // The list's entries may still be valid.
            self.wrong.push(format!("{}.length", self.path));
            if is_number(about) || about.is_array() {
                return None;
            }
        }
        let mut values = vec![];
        for (i, item) in items.iter().enumerate() {
            // A tuple has a schema for each position.
            let about = about.get(i).unwrap_or(about);
            let value = self.below(&i.to_string(), |below| below.value(item, about));
            values.push(value.unwrap_or_else(|| self.stand_in(about)));
        }
        Some(values.into())
    }

    /// A table of one of several kinds, selected by one of its keys.
    fn tagged(&mut self, node: &'a Node, table: &'a Table, schema: &'a Json) -> Option<Json> {
        let kinds = schema["oneOf"].as_array()?;
        let tag_of = |kind: &'a Json| {
            properties(kind).find_map(|(key, about)| Some((key, about.get("const")?.as_str()?)))
        };
        let (key, _) = kinds.iter().find_map(tag_of)?;
        let tags = kinds.iter().filter_map(tag_of);
        let names: Vec<&str> = tags.map(|(_, name)| name).collect();
        let expected = one_of(&names);
        let given = table.get(key);
        let text = given.and_then(|given| match &given.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        });
        let is_it = |kind: &&'a Json| text.is_some() && tag_of(kind).map(|(_, name)| name) == text;
        if let Some(kind) = kinds.iter().find(is_it) {
            return Some(self.table(node, table, kind));
        }
        // If the kind is missing, at least check the common keys.
        for (key, value) in table.iter().filter(|(other, _)| *other != key) {
            let abouts = kinds.iter().map(|kind| kind["properties"].get(key));
            if let Some(about) = abouts.collect::<Option<Vec<_>>>() {
                self.below(key, |below| below.property(key, value, about[0]));
            }
        }
        self.below(key, |below| match (given, text) {
            (None, _) => below.missing(node, &expected),
            (Some(given), None) => below.wrong(given, &found(given), &expected),
            (Some(given), Some(text)) => {
                let expected = format!("{expected}{}", did_you_mean(text, &names));
                below.wrong(given, &format!("{text:?}"), &expected)
            }
        })
    }

    fn table(&mut self, node: &'a Node, table: &'a Table, schema: &'a Json) -> Json {
        let mut values = Map::new();
        let others = Some(&schema["additionalProperties"]).filter(|others| others.is_object());
        for (key, value) in table {
            match schema["properties"].get(key).or(others) {
                Some(about) => {
                    let value = self.below(key, |below| below.property(key, value, about));
                    values.extend(value.map(|value| (key.clone(), value)));
                }
                None => self.unknown(key, value, schema),
            }
        }
        for (key, about) in properties(schema) {
            if values.contains_key(key) {
                continue;
            }
            let is_required = is_required(schema, key);
            if !table.contains_key(key) {
                let value = self.below(key, |below| below.absent(node, about, is_required));
                values.extend(value.map(|value| (key.to_owned(), value)));
            }
            if !values.contains_key(key) && is_required {
                values.insert(key.to_owned(), self.stand_in(about));
            }
        }
        by_fields(values, schema)
    }

    /// The value of an existing key.
    fn property(&mut self, key: &'a str, node: &'a Node, about: &'a Json) -> Option<Json> {
        let outer = self.owner;
        if about.get(DRAWN).is_some() && is_number(about) {
            self.owner = Some(self.file);
        } else if about.get(DRAWN).is_some() {
            // A shared table, such as a game's link, draws its own numbers.
            self.owner = Some(Owner {
                name: key,
                path_from: self.path.len() + 1,
            });
        }
        let value = self
            .value(node, about)
            .or_else(|| about.get("default").cloned());
        self.owner = outer;
        value
    }

    /// The value of a key missing from the table `owner`.
    fn absent(&mut self, owner: &'a Node, schema: &'a Json, is_required: bool) -> Option<Json> {
        if let Some(default) = schema.get("default") {
            return Some(default.clone());
        }
        if !is_required {
            return None;
        }
        if schema.get("properties").is_some() {
            return Some(self.table(owner, const { &Table::new() }, schema));
        }
        // A missing list of tables has the same faults as an empty one.
        let is_list_of_tables = || schema["items"]["type"] == "object";
        if schema["type"] == "array" && (counts(schema).contains(&0) || is_list_of_tables()) {
            return self.list(owner, &[], schema);
        }
        self.missing(owner, &allowed(schema))
    }

    fn unknown(&mut self, key: &str, node: &Node, schema: &Json) {
        let known: Vec<&str> = properties(schema).map(|(key, _)| key).collect();
        let message = format!(
            "{key} is unknown, expected {}{}",
            one_of(&known),
            did_you_mean(key, &known)
        );
        // Keys below a broken table header belong to the previous table.
        self.loader.diagnostics.note_if_intact(node.key_at, message);
    }

    fn missing(&mut self, owner: &Node, expected: &str) -> Option<Json> {
        self.loader
            .diagnostics
            .note_missing(owner.at, &self.path, expected);
        self.wrong.push(self.path.clone());
        None
    }

    fn wrong_type(&mut self, node: &Node, schema: &Json) -> Option<Json> {
        let mut expected = kind_of(schema);
        if let Value::Text(text) = &node.value
            && expected.contains("number")
            && has_unit(text)
            && let Some(unit) = Unit::of(self.key())
        {
            expected += &format!(" without a unit, in {}", unit.name);
        }
        self.wrong(node, &found(node), &expected)
    }

    fn wrong(&mut self, node: &Node, found: &str, expected: &str) -> Option<Json> {
        let message = format!("{} is {found}, expected {expected}", self.key());
        self.note(node.at, message);
        None
    }

    fn note(&mut self, at: usize, message: String) {
        self.loader.diagnostics.note(at, message);
        self.wrong.push(self.path.clone());
    }

    /// The key of the current value, or of the list that contains it.
    fn key(&self) -> &str {
        keys_of(&self.path).next().unwrap_or("the file")
    }

    /// Whether a value has the type in the schema.
    fn fits(&self, node: &Node, schema: &Json) -> bool {
        let any_of = |key: &str| {
            let branches = schema.get(key).and_then(Json::as_array);
            branches.is_some_and(|branches| branches.iter().any(|branch| self.fits(node, branch)))
        };
        any_of("anyOf")
            || any_of("oneOf")
            || match &node.value {
                Value::Table(_) => takes(schema, "object"),
                Value::List(_) => takes(schema, "array"),
                Value::Text(_) => takes(schema, "string"),
                Value::Truth(_) => takes(schema, "boolean"),
                Value::Whole(_) => is_number(schema),
                // An integer too large for 64 bits is still an integer, but out of range.
                Value::Number(number) => {
                    takes(schema, "number") || takes(schema, "integer") && number.abs() > 9e18
                }
                Value::Date(_) => false,
            }
    }

    /// A value that the schema allows, as a stand-in for a faulty one.
    fn stand_in(&self, schema: &Json) -> Json {
        if let Some(default) = schema.get("default") {
            return default.clone();
        }
        if let Some(choice) = choices(schema).first() {
            return (*choice).into();
        }
        match schema["anyOf"].get(0).or_else(|| schema["oneOf"].get(0)) {
            Some(branch) => self.stand_in(branch),
            None if takes(schema, "object") => {
                let needed = properties(schema).filter(|(key, about)| {
                    is_required(schema, key) || about.get("default").is_some()
                });
                let values = needed.map(|(key, about)| (key.to_owned(), self.stand_in(about)));
                by_fields(values.collect(), schema)
            }
            None if takes(schema, "array") => {
                let items = (0..*counts(schema).start())
                    .map(|i| schema["items"].get(i).unwrap_or(&schema["items"]));
                items.map(|item| self.stand_in(item)).collect()
            }
            None if takes(schema, "string") => "".into(),
            None if takes(schema, "boolean") => false.into(),
            None => schema.get("minimum").cloned().unwrap_or_else(|| 0.into()),
        }
    }
}

/// Whether the schema allows values of this type.
fn takes(schema: &Json, kind: &str) -> bool {
    match &schema["type"] {
        Json::Array(kinds) => kinds.iter().any(|known| known == kind),
        known => known == kind,
    }
}

fn is_number(schema: &Json) -> bool {
    takes(schema, "number") || takes(schema, "integer")
}

/// The allowed lengths of a list.
fn counts(schema: &Json) -> std::ops::RangeInclusive<usize> {
    let bound = |key: &str| schema[key].as_u64().map(|bound| bound as usize);
    bound("minItems").unwrap_or(0)..=bound("maxItems").unwrap_or(usize::MAX)
}

/// The strings that the schema allows.
fn choices(schema: &Json) -> Vec<&str> {
    let one_of = entries(schema, "oneOf").filter_map(|choice| choice.get("const"));
    let all = entries(schema, "enum").chain(schema.get("const"));
    all.chain(one_of).filter_map(Json::as_str).collect()
}

fn one_of(names: &[&str]) -> String {
    let one_of = if names.len() > 1 { "one of " } else { "" };
    format!("{one_of}{}", names.join(", "))
}

fn found(node: &Node) -> String {
    match &node.value {
        Value::Table(_) => "a table".to_owned(),
        Value::List(_) => "a list".to_owned(),
        Value::Text(text) => format!("the string {text:?}"),
        Value::Whole(whole) => whole.to_string(),
        Value::Number(number) => format!("{number:?}").replace("NaN", "nan"),
        Value::Truth(truth) => truth.to_string(),
        Value::Date(date) => date.clone(),
    }
}

/// Whether a string is a number with a unit, such as `20kn`.
fn has_unit(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
        && text.parse::<f64>().is_err()
}

/// The allowed values, in plain language.
fn allowed(schema: &Json) -> String {
    let (from, to) = match &schema["type"] {
        Json::String(kind) if kind == "array" => ("minItems", "maxItems"),
        _ => ("minimum", "maximum"),
    };
    match (schema.get(from), schema.get(to)) {
        _ if schema.get("x-expected").is_some() => kind_of(schema),
        (Some(_), Some(to)) if from == "minItems" && to == 2 => {
            "a pair of numbers [a, b]".to_owned()
        }
        (Some(from), Some(to)) if from == to => format!("exactly {from}"),
        (Some(from), Some(to)) => format!("{} to {}", bound(from), bound(to)),
        (Some(from), None) => format!("at least {}", bound(from)),
        (None, Some(to)) => format!("at most {}", bound(to)),
        (None, None) => kind_of(schema),
    }
}

/// A bound as users would write it: 1000000 rather than 1000000.0.
fn bound(value: &Json) -> String {
    let number = || value.as_f64().unwrap_or(f64::NAN).to_string();
    value
        .as_i64()
        .map_or_else(number, |whole| whole.to_string())
}

/// The type in the schema, in plain language.
fn kind_of(schema: &Json) -> String {
    if let Some(expected) = schema.get("x-expected").and_then(Json::as_str) {
        return expected.to_owned();
    }
    if let Some(branches) = schema.get("anyOf").and_then(Json::as_array) {
        let kinds: Vec<String> = branches.iter().map(kind_of).collect();
        return kinds.join(" or ");
    }
    let choices = choices(schema);
    if !choices.is_empty() {
        return one_of(&choices);
    }
    if schema.get("pattern").is_some() {
        return NAME_EXPECTED.to_owned();
    }
    let word = |kind: &str| match kind {
        "number" if schema.get("minimum").is_none() => "a finite number",
        "number" => "a number",
        "integer" => "a whole number",
        "boolean" => "true or false",
        "array" => "a list",
        "object" => "a table",
        _ => "a string",
    };
    if let (Some(title), true) = (schema["title"].as_str(), schema["type"].is_array()) {
        return title.to_owned();
    }
    let kinds = match &schema["type"] {
        Json::Array(kinds) => kinds.iter().filter_map(Json::as_str).map(word).collect(),
        kind => vec![word(kind.as_str().unwrap_or("object"))],
    };
    kinds.join(" or ")
}
