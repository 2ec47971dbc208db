//! A program, checked: its parts, then the whole.

use super::behaviour::behaviours;
use super::expression::{Wanted, expression};
use super::mode::modes;
use super::variable::{set, variables};
use super::{reach, safety};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::{At, RawRule, RawStrategy};
use crate::scenario::strategy_read::Document;
use crate::strategy::{Behaviour, FUNCTIONS_MAX, HEEDED_MAX, Helm, Program, Rule, Task, Trigger, Variable, What, Who};

/// The most that a decision may be worse than the best and stand: more would outweigh safety.
const HYSTERESIS_MAX: f64 = 0.1;
/// The most rules of a program.
const MOST_RULES: usize = 1000;

/// Checks a program.
pub(super) fn program(diagnostics: &mut Diagnostics, document: &Document<RawStrategy>) -> Option<Program> {
    let faults = diagnostics.faults();
    let (raw, start) = (&document.raw, document.start);
    let helm = helm(diagnostics, raw);
    let variables = variables(diagnostics, raw);
    let has_tasks = raw.behaviour.0.iter().all(|behaviour| behaviour.value.task.is_some());
    let modes = modes(diagnostics, &variables, raw, start);
    let behaviours = behaviours(diagnostics, &variables, modes.as_deref(), raw, start);
    let rules = rules(diagnostics, &variables, raw);
    let because = safety::because(diagnostics, raw);
    let (places, modes): (Vec<usize>, Vec<_>) = modes.unwrap_or_default().into_iter().unzip();
    let mut program = Program {
        name: document.name.clone(),
        about: raw.about.as_ref().map(|about| about.value.clone()).unwrap_or_default(),
        helm,
        variables,
        modes,
        behaviours,
        rules,
        unsafe_because: because.as_ref().map(|because| because.value.clone()),
    };
    // What is wrong with a part may be all that is wrong with the whole.
    if has_tasks && diagnostics.faults() == faults {
        count_functions(diagnostics, &program, &places);
        reach::check(diagnostics, &program, &places);
        safety::check(diagnostics, &mut program, (&places, raw), because.as_ref());
    }
    (diagnostics.faults() == faults).then_some(program)
}

/// Notes modes in which the behaviours could ask for more functions than a helm hears.
fn count_functions(diagnostics: &mut Diagnostics, program: &Program, places: &[usize]) {
    for leaf in program.leaves() {
        let most = |behaviour: &Behaviour| match behaviour.task {
            Task::AvoidCollision(_) | Task::AvoidObstacle(_) => HEEDED_MAX,
            Task::CutRange(_) => 2,
            _ => 1,
        };
        let functions: usize = program.behaviours.iter().filter(|b| b.modes[leaf]).map(most).sum();
        if functions > FUNCTIONS_MAX {
            let message = format!(
                "mode {} could ask for {functions} functions at once, expected at most {FUNCTIONS_MAX}: {HEEDED_MAX} for each \
                 avoid_collision and avoid_obstacle, 2 for each cut_range, 1 for each other behaviour",
                program.path(leaf)
            );
            diagnostics.note(places[leaf], message);
        }
    }
}

fn helm(diagnostics: &mut Diagnostics, raw: &RawStrategy) -> Helm {
    let raw = raw.helm.as_ref().map(|helm| helm.value.clone()).unwrap_or_default();
    Helm {
        courses: diagnostics.whole("courses", raw.courses.as_ref(), 8..=3600, 360) as usize,
        speeds: diagnostics.whole("speeds", raw.speeds.as_ref(), 2..=1000, 36) as usize,
        speed_max_m_s: diagnostics.number("speed_max_m_s", raw.speed_max_m_s.as_ref(), 0.1..=60.0),
        hysteresis: diagnostics.number("hysteresis", raw.hysteresis.as_ref(), 0.0..=HYSTERESIS_MAX).unwrap_or(0.0),
    }
}

fn rules(diagnostics: &mut Diagnostics, variables: &[Variable], raw: &RawStrategy) -> Vec<Rule> {
    let given = raw.rule.as_ref().map_or(&[][..], |given| given.value.as_slice());
    if given.len() > MOST_RULES {
        diagnostics
            .note(given[MOST_RULES].at, format!("rule has {} entries, expected at most {MOST_RULES}", given.len()));
    }
    given.iter().take(MOST_RULES).map(|given| rule(diagnostics, variables, given)).collect()
}

fn rule(diagnostics: &mut Diagnostics, variables: &[Variable], given: &At<RawRule>) -> Rule {
    let raw = &given.value;
    if raw.on.is_none() && raw.when.is_none() {
        diagnostics.note_missing(given.at, "rule.on", "it, or when, or both");
    }
    if raw.set.as_ref().is_none_or(|set| set.is_empty()) {
        diagnostics.note_missing(given.at, "rule.set", "values for variables");
    }
    Rule {
        on: raw.on.as_ref().and_then(|on| trigger(diagnostics, on)),
        when: raw.when.as_ref().and_then(|when| expression(diagnostics, variables, "when", when, Wanted::Truth)),
        set: set(diagnostics, variables, raw.set.as_ref()),
    }
}

fn trigger(diagnostics: &mut Diagnostics, on: &At<String>) -> Option<Trigger> {
    let mut words = on.value.split_whitespace();
    let (who, what) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    let found_who = Who::ALL.into_iter().find(|known| known.name() == who);
    let found_what = What::ALL.into_iter().find(|known| known.name() == what);
    if let (Some(who), Some(what), None) = (found_who, found_what, words.next()) {
        return Some(Trigger { who, what });
    }
    let (all_who, all_what) = (Who::ALL.map(Who::name), What::ALL.map(What::name));
    let who = if found_who.is_some() { Some(who) } else { nearest(who, &all_who) };
    let what = if found_what.is_some() { Some(what) } else { nearest(what, &all_what) };
    let guess = who.zip(what).map(|(who, what)| format!(" (did you mean {who} {what}?)")).unwrap_or_default();
    let message = format!(
        "on is {:?}, expected one of {}, then one of {}{guess}",
        on.value,
        all_who.join(", "),
        all_what.join(", ")
    );
    diagnostics.note(on.at, message);
    None
}
