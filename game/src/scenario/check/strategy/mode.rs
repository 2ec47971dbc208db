//! Modes of a strategy, checked: a tree, in which every part but the last has a condition.

use super::expression::{Wanted, expression};
use super::variable::set;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::{At, RawMode, RawStrategy};
use crate::strategy::{Mode, Variable};

/// The most modes of a program.
const MOST: usize = 1000;
/// How deep modes may lie in each other.
const DEEPEST: usize = 20;

/// Checks the modes; each comes with its place in the file. Where they make no tree, nothing comes back.
pub(super) fn modes(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    raw: &RawStrategy,
    start: usize,
) -> Option<Vec<(usize, Mode)>> {
    let given = raw.mode.as_ref().map_or(&[][..], |given| given.value.as_slice());
    if given.is_empty() {
        return Some(vec![(start, Mode { name: "active".to_owned(), parent: None, when: None, enter: vec![] })]);
    }
    if given.len() > MOST {
        diagnostics.note(given[MOST].at, format!("mode has {} entries, expected at most {MOST}", given.len()));
        return None;
    }
    let faults = diagnostics.faults();
    let mut modes: Vec<(usize, Mode)> = vec![];
    for mode in given {
        let raw = &mode.value;
        let name = name(diagnostics, &modes, mode);
        let parent = raw.r#in.as_ref().and_then(|parent| self::parent(diagnostics, given, &modes, parent));
        let enter = set(diagnostics, variables, raw.set.as_ref());
        modes.push((mode.at, Mode { name, parent, when: None, enter }));
    }
    check_conditions(diagnostics, given, &modes);
    let is_tree = diagnostics.faults() == faults;
    for (i, mode) in given.iter().enumerate() {
        let when = mode.value.when.as_ref();
        modes[i].1.when = when.and_then(|when| expression(diagnostics, variables, "when", when, Wanted::Truth));
    }
    is_tree.then_some(modes)
}

fn name(diagnostics: &mut Diagnostics, modes: &[(usize, Mode)], mode: &At<RawMode>) -> String {
    let Some(name) = &mode.value.name else {
        diagnostics.note_missing(mode.at, "mode.name", "1 to 40 of a-z, 0-9 and _");
        return String::new();
    };
    if diagnostics.is_name(name.at, "name", &name.value) && modes.iter().any(|(_, other)| other.name == name.value) {
        diagnostics.note(name.at, format!("name is {:?} again, expected a different one for each mode", name.value));
    }
    name.value.clone()
}

fn parent(
    diagnostics: &mut Diagnostics,
    given: &[At<RawMode>],
    before: &[(usize, Mode)],
    parent: &At<String>,
) -> Option<usize> {
    let found = before.iter().position(|(_, mode)| mode.name == parent.value);
    let Some(found) = found else {
        let names: Vec<&str> = before.iter().map(|(_, mode)| mode.name.as_str()).collect();
        let is_later = given.iter().any(|mode| mode.value.name.as_ref().is_some_and(|name| name.value == parent.value));
        let guess = nearest(&parent.value, &names).map(|guess| format!(" (did you mean {guess}?)"));
        let message = if is_later {
            format!("in is {:?}, which does not stand before this mode, expected one that does", parent.value)
        } else {
            let names = if names.is_empty() { "of which there are none".to_owned() } else { names.join(", ") };
            format!("in is {:?}, expected one of the modes before, {names}{}", parent.value, guess.unwrap_or_default())
        };
        diagnostics.note(parent.at, message);
        return None;
    };
    let depth = std::iter::successors(Some(found), |mode| before[*mode].1.parent).count();
    if depth >= DEEPEST {
        diagnostics.note(parent.at, format!("in makes {} modes in each other, expected at most {DEEPEST}", depth + 1));
    }
    Some(found)
}

/// Every part but the last needs a condition, the last must have none.
fn check_conditions(diagnostics: &mut Diagnostics, given: &[At<RawMode>], modes: &[(usize, Mode)]) {
    for (i, (at, mode)) in modes.iter().enumerate() {
        // With a parent that is unknown nobody can say.
        if given[i].value.r#in.is_some() != mode.parent.is_some() {
            continue;
        }
        let next = (i + 1..modes.len()).find(|other| {
            modes[*other].1.parent == mode.parent && given[*other].value.r#in.is_some() == mode.parent.is_some()
        });
        match (&given[i].value.when, next) {
            (None, Some(next)) => {
                let (name, next) = (&mode.name, &modes[next].1.name);
                diagnostics.note_missing(
                    *at,
                    "mode.when",
                    &format!("a condition: without one for {name} it is never {next}"),
                );
            }
            (Some(when), None) => {
                let of =
                    mode.parent.map_or_else(|| "mode".to_owned(), |parent| format!("part of {}", modes[parent].1.name));
                let name = &mode.name;
                diagnostics.note(
                    when.at,
                    format!("when is given for {name}, the last {of}, expected none: it is what remains"),
                );
            }
            _ => {}
        }
    }
}
