//! Settings: overrides of single values in scenario files, as in `--set sea.waves.hs_m=0.3` or a
//! sweep.

use super::kind::Kind;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use thiserror::Error;

/// An override of a value in all files of a kind in a game, checked as if it were in the file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Setting {
    /// The kind of file and the key, as in `sea.waves.hs_m`. `link` and `fault` are tables of the
    /// game file; `strategy` is followed by the team's name, as in
    /// `strategy.blue.behaviour.pursue.weight`.
    pub key: String,
    /// The value, as TOML.
    pub value: String,
    /// The file with the setting, to which paths are relative; `--set KEY` on the command line.
    pub path: PathBuf,
    /// Its line, from 1.
    pub line: usize,
    /// Its column, from 1.
    pub column: usize,
}

/// Why a text is not a valid setting.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SettingError {
    /// The key or the value is missing.
    #[error("{0:?} is not a setting, expected KEY=VALUE, for example sea.waves.hs_m=0.3")]
    Form(String),
    /// The key does not begin with a kind of file.
    #[error("the key {0:?} does not begin with a kind of file, expected one of {list}, then a key, for example sea.waves.hs_m", list = PREFIXES.join(", "))]
    Kind(String),
}

/// The allowed first parts of keys.
const PREFIXES: [&str; 8] = ["sea", "boat", "rules", "field", "game", "link", "fault", "strategy"];

impl Setting {
    /// Parses a setting from the command line. A value that is not TOML is a string.
    ///
    /// # Errors
    /// [`SettingError`]: not of the form `KEY=VALUE`, or an unknown kind of file.
    pub fn parse(text: &str) -> Result<Setting, SettingError> {
        let (key, value) = text.split_once('=').ok_or_else(|| SettingError::Form(text.to_owned()))?;
        let (key, value) = (key.trim(), value.trim());
        if value.is_empty() {
            return Err(SettingError::Form(text.to_owned()));
        }
        let is_toml = format!("key = {value}").parse::<toml::Table>().is_ok_and(|table| table.len() == 1);
        let value = if is_toml { value.to_owned() } else { serde_json::Value::from(value).to_string() };
        Setting::new(key, value, PathBuf::from(format!("--set {key}")), (1, 1))
    }

    /// A setting at a line and column of a file.
    ///
    /// # Errors
    /// [`SettingError`]: unknown kind of file.
    pub fn new(
        key: &str,
        value: String,
        path: PathBuf,
        (line, column): (usize, usize),
    ) -> Result<Setting, SettingError> {
        let setting = Setting { key: key.to_owned(), value, path, line, column };
        match setting.target() {
            Some(_) => Ok(setting),
            None => Err(SettingError::Kind(key.to_owned())),
        }
    }

    /// The kind of file, and the key in it.
    pub(super) fn target(&self) -> Option<(Kind, &str)> {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !self.key.split('.').all(|part| !part.is_empty() && part.chars().all(is_plain)) {
            return None;
        }
        let (first, rest) = self.key.split_once('.')?;
        Some(match first {
            "sea" => (Kind::SEA, rest),
            "boat" => (Kind::BOAT, rest),
            "rules" => (Kind::RULES, rest),
            "field" => (Kind::FIELD, rest),
            "game" => (Kind::GAME, rest),
            "link" | "fault" => (Kind::GAME, self.key.as_str()),
            "strategy" => (Kind::STRATEGY, rest.split_once('.')?.1),
            _ => return None,
        })
    }

    /// The name of the team whose strategy it changes, if any.
    pub(super) fn team(&self) -> Option<&str> {
        let (team, _) = self.key.strip_prefix("strategy.")?.split_once('.')?;
        Some(team)
    }

    /// A TOML file with this value only, at its original line and column.
    pub(super) fn as_file(&self, key: &str) -> String {
        let lines = self.line.saturating_sub(1);
        let columns = self.column.saturating_sub(1);
        format!("{}{}{key} = {}", "\n".repeat(lines), " ".repeat(columns), self.value)
    }

    /// The setting as an argument of a command line, quoted for a shell.
    #[must_use]
    pub fn argument(&self) -> String {
        format!("--set '{}={}'", self.key, self.value.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_of_the_command_line_has_a_kind_a_key_and_a_value() {
        for (text, kind, key, value) in [
            ("sea.waves.hs_m=0.3", Kind::SEA, "waves.hs_m", "0.3"),
            ("link.delay_s = 2", Kind::GAME, "link.delay_s", "2"),
            ("game.field=../fields/a.toml", Kind::GAME, "field", "\"../fields/a.toml\""),
            ("boat.gps.noise_m={ uniform = [0, 2] }", Kind::BOAT, "gps.noise_m", "{ uniform = [0, 2] }"),
        ] {
            let setting = Setting::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!((setting.target(), setting.value.as_str()), (Some((kind, key)), value), "{text}");
        }
        for text in ["sea.waves.hs_m", "=3", "sea=3", "sea..hs_m=3", "weather.wind=3", "sea.waves=", "strategy.x=1"] {
            assert!(Setting::parse(text).is_err(), "{text}");
        }
        // A value must not smuggle in another key.
        let smuggled = Setting::parse("sea.a=1\nb = 2").expect("a text");
        assert_eq!(smuggled.value.matches('\n').count(), 0, "{}", smuggled.value);
    }
}
