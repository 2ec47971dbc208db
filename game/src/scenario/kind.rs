//! The kinds of scenario files: their names, their schemas, and which kind a file is.

use super::raw;
use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// A kind of scenario file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A game.
    Game,
    /// A field.
    Field,
    /// Rules.
    Rules,
    /// A kind of boat.
    Boat,
    /// A sea.
    Sea,
    /// A strategy.
    Strategy,
    /// A tournament.
    Tournament,
    /// The way to a real boat.
    Gateway,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Kind; 8] =
        [Kind::Game, Kind::Field, Kind::Rules, Kind::Boat, Kind::Sea, Kind::Strategy, Kind::Tournament, Kind::Gateway];

    /// Its name, which is also that of its schema file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Kind::Game => "game",
            Kind::Field => "field",
            Kind::Rules => "rules",
            Kind::Boat => "boat",
            Kind::Sea => "sea",
            Kind::Strategy => "strategy",
            Kind::Tournament => "tournament",
            Kind::Gateway => "gateway",
        }
    }

    /// The folder its files lie in.
    #[must_use]
    pub fn folder(self) -> &'static str {
        match self {
            Kind::Game => "games",
            Kind::Field => "fields",
            Kind::Rules => "rules",
            Kind::Boat => "boats",
            Kind::Sea => "seas",
            Kind::Strategy => "strategies",
            Kind::Tournament => "tournaments",
            Kind::Gateway => "gateways",
        }
    }

    /// The kind that the folder of `path` says, if it says one.
    #[must_use]
    pub fn by_folder(path: &Path) -> Option<Kind> {
        let folder = path.parent()?.file_name()?;
        Kind::ALL.into_iter().find(|kind| folder == kind.folder())
    }

    /// The kind that knows most of these top-level keys; the first of [`Kind::ALL`] where several do.
    pub(super) fn by_keys(keys: &BTreeSet<String>) -> Kind {
        let known = |kind: Kind| {
            let schema = schema(kind);
            let properties = schema.get("properties");
            keys.iter().filter(|key| properties.is_some_and(|known| known.get(key.as_str()).is_some())).count()
        };
        // Of equals `max_by_key` takes the last.
        Kind::ALL.into_iter().rev().max_by_key(|kind| known(*kind)).unwrap_or(Kind::Game)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The JSON Schema of a kind of file, for editors.
#[must_use]
pub fn schema(kind: Kind) -> Value {
    match kind {
        Kind::Game => schema_of::<raw::RawGame>(&["Link", "Loss"]),
        Kind::Field => schema_of::<raw::RawField>(&[]),
        Kind::Rules => schema_of::<raw::RawRules>(&["Sharing"]),
        Kind::Boat => schema_of::<raw::RawBoat>(&[EVERYTHING]),
        Kind::Sea => schema_of::<raw::RawSea>(&[EVERYTHING]),
        Kind::Strategy => schema_of::<raw::RawStrategy>(&[]),
        Kind::Tournament => schema_of::<raw::RawTournament>(&[]),
        Kind::Gateway => schema_of::<raw::RawGateway>(&[]),
    }
}

/// Stands for all the numbers of a kind of file.
const EVERYTHING: &str = "";

/// The schema of `T`, in which numbers of the tables `drawable` may be distributions.
fn schema_of<T: JsonSchema>(drawable: &[&str]) -> Value {
    // Draft 7 is what editors' TOML extensions understand.
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<T>().to_value();
    without_null(&mut schema);
    if drawable.is_empty() {
        return schema;
    }
    for name in drawable {
        let table = if *name == EVERYTHING { Some(&mut schema) } else { schema["definitions"].get_mut(*name) };
        table.into_iter().for_each(with_distributions);
    }
    schema["definitions"]["Distribution"] = distribution();
    schema
}

/// Lets every number be a distribution as well.
fn with_distributions(value: &mut Value) {
    match value {
        Value::Object(object) if object.get("type").is_some_and(|kind| kind == "number") => {
            object.remove("type");
            object.remove("format");
            object.insert("anyOf".into(), json!([{ "type": "number" }, { "$ref": "#/definitions/Distribution" }]));
        }
        Value::Object(object) => object.values_mut().for_each(with_distributions),
        Value::Array(items) => items.iter_mut().for_each(with_distributions),
        _ => {}
    }
}

fn distribution() -> Value {
    let numbers = |least: u32, most: Option<u32>| match most {
        Some(most) => json!({ "type": "array", "items": { "type": "number" }, "minItems": least, "maxItems": most }),
        None => json!({ "type": "array", "items": { "type": "number" }, "minItems": least }),
    };
    let kind = |name: &str, numbers: Value, what: &str| {
        json!({
            "type": "object",
            "description": what,
            "properties": { name: numbers, "times": { "type": "number", "description": "A factor. Default 1." } },
            "required": [name],
            "additionalProperties": false
        })
    };
    json!({
        "description": "A number that is drawn anew for every game, and for every vehicle.",
        "anyOf": [
            kind("uniform", numbers(2, Some(2)), "Between two numbers, all equally likely."),
            kind("normal", numbers(2, Some(2)), "Mean and standard deviation; within three of them."),
            kind("log_normal", numbers(2, Some(2)), "Median, and standard deviation of the logarithm; within three of them."),
            kind("choice", numbers(1, None), "One of these.")
        ]
    })
}

/// Our keys may be left out, which the generator writes as "or null"; TOML has no null.
fn without_null(value: &mut Value) {
    let is_null = |choice: &Value| *choice == "null" || choice.get("type").is_some_and(|kind| kind == "null");
    if let Value::Object(object) = value {
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
                // Draft 7 ignores what stands beside a `$ref`, so the reference goes into a list of one.
                object.insert("allOf".into(), Value::Array(vec![only]));
            }
        }
        object.values_mut().for_each(without_null);
    } else if let Value::Array(items) = value {
        items.iter_mut().for_each(without_null);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_outside_of_the_folders_is_told_by_its_keys() {
        for (keys, want) in [
            (vec!["field", "team"], Kind::Game),
            (vec!["width_m", "depth_m"], Kind::Field),
            (vec!["points"], Kind::Rules),
            (vec!["hull", "typo"], Kind::Boat),
            (vec!["current"], Kind::Sea),
            (vec!["roles", "base"], Kind::Strategy),
            (vec!["game", "entry", "sea", "seed"], Kind::Tournament),
            (vec!["order_ttl_s", "fence", "limits"], Kind::Gateway),
            (vec!["base"], Kind::Game),
            (vec![], Kind::Game),
        ] {
            let keys = keys.into_iter().map(str::to_owned).collect();
            assert_eq!(Kind::by_keys(&keys), want, "{keys:?}");
        }
        assert_eq!(Kind::by_folder(Path::new("x/seas/calm.toml")), Some(Kind::Sea));
        assert_eq!(Kind::by_folder(Path::new("calm.toml")), None);
    }
}
