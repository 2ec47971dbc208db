//! A strategy file, checked: the roles that it deals, or the program that it is.

mod behaviour;
mod cel;
mod claim;
mod expression;
mod mode;
mod program;
mod reach;
mod safety;
mod task;
mod variable;

use crate::field::Field;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::{At, RawStrategy};
use crate::scenario::strategy_read::{self as read, Document};
use crate::strategy::{Assignment, Program, Strategy};
use std::path::{Path, PathBuf};

/// The most roles of a strategy.
const MOST_ROLES: usize = 1000;

/// Reads and checks the strategy file at a path, which is referred to from a place; it has no numbers that are drawn.
pub(in crate::scenario) fn strategy_file(
    diagnostics: &mut Diagnostics,
    path: &Path,
    asked_at: Option<usize>,
    _: &str,
) -> Option<Strategy> {
    let document = read::document(diagnostics, path, asked_at)?;
    strategy(diagnostics, &document)
}

/// Checks a strategy.
pub(in crate::scenario) fn strategy(
    diagnostics: &mut Diagnostics,
    document: &Document<RawStrategy>,
) -> Option<Strategy> {
    let faults = diagnostics.faults();
    let raw = &document.raw;
    let roles = match &raw.roles {
        Some(given) => {
            refuse_program(diagnostics, raw);
            roles(diagnostics, given)
        }
        None => {
            if let Some(assignment) = &raw.assignment {
                diagnostics.note(assignment.at, "assignment is given without roles, expected with them only");
            }
            vec![program::program(diagnostics, document)?]
        }
    };
    let strategy = Strategy {
        name: document.name.clone(),
        about: raw.about.as_ref().map(|about| about.value.clone()).unwrap_or_default(),
        roles,
        assignment: raw.assignment.as_ref().map_or(Assignment::Fixed, |assignment| assignment.value),
    };
    (diagnostics.faults() == faults).then_some(strategy)
}

/// Notes what a program says in a file that deals roles.
fn refuse_program(diagnostics: &mut Diagnostics, raw: &RawStrategy) {
    let said = [
        ("helm", raw.helm.as_ref().map(|given| given.at)),
        ("unsafe_i_know", raw.unsafe_i_know.as_ref().map(|given| given.at)),
        ("unsafe_because", raw.unsafe_because.as_ref().map(|given| given.at)),
        ("variables", raw.variables.as_ref().map(|given| given.at)),
        ("mode", raw.mode.as_ref().map(|given| given.at)),
        ("rule", raw.rule.as_ref().map(|given| given.at)),
    ];
    let said = said.into_iter().filter_map(|(key, at)| at.map(|at| (key.to_owned(), at)));
    let behaviours = raw.behaviour.0.iter().map(|given| (format!("behaviour.{}", given.value.name), given.at));
    for (key, at) in said.chain(behaviours) {
        diagnostics.note(at, format!("{key} is given with roles, expected in the files that roles names"));
    }
}

/// The programs of the roles that a file names; a file named twice is read once.
fn roles(diagnostics: &mut Diagnostics, given: &At<Vec<At<String>>>) -> Vec<Program> {
    if !(1..=MOST_ROLES).contains(&given.value.len()) {
        diagnostics.note(given.at, format!("roles has {} entries, expected 1 to {MOST_ROLES}", given.value.len()));
    }
    let mut read: Vec<(PathBuf, Option<Program>)> = vec![];
    let mut roles = vec![];
    for role in given.value.iter().take(MOST_ROLES) {
        let path = diagnostics.sources.resolve(role.at, &role.value);
        if !read.iter().any(|(known, _)| *known == path) {
            let document = read::document::<RawStrategy>(diagnostics, &path, Some(role.at));
            let program = document.and_then(|document| one_role(diagnostics, role, &document));
            read.push((path.clone(), program));
        }
        roles.extend(read.iter().find(|(known, _)| *known == path).and_then(|(_, program)| program.clone()));
    }
    roles
}

fn one_role(diagnostics: &mut Diagnostics, role: &At<String>, document: &Document<RawStrategy>) -> Option<Program> {
    if document.raw.roles.is_some() {
        let message =
            format!("roles names {:?}, which deals roles itself, expected the file of one program", role.value);
        diagnostics.note(role.at, message);
        return None;
    }
    program::program(diagnostics, document)
}

/// Whether `name` is one of the field's named points; notes it if not.
pub(super) fn is_point(diagnostics: &mut Diagnostics, at: usize, key: &str, name: &str) -> bool {
    let names = Field::point_names();
    let is_known = names.iter().any(|known| known == name);
    if !is_known {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let guess = nearest(name, &names).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
        diagnostics.note(at, format!("{key} is {name:?}, expected a named point, one of {}{guess}", names.join(" ")));
    }
    is_known
}
