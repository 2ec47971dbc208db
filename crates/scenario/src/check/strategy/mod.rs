//! Checks a strategy file: its roles, or its program.

mod behaviour;
mod cel;
mod expression;
mod mode;
mod program;
mod reachability;
mod safety;
mod scope;
mod variable;

use super::file_cache::FileCache;
use crate::Kind;
use crate::diagnostics::Diagnostics;
use crate::kept;
use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::{self, Document};
use crate::strategy::{Program, Strategy};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads and checks the strategy file at `path`, with the place of the reference, for a team with
/// its own values, or for all teams ("").
pub(crate) fn strategy_file(
    diagnostics: &mut Diagnostics,
    path: &Path,
    asked_at: Option<usize>,
    owner: &str,
) -> Option<Strategy> {
    let key = kept::key(Kind::STRATEGY, path, owner);
    if let Some(kept) = diagnostics.kept.strategies.get(&key) {
        return Some(kept.clone());
    }
    let strategy: Strategy = diagnostics.read(path, asked_at, owner)?;
    Arc::make_mut(&mut diagnostics.kept)
        .strategies
        .insert(key, strategy.clone());
    Some(strategy)
}

impl ScenarioFile for Strategy {
    type Keys = raw::Strategy;
    const NAME: &'static str = "strategy";
    const FOLDER: &'static str = "strategies";

    fn check(
        diagnostics: &mut Diagnostics,
        document: &Document<raw::Strategy>,
    ) -> Option<Strategy> {
        let raw = &document.raw;
        let roles = match &raw.roles {
            Some(given) => {
                refuse_program(diagnostics, document);
                roles(diagnostics, document, given)
            }
            None => {
                if document.has("assignment") {
                    let message = "assignment is given without roles, expected only with them";
                    diagnostics.note(document.at("assignment"), message);
                }
                vec![program::program(diagnostics, document)?]
            }
        };
        let strategy = Strategy {
            name: document.name.clone(),
            about: raw.about.clone(),
            roles,
            assignment: raw.assignment,
        };
        document.is_faultless(diagnostics).then_some(strategy)
    }
}

/// Strategy files that a file refers to, each read once.
pub struct StrategyFiles(FileCache<Strategy>);

impl Default for StrategyFiles {
    fn default() -> StrategyFiles {
        StrategyFiles(FileCache::new(strategy_file))
    }
}

impl StrategyFiles {
    /// Reads and checks the strategy that the value at `key` of a file refers to. Returns its path.
    pub fn read<D>(
        &mut self,
        diagnostics: &mut Diagnostics,
        document: &Document<D>,
        key: &str,
        given: &Path,
    ) -> PathBuf {
        let place = document.at(key);
        let path = diagnostics.resolve(place, given);
        if document.is_sound(key) {
            self.0.index_at(diagnostics, &path, Some(place), "");
        }
        path
    }
}

/// Reports program keys in a file with roles.
fn refuse_program(diagnostics: &mut Diagnostics, document: &Document<raw::Strategy>) {
    let keys = [
        "helm",
        "unsafe_i_know",
        "unsafe_because",
        "variables",
        "mode",
        "rule",
    ]
    .map(str::to_owned);
    let behaviours = document
        .raw
        .behaviour
        .keys()
        .map(|name| format!("behaviour.{name}"));
    for key in keys
        .into_iter()
        .chain(behaviours)
        .filter(|key| document.has(key))
    {
        let message = format!("{key} is given with roles, expected in the files listed in roles");
        diagnostics.note(document.at(&key), message);
    }
}

/// The programs of a file's roles. A file that is referenced twice is read once.
fn roles(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Strategy>,
    given: &[raw::FilePath],
) -> Vec<Program> {
    let mut read: BTreeMap<PathBuf, Option<Program>> = BTreeMap::new();
    let mut roles = vec![];
    for (i, role) in given
        .iter()
        .enumerate()
        .filter(|(_, role)| !role.0.is_empty())
    {
        let at = document.at(&format!("roles.{i}"));
        let path = diagnostics.resolve(at, &role.0);
        let program = read
            .entry(path.clone())
            .or_insert_with(|| one_role(diagnostics, at, &role.0, &path));
        roles.extend(program.clone());
    }
    roles
}

fn one_role(diagnostics: &mut Diagnostics, at: usize, role: &str, path: &Path) -> Option<Program> {
    let document = read::document::<raw::Strategy>(
        diagnostics,
        Kind::STRATEGY,
        path,
        Some(at),
        Strategy::NAME,
    )?;
    if document.raw.roles.is_some() {
        let message =
            format!("roles has {role:?}, which has roles itself, expected a program file");
        diagnostics.note(at, message);
        return None;
    }
    program::program(diagnostics, &document)
}
