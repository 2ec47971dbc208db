//! The problems found so far, reported by their offsets in the virtual text of all files.

use super::problem::{Problem, Problems};
use super::source::Sources;
use std::cell::{Cell, RefCell};
use std::path::PathBuf;
use std::sync::Arc;

/// The sources read, and the problems found in them.
#[derive(Debug, Default)]
pub(super) struct Diagnostics {
    pub(super) sources: RefCell<Sources>,
    problems: RefCell<Vec<Problem>>,
    faults: Cell<usize>,
}

impl Diagnostics {
    /// Appends a file to the virtual text; returns its offset.
    pub(super) fn add(&self, path: PathBuf, text: Arc<str>) -> usize {
        self.sources.borrow_mut().add(path, text)
    }

    /// Reports a fault in the value at `at`, unless its line has a syntax error.
    pub(super) fn note(&self, at: usize, message: impl Into<String>) {
        self.count(at, message, |sources| !sources.is_broken_line(at));
    }

    /// Reports a problem, unless the file has a syntax error that may be its cause.
    pub(super) fn note_if_intact(&self, at: usize, message: impl Into<String>) {
        self.count(at, message, |sources| !sources.is_broken_file(at));
    }

    /// Reports that the value at `path` of a file is missing from the table at `at`.
    pub(super) fn note_missing(&self, at: usize, path: &str, expected: &str) {
        let keys: Vec<&str> = keys_of(path).take(2).collect();
        let key = keys.into_iter().rev().collect::<Vec<_>>().join(".");
        self.note_if_intact(at, format!("{key} is missing, expected {expected}"));
    }

    /// Reports a syntax error at `at`.
    pub(super) fn note_syntax(&self, at: usize, message: &str) {
        self.sources.borrow_mut().mark_broken(at);
        self.count(at, message, |_| true);
    }

    /// Reports a problem with a whole file that could not be read.
    pub(super) fn note_file(&self, path: PathBuf, message: String) {
        self.faults.update(|faults| faults + 1);
        let problem = Problem::of_file(path, message);
        self.problems.borrow_mut().push(problem);
    }

    /// Counts a fault, and reports it if it is `wanted`.
    fn count(&self, at: usize, message: impl Into<String>, wanted: impl Fn(&Sources) -> bool) {
        self.faults.update(|faults| faults + 1);
        let sources = self.sources.borrow();
        if wanted(&sources) {
            let problem = sources.problem(at, message.into());
            self.problems.borrow_mut().push(problem);
        }
    }

    /// The number of faults so far; checks that combine values run only if it has not grown.
    pub(super) fn faults(&self) -> usize {
        self.faults.get()
    }

    /// All problems, if there are any.
    pub(super) fn result(&self) -> Result<(), Problems> {
        Problems::of(self.problems.take())
    }
}

/// The keys in a path, last key first, without the indices of lists.
pub(super) fn keys_of(path: &str) -> impl Iterator<Item = &str> {
    path.rsplit('.')
        .filter(|part| part.parse::<usize>().is_err())
}

/// The pattern of names, in a schema.
pub(super) const NAME_PATTERN: &str = "^[a-z0-9_]{1,40}$";
/// [`NAME_PATTERN`] in plain language.
pub(super) const NAME_EXPECTED: &str = "1 to 40 characters from a-z, 0-9 and _";

/// Whether this is a valid name of a file, vehicle, team, fault, variable or behaviour.
pub(super) fn is_name(name: &str) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    !name.is_empty() && name.len() <= 40 && name.chars().all(fits)
}
