//! A kind of scenario file: its keys, its folder, and its check.

use super::load::draw_file;
use super::problem::Problems;
use super::read::Document;
use super::schema::{declared, generated};
use crate::Scenario;
use crate::boat::Boat;
use crate::sea::Sea;
use crate::strategy::Strategy;
use rules::{Field, Rules};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// The checked form of a kind of scenario file, implemented by the crate that uses it, or in
/// `check` for the files of a game.
pub trait ScenarioFile: Clone + Send + Sync + 'static {
    /// The keys of the file; `schema.rs` describes their declaration.
    type Keys: DeserializeOwned + JsonSchema;
    /// The name of the kind and of its schema file.
    const NAME: &'static str;
    /// The folder of its files.
    const FOLDER: &'static str;

    /// Converts a file that satisfies its schema; `None` if there are faults, which are reported.
    fn check(document: &Document<Self::Keys>) -> Option<Self>;

    /// Reads and checks the file at `path`, its bases and referenced files. Distributions are drawn
    /// with seed 1.
    ///
    /// # Errors
    /// All faults in these files, by file, line and column.
    fn load(path: &Path) -> Result<Self, Problems> {
        let (value, _) = draw_file::<Self>(path, 1)?;
        value.check_games().map(|()| value)
    }

    /// Checks the games that a file defines, once the file itself has no faults.
    ///
    /// # Errors
    /// All faults in these games.
    fn check_games(&self) -> Result<(), Problems> {
        Ok(())
    }
}

/// A kind of scenario file.
#[derive(Clone, Copy)]
pub struct Kind {
    name: &'static str,
    folder: &'static str,
    pub(super) keys: fn(Kind) -> Value,
    check: fn(&Path) -> Result<(), Problems>,
}

impl Kind {
    /// A game.
    pub const GAME: Kind = Kind::of::<Scenario>();
    /// A field.
    pub const FIELD: Kind = Kind::of::<Field>();
    /// Rules.
    pub const RULES: Kind = Kind::of::<Rules>();
    /// A kind of boat.
    pub const BOAT: Kind = Kind::of::<Boat>();
    /// A sea.
    pub const SEA: Kind = Kind::of::<Sea>();
    /// A strategy.
    pub const STRATEGY: Kind = Kind::of::<Strategy>();
    /// The kind of files read as `F`.
    pub const fn of<F: ScenarioFile>() -> Kind {
        Kind {
            name: F::NAME,
            folder: F::FOLDER,
            keys: generated::<F::Keys>,
            check: |path| F::load(path).map(drop),
        }
    }

    /// The name of the kind, and of its schema file.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// The folder of its files.
    pub fn folder(self) -> &'static str {
        self.folder
    }

    /// Reads and checks a file of this kind.
    ///
    /// # Errors
    /// All faults in the file, its bases and the files it refers to.
    pub fn check(self, path: &Path) -> Result<(), Problems> {
        (self.check)(path)
    }

    /// The kind whose folder contains `path`, if any.
    pub fn by_folder(kinds: &[Kind], path: &Path) -> Option<Kind> {
        let folder = path.parent()?.file_name()?;
        kinds.iter().copied().find(|kind| folder == kind.folder)
    }

    /// The kind with the most of these top-level keys; ties go to the first.
    pub fn by_keys(kinds: &[Kind], keys: &BTreeSet<String>) -> Kind {
        // `max_by_key` returns the last of equal elements.
        let best = kinds
            .iter()
            .copied()
            .rev()
            .max_by_key(|kind| kind.known(keys));
        best.unwrap_or(Kind::GAME)
    }

    /// The kind to which a file with these top-level keys clearly belongs instead of this one,
    /// because that kind has at least two more of them.
    pub fn other_by_keys(self, kinds: &[Kind], keys: &BTreeSet<String>) -> Option<Kind> {
        Some(Kind::by_keys(kinds, keys)).filter(|other| other.known(keys) >= self.known(keys) + 2)
    }

    /// The number of these top-level keys that the kind has.
    fn known(self, keys: &BTreeSet<String>) -> usize {
        let known = &declared(self)["properties"];
        keys.iter()
            .filter(|key| known.get(key.as_str()).is_some())
            .count()
    }
}

// Compare only names: two kinds with the same name would have the same folder.
impl PartialEq for Kind {
    fn eq(&self, other: &Kind) -> bool {
        self.name == other.name
    }
}

impl Eq for Kind {}

impl fmt::Debug for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name)
    }
}
