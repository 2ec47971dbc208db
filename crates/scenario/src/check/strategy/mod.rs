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

use crate::Kind;
use crate::kind::ScenarioFile;
use crate::raw;
use crate::read::{self, Document};
use crate::strategy::{Program, Strategy};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

impl ScenarioFile for Strategy {
    type Keys = raw::Strategy;
    const NAME: &'static str = "strategy";
    const FOLDER: &'static str = "strategies";

    fn check(document: &Document<raw::Strategy>) -> Option<Strategy> {
        let raw = &document.raw;
        let roles = match &raw.roles {
            Some(given) => {
                refuse_program(document);
                roles(document, given)
            }
            None => {
                if document.has("assignment") {
                    let message = "assignment is given without roles, which it requires";
                    document.note("assignment", message);
                }
                vec![program::program(document)?]
            }
        };
        let strategy = Strategy {
            name: document.name.clone(),
            about: raw.about.clone(),
            roles,
            assignment: raw.assignment,
        };
        document.is_faultless().then_some(strategy)
    }
}

/// Reports program keys in a file with roles.
fn refuse_program(document: &Document<raw::Strategy>) {
    let keys = [
        "helm",
        "unsafe_i_know",
        "unsafe_because",
        "variables",
        "mode",
        "rule",
    ]
    .map(str::to_owned);
    let behaviours = document.raw.behaviour.keys();
    let behaviours = behaviours.map(|name| format!("behaviour.{name}"));
    let keys = keys.into_iter().chain(behaviours);
    for key in keys.filter(|key| document.has(key)) {
        let message = format!("{key} is given with roles, expected in the files listed in roles");
        document.note(&key, message);
    }
}

/// The programs of a file's roles. A file that is referenced twice is read once.
fn roles(document: &Document<raw::Strategy>, given: &[raw::FilePath]) -> Vec<Program> {
    let mut read: BTreeMap<PathBuf, Option<Program>> = BTreeMap::new();
    let given = given.iter().map(|role| &role.0).enumerate();
    let roles = given.filter(|(_, role)| !role.is_empty());
    let program = |(i, role): (usize, &String)| {
        let at = format!("roles.{i}");
        let path = document.resolve(&at, role);
        let one = read.entry(path.clone());
        one.or_insert_with(|| one_role(document, &at, role, &path))
            .clone()
    };
    roles.filter_map(program).collect()
}

fn one_role(
    strategy: &Document<raw::Strategy>,
    at: &str,
    role: &str,
    path: &Path,
) -> Option<Program> {
    let loader = strategy.loader;
    let asked_at = Some(strategy.at(at));
    let document: Document<raw::Strategy> =
        read::document(loader, Kind::STRATEGY, path, asked_at, Strategy::NAME)?;
    if document.raw.roles.is_some() {
        let message =
            format!("roles has {role:?}, which has roles itself, expected a program file");
        strategy.note(at, message);
        return None;
    }
    program::program(&document)
}
