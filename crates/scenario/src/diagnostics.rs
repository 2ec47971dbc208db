//! The problems found so far, and checks of single values.

use super::draw::{Drawing, Drawn};
use super::files::Files;
use super::kept::{Kept, Reading};
use super::kind::{Kind, ScenarioFile};
use super::overrides::Overrides;
use super::problem::{Problem, Problems};
use super::read::{self, Document};
use super::source::Sources;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The sources read, and the problems found in them.
#[derive(Debug)]
pub struct Diagnostics {
    pub(super) sources: Sources,
    /// How numbers are drawn from distributions.
    pub(super) drawing: Drawing,
    pub(super) drawn: Vec<Drawn>,
    pub(super) files: Arc<Files>,
    pub(super) kept: Arc<Kept>,
    pub(super) overrides: Overrides,
    problems: Vec<Problem>,
    faults: usize,
}

impl Diagnostics {
    pub(super) fn new(drawing: Drawing) -> Diagnostics {
        Diagnostics {
            sources: Sources::default(),
            drawing,
            drawn: vec![],
            files: Arc::default(),
            kept: Arc::default(),
            overrides: Overrides::default(),
            problems: vec![],
            faults: 0,
        }
    }

    /// Continues from the results of an earlier reading. Returns whether there were any.
    pub(super) fn resume(&mut self, reading: &Reading) -> bool {
        let Some(known) = &reading.0 else {
            return false;
        };
        (self.sources, self.kept) = (**known).clone();
        true
    }

    /// Reports a fault of the value at `at`, unless its line has a syntax error.
    pub fn note(&mut self, at: usize, message: impl Into<String>) {
        self.faults += 1;
        if !self.sources.is_broken_line(at) {
            self.push(at, message.into());
        }
    }

    /// The path of the file that `reference`, at `at`, refers to.
    pub fn resolve(&self, at: usize, reference: impl AsRef<Path>) -> PathBuf {
        self.sources.resolve(at, reference)
    }

    /// The file, line and column (from 1) of the value at `at`.
    pub fn position(&self, at: usize) -> (PathBuf, usize, usize) {
        let Problem {
            path, line, column, ..
        } = self.sources.problem(at, String::new());
        (path, line, column)
    }

    /// Reads and checks the file of another kind that the value at `key` of a file refers to.
    pub fn referenced<F: ScenarioFile, D>(
        &mut self,
        document: &Document<D>,
        key: &str,
        given: impl AsRef<Path>,
    ) -> Option<F> {
        if !document.is_sound(key) {
            return None;
        }
        let place = document.at(key);
        let path = self.resolve(place, given);
        self.read(&path, Some(place), F::NAME)
    }

    /// Reads and checks the file at `path`, with numbers drawn for `owner`. If it cannot be read,
    /// the problem is at `asked_at`, the reference.
    pub(super) fn read<F: ScenarioFile>(
        &mut self,
        path: &Path,
        asked_at: Option<usize>,
        owner: &str,
    ) -> Option<F> {
        let document = read::document(self, Kind::of::<F>(), path, asked_at, owner)?;
        F::check(self, &document)
    }

    /// Reads and checks the file at `path`; its value and the drawn numbers, if there are no
    /// faults.
    pub(super) fn faultless<F: ScenarioFile>(
        &mut self,
        path: &Path,
    ) -> Result<(F, Vec<Drawn>), Problems> {
        match self.read(path, None, F::NAME) {
            Some(value) if self.problems.is_empty() => Ok((value, std::mem::take(&mut self.drawn))),
            _ => {
                assert!(
                    !self.problems.is_empty(),
                    "a check failed without saying why"
                );
                self.problems.sort();
                self.problems.dedup();
                Err(Problems(std::mem::take(&mut self.problems)))
            }
        }
    }

    /// Reports a problem that broken syntax in the file may have caused, unless there is some.
    pub(super) fn note_if_intact(&mut self, at: usize, message: impl Into<String>) {
        self.faults += 1;
        if !self.sources.is_broken_file(at) {
            self.push(at, message.into());
        }
    }

    /// Reports that the value at `path` of a file is missing from the table at `at`.
    pub(super) fn note_missing(&mut self, at: usize, path: &str, expected: &str) {
        let parts: Vec<&str> = path
            .split('.')
            .filter(|part| part.parse::<usize>().is_err())
            .collect();
        let key = parts[parts.len().saturating_sub(2)..].join(".");
        self.note_if_intact(at, format!("{key} is missing, expected {expected}"));
    }

    /// Reports a syntax error at `at`.
    pub(super) fn note_syntax(&mut self, at: usize, message: &str) {
        self.faults += 1;
        self.sources.mark_broken(at);
        self.push(at, message.into());
    }

    /// Reports a problem with a whole file that could not be read.
    pub(super) fn note_file(&mut self, path: PathBuf, message: impl Into<String>) {
        self.faults += 1;
        self.problems.push(Problem::of_file(path, message.into()));
    }

    fn push(&mut self, at: usize, message: String) {
        self.problems.push(self.sources.problem(at, message));
    }

    /// The number of faults so far: checks that combine values run only if it has not grown.
    pub(super) fn faults(&self) -> usize {
        self.faults
    }

    /// Whether `name` is valid: at most 40 of `a` to `z`, `0` to `9` and `_`.
    pub(super) fn is_name(&mut self, at: usize, key: &str, name: &str) -> bool {
        let is_fit = is_name(name);
        if !is_fit {
            self.note(at, format!("{key} is {name:?}, expected {NAME_EXPECTED}"));
        }
        is_fit
    }
}

/// The pattern of names, in a schema.
pub(super) const NAME_PATTERN: &str = "^[a-z0-9_]{1,40}$";
/// The same pattern in words.
pub(super) const NAME_EXPECTED: &str = "1 to 40 of a-z, 0-9 and _";

/// Whether this is a valid name of a vehicle, team or rival.
pub(super) fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !name.is_empty() && name.len() <= 40 && name.chars().all(fits)
}
