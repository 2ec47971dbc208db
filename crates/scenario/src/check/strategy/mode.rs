//! Checks the modes of a strategy: a tree in which every sibling but the last has a condition.

use super::scope::Scope;
use super::variable::set;
use crate::guess::listed;
use crate::strategy::Mode;

/// Maximum nesting depth of modes.
const DEEPEST: usize = 20;

/// Checks the modes; `None` if they do not form a tree.
pub(super) fn modes(scope: &Scope<'_>) -> Option<Vec<Mode>> {
    let given = &scope.document.raw.mode;
    if given.is_empty() {
        return Some(vec![Mode {
            name: "active".to_owned(),
            parent: None,
            when: None,
            enter: vec![],
        }]);
    }
    let faults = || scope.document.loader.diagnostics.faults();
    let before = faults();
    let mut modes: Vec<Mode> = vec![];
    for (i, mode) in given.iter().enumerate() {
        let name = mode.name.0.clone();
        if !name.is_empty() && modes.iter().any(|other| other.name == name) {
            let message = format!("{name:?} is used twice, expected a unique name for each mode");
            scope.note(&format!("mode.{i}.name"), &message);
        }
        let parent = mode.r#in.as_ref();
        let parent = parent.and_then(|parent| self::parent(scope, &modes, i, parent));
        let enter = set(scope, &format!("mode.{i}.set"), &mode.set);
        modes.push(Mode {
            name,
            parent,
            when: None,
            enter,
        });
    }
    check_conditions(scope, &modes);
    let is_tree = scope.document.is_sound("mode") && faults() == before;
    for (i, mode) in given.iter().enumerate() {
        modes[i].when = scope.condition(&format!("mode.{i}.when"), mode.when.as_deref());
    }
    is_tree.then_some(modes)
}

fn parent(scope: &Scope<'_>, before: &[Mode], mode: usize, parent: &str) -> Option<usize> {
    let path = format!("mode.{mode}.in");
    let Some(found) = before.iter().position(|mode| mode.name == parent) else {
        let mut given = scope.document.raw.mode.iter();
        let message = if given.any(|mode| mode.name.0 == parent) {
            format!("is {parent:?}, which comes later, expected an earlier mode")
        } else {
            let names: Vec<&str> = before.iter().map(|mode| mode.name.as_str()).collect();
            let known = match names.as_slice() {
                [] => "but there is none".to_owned(),
                names => listed(parent, names),
            };
            format!("is {parent:?}, expected an earlier mode, {known}")
        };
        return scope.refuse(&path, &message);
    };
    let depth = std::iter::successors(Some(found), |mode| before[*mode].parent).count();
    if depth >= DEEPEST {
        let levels = depth + 1;
        let message = format!("is nested {levels} levels deep, expected at most {DEEPEST}");
        scope.note(&path, &message);
    }
    Some(found)
}

/// Checks that every sibling except the last has a condition, and that the last has none.
fn check_conditions(scope: &Scope<'_>, modes: &[Mode]) {
    let given = &scope.document.raw.mode;
    // This cannot be decided if the parent is unknown.
    let is_known = |mode: usize| given[mode].r#in.is_some() == modes[mode].parent.is_some();
    for (i, mode) in modes.iter().enumerate().filter(|(i, _)| is_known(*i)) {
        let next = (i + 1..modes.len())
            .find(|other| modes[*other].parent == mode.parent && is_known(*other));
        let name = &mode.name;
        let path = format!("mode.{i}.when");
        match (&given[i].when, next) {
            (None, Some(next)) => {
                let next = &modes[next].name;
                let expected =
                    format!("a condition: without one for {name}, {next} is never active");
                scope.note_missing(&path, &expected);
            }
            (Some(_), None) => {
                let part_of = |parent: usize| format!("child of {}", modes[parent].name);
                let of = mode.parent.map_or_else(|| "mode".to_owned(), part_of);
                let message = format!(
                    "`when` is not allowed in {name}, the last {of}, which is the fallback"
                );
                scope.document.note(&path, message);
            }
            _ => {}
        }
    }
}
