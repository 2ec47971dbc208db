//! Settings: overrides of single values in scenario files, as in `--set link.delay_s=1` or a sweep.

use super::guess::did_you_mean;
use super::kind::Kind;
use super::schema::{declared, properties};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::PathBuf;

/// An override of a value in all files of one kind in a game, checked as if it were in the files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// The kind of file and the key, as in `sea.waves.hs_m`. `link` and `fault` are tables of the
    /// game file; `strategy` is followed by a team's name, as in
    /// `strategy.blue.behaviour.pursue.weight`.
    pub key: String,
    /// The value, as TOML.
    pub value: String,
    /// The file with the setting, to which paths are relative; `--set KEY` for the command line.
    pub path: PathBuf,
    /// Its line, from 1.
    pub line: usize,
    /// Its column, from 1.
    pub column: usize,
}

/// The allowed first parts of keys, with the kind of file.
const PREFIXES: [(&str, Kind); 8] = [
    ("sea", Kind::SEA),
    ("boat", Kind::BOAT),
    ("rules", Kind::RULES),
    ("field", Kind::FIELD),
    ("game", Kind::GAME),
    ("link", Kind::GAME),
    ("fault", Kind::GAME),
    ("strategy", Kind::STRATEGY),
];

/// The full keys that end with this one: `sea.wind` for `wind`; shortest first.
fn complete(key: &str) -> Vec<String> {
    fn collect(found: &mut Vec<String>, about: &Value, path: &str, end: &str) {
        for (name, about) in properties(about) {
            let path = format!("{path}.{name}");
            collect(found, about, &path, end);
            found.extend(path.ends_with(end).then_some(path));
        }
    }
    let mut found = vec![];
    // Keys of strategies begin with a team; `link` and `fault` are tables of the game.
    let is_kind = |(prefix, _): &&(&str, Kind)| !["link", "fault", "strategy"].contains(prefix);
    for (prefix, kind) in PREFIXES.iter().filter(is_kind) {
        collect(&mut found, declared(*kind), prefix, &format!(".{key}"));
    }
    found.sort_by_key(String::len);
    found
}

impl Setting {
    /// Parses a setting from the command line. A value that is not TOML is a string.
    ///
    /// # Errors
    /// If it does not have the form `KEY=VALUE`, or the kind of file is unknown.
    pub fn parse(text: &str) -> Result<Setting, String> {
        let parts = text
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim()));
        let Some((key, value)) = parts.filter(|(_, value)| !value.is_empty()) else {
            return Err(format!(
                "{text:?} is not a setting, expected KEY=VALUE, for example sea.wind.speed_m_s=12"
            ));
        };
        let is_toml = format!("key = {value}")
            .parse::<toml::Table>()
            .is_ok_and(|table| table.len() == 1);
        let value = if is_toml {
            value.to_owned()
        } else {
            serde_json::Value::from(value).to_string()
        };
        Setting::new(key, value, PathBuf::from(format!("--set {key}")), (1, 1))
    }

    /// A setting at a line and column of a file.
    ///
    /// # Errors
    /// If the kind of file is unknown.
    pub fn new(
        key: &str,
        value: String,
        path: PathBuf,
        (line, column): (usize, usize),
    ) -> Result<Setting, String> {
        let setting = Setting {
            key: key.to_owned(),
            value,
            path,
            line,
            column,
        };
        setting.target().is_some().then_some(setting).ok_or_else(|| {
            let kinds = PREFIXES.map(|(prefix, _)| prefix);
            let complete = complete(key);
            let guess = match complete.first() {
                Some(one) => format!(" (did you mean {one}?)"),
                None => did_you_mean(key.split('.').next().unwrap_or_default(), &kinds),
            };
            format!(
                "the key {key:?} does not begin with a kind of file, expected one of {}, then a key, for example \
                 sea.wind.speed_m_s{guess}",
                kinds.join(", ")
            )
        })
    }

    /// The kind of file, and the key in it.
    pub(super) fn target(&self) -> Option<(Kind, &str)> {
        target_of(&self.key)
    }

    /// The name of the team whose strategy this setting changes, if any.
    pub(super) fn team(&self) -> Option<&str> {
        let (team, _) = self.key.strip_prefix("strategy.")?.split_once('.')?;
        Some(team)
    }

    /// A TOML file with only this value, at its original line and column.
    pub(super) fn as_file(&self, key: &str) -> String {
        let lines = self.line.saturating_sub(1);
        let columns = self.column.saturating_sub(1);
        format!(
            "{}{}{key} = {}",
            "\n".repeat(lines),
            " ".repeat(columns),
            self.value
        )
    }

    /// The setting as a command-line argument, quoted for a shell.
    pub fn argument(&self) -> String {
        format!("--set '{}={}'", self.key, self.value.replace('\'', "'\\''"))
    }
}

/// The kind of file named by a setting's key, and the key in it.
pub(super) fn target_of(whole: &str) -> Option<(Kind, &str)> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if !whole
        .split('.')
        .all(|part| !part.is_empty() && part.chars().all(is_plain))
    {
        return None;
    }
    let (first, rest) = whole.split_once('.')?;
    let (_, kind) = PREFIXES.iter().find(|(prefix, _)| *prefix == first)?;
    let key = match first {
        "link" | "fault" => whole,
        "strategy" => rest.split_once('.')?.1,
        _ => rest,
    };
    Some((*kind, key))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_of_the_command_line_has_a_kind_a_key_and_a_value() {
        for (text, kind, key, value) in [
            ("sea.waves.hs_m=0.3", Kind::SEA, "waves.hs_m", "0.3"),
            ("link.delay_s = 2", Kind::GAME, "link.delay_s", "2"),
            (
                "game.field=../fields/a.toml",
                Kind::GAME,
                "field",
                "\"../fields/a.toml\"",
            ),
            (
                "boat.gps.noise_m={ uniform = [0, 2] }",
                Kind::BOAT,
                "gps.noise_m",
                "{ uniform = [0, 2] }",
            ),
        ] {
            let setting = Setting::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(
                (setting.target(), setting.value.as_str()),
                (Some((kind, key)), value),
                "{text}"
            );
        }
        for text in [
            "sea.waves.hs_m",
            "=3",
            "sea=3",
            "sea..hs_m=3",
            "weather.wind=3",
            "sea.waves=",
            "strategy.x=1",
        ] {
            assert!(Setting::parse(text).is_err(), "{text}");
        }
        for (text, guess) in [
            ("wind=20", "sea.wind"),
            ("duration_s=60", "game.duration_s"),
            ("hs_m=1", "sea.waves.hs_m"),
            ("seas.wind=1", "sea"),
        ] {
            let error = Setting::parse(text).expect_err(text);
            assert!(
                error.ends_with(&format!("(did you mean {guess}?)")),
                "{error}"
            );
        }
        // A value must not smuggle in another key.
        let smuggled = Setting::parse("sea.a=1\nb = 2").expect("a text");
        assert_eq!(
            smuggled.value.matches('\n').count(),
            0,
            "{}",
            smuggled.value
        );
    }
}
