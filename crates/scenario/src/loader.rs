//! Reads a file and all referenced files.

use super::diagnostics::Diagnostics;
use super::draw::{Drawing, Drawn};
use super::files::Files;
use super::kind::{Kind, ScenarioFile};
use super::overrides::Overrides;
use super::problem::Problems;
use super::read;
use super::tree::Node;
use crate::Scenario;
use std::any::Any;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Kind, path and owner of a file: a strategy's owner is the team whose settings it contains.
pub(super) type Key = (&'static str, PathBuf, String);

pub(super) fn key<F: ScenarioFile>(path: &Path, owner: &str) -> Key {
    let is_by_owner = F::NAME == Kind::STRATEGY.name();
    let owner = if is_by_owner { owner } else { "" };
    (F::NAME, path.to_owned(), owner.to_owned())
}

/// The data read for a game: its files, and the checked values of files without numbers to draw.
/// Redrawing a game does not check these again. They follow from the files, so comparisons and
/// recordings exclude them.
#[derive(Clone, Debug, Default)]
pub(super) struct Basis {
    pub(super) files: Arc<Files>,
    pub(super) checked: BTreeMap<Key, Arc<dyn Any + Send + Sync>>,
}

impl PartialEq for Basis {
    fn eq(&self, _: &Basis) -> bool {
        true
    }
}

/// Reads files with these overrides, and draws numbers by this method.
#[derive(Debug)]
pub(super) struct Loader {
    pub(super) drawing: Drawing,
    pub(super) overrides: Overrides,
    pub(super) files: Arc<Files>,
    pub(super) diagnostics: Diagnostics,
    pub(super) drawn: RefCell<Vec<Drawn>>,
    /// Files without faults, merged with their bases, by path.
    pub(super) trees: RefCell<BTreeMap<PathBuf, Node>>,
    checked: RefCell<BTreeMap<Key, Arc<dyn Any + Send + Sync>>>,
}

impl Loader {
    pub(super) fn new(drawing: Drawing, overrides: &Overrides, basis: Basis) -> Loader {
        Loader {
            drawing,
            overrides: overrides.clone(),
            files: basis.files,
            diagnostics: Diagnostics::default(),
            drawn: RefCell::default(),
            trees: RefCell::default(),
            checked: RefCell::new(basis.checked),
        }
    }

    /// Reads and checks the file at `path`, with numbers drawn for `owner`. If it cannot be read,
    /// the problem is reported at the reference, `asked_at`.
    pub(super) fn read<F: ScenarioFile>(
        &self,
        path: &Path,
        asked_at: Option<usize>,
        owner: &str,
    ) -> Option<F> {
        let key = key::<F>(path, owner);
        if let Some(checked) = self.checked.borrow().get(&key) {
            return checked.downcast_ref::<F>().cloned();
        }
        let state = || (self.diagnostics.faults(), self.drawn.borrow().len());
        let before = state();
        let document = read::document(self, Kind::of::<F>(), path, asked_at, owner)?;
        let value = F::check(&document)?;
        // A game also depends on overrides of other files.
        if state() == before && F::NAME != Scenario::NAME {
            let checked = Arc::new(value.clone());
            self.checked.borrow_mut().insert(key, checked);
        }
        Some(value)
    }

    /// Reads and checks the file at `path`; returns its value and the drawn numbers if there are no
    /// faults.
    pub(super) fn faultless<F: ScenarioFile>(
        &self,
        path: &Path,
    ) -> Result<(F, Vec<Drawn>), Problems> {
        let value = self.read(path, None, F::NAME);
        self.diagnostics.result()?;
        let value = value.expect("a check gives the reason for its failure");
        Ok((value, self.drawn.take()))
    }

    pub(super) fn into_basis(self) -> Basis {
        Basis {
            files: self.files,
            checked: self.checked.into_inner(),
        }
    }
}
