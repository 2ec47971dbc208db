//! Checks a program: its parts, then the whole.

use super::behaviour::behaviours;
use super::mode::modes;
use super::scope::Scope;
use super::variable::{set, variables};
use super::{reachability, safety};
use crate::guess::nearest;
use crate::raw;
use crate::read::Document;
use crate::strategy::{
    Behaviour, FUNCTIONS_MAX, NEAREST_MAX, Named, Program, Rule, Task, Trigger, What, Who,
};

pub(super) fn program(document: &Document<raw::Strategy>) -> Option<Program> {
    let raw = &document.raw;
    let faults = || document.loader.diagnostics.faults();
    let before = faults();
    let variables = variables(document);
    let scope = Scope {
        document,
        variables: &variables,
    };
    let modes = modes(&scope);
    let behaviours = behaviours(&scope, modes.as_deref());
    let rules = raw.rule.iter().enumerate();
    let rules = rules.map(|(i, given)| rule(&scope, i, given)).collect();
    safety::check_reason(&scope);
    // Faults in a part may cause faults in the whole.
    if faults() > before || !document.is_sound("") {
        return None;
    }
    let mut program = Program {
        name: document.name.clone(),
        about: raw.about.clone(),
        helm: raw.helm,
        variables: variables.clone(),
        modes: modes.unwrap_or_default(),
        behaviours,
        rules,
        unsafe_because: raw.unsafe_because.clone(),
    };
    check_functions(&scope, &program);
    reachability::check(&scope, &program);
    safety::check(&scope, &mut program);
    document.is_faultless().then_some(program)
}

/// Reports modes whose behaviours could exceed the helm's maximum number of functions.
fn check_functions(scope: &Scope<'_>, program: &Program) {
    for leaf in program.leaves() {
        let most = |behaviour: &Behaviour| match behaviour.task {
            Task::AvoidCollision(_) | Task::AvoidObstacle(_) => NEAREST_MAX,
            Task::CutRange(_) => 2,
            _ => 1,
        };
        let behaviours = program.behaviours.iter().filter(|b| b.modes[leaf]);
        let functions: usize = behaviours.map(most).sum();
        if functions > FUNCTIONS_MAX {
            let message = format!(
                "may need {functions} functions at once, expected at most {FUNCTIONS_MAX}: {NEAREST_MAX} for each \
                 avoid_collision and avoid_obstacle, 2 for each cut_range, 1 for each other behaviour"
            );
            scope.note_mode(program, leaf, &message);
        }
    }
}

fn rule(scope: &Scope<'_>, rule: usize, given: &raw::Rule) -> Rule {
    let path = |key: &str| format!("rule.{rule}.{key}");
    if given.on.is_none() && given.when.is_none() {
        scope.note_missing(&path("on"), "on, when or both");
    }
    if given.set.is_empty() && scope.document.is_sound(&path("set")) {
        scope.note(&path("set"), "is empty, expected values for variables");
    }
    let on = given.on.as_ref();
    Rule {
        on: on.and_then(|on| trigger(scope, &path("on"), on)),
        when: scope.condition(&path("when"), given.when.as_deref()),
        set: set(scope, &path("set"), &given.set),
    }
}

fn trigger(scope: &Scope<'_>, path: &str, on: &str) -> Option<Trigger> {
    let mut words = on.split_whitespace();
    let who = words.next().unwrap_or_default();
    let what = words.next().unwrap_or_default();
    if let (Some(who), Some(what), None) = (Who::by_name(who), What::by_name(what), words.next()) {
        return Some(Trigger { who, what });
    }
    let guess = nearest(who, &Who::names()).zip(nearest(what, &What::names()));
    let guess = guess
        .map(|(who, what)| format!(" (did you mean {who} {what}?)"))
        .unwrap_or_default();
    let who = Who::names().join(", ");
    let what = What::names().join(", ");
    scope.note(
        path,
        &format!("is {on:?}, expected one of {who}, then one of {what}{guess}"),
    );
    None
}
