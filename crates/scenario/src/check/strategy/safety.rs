//! Mandatory safety: in every mode, behaviours keep boats on the field and away from other boats,
//! or the file gives a reason for the exception.

use super::scope::Scope;
use crate::strategy::{Behaviour, Contacts, Program, Task};

/// Checks that a file gives a reason if, and only if, it opts out of safety.
pub(super) fn check_reason(scope: &Scope<'_>) {
    let raw = &scope.document.raw;
    match (raw.unsafe_i_know, &raw.unsafe_because) {
        (false, Some(_)) => {
            scope.note(
                "unsafe_because",
                "is given without unsafe_i_know = true, expected both or neither",
            );
        }
        (true, None) if scope.document.is_sound("unsafe_because") => {
            let at = scope.document.at("unsafe_i_know");
            let diagnostics = &scope.document.loader.diagnostics;
            diagnostics.note_missing(at, "unsafe_because", "the reason");
        }
        (true, Some(because)) if because.trim().is_empty() => {
            scope.note("unsafe_because", "is empty, expected the reason");
        }
        _ => {}
    }
}

/// Reports every mode without safety behaviours, and any unnecessary reason. No other behaviour may
/// outweigh a safety behaviour: constant weights are checked here, and expressions are limited at
/// run time.
pub(super) fn check(scope: &Scope<'_>, program: &mut Program) {
    let is_unsafe = program.unsafe_because.is_some();
    let mut is_lacking = false;
    for leaf in program.leaves() {
        for (kind, all) in [("op_region", ""), ("avoid_collision", " for all contacts")] {
            let is_of_kind = |b: &&Behaviour| b.task.kind() == kind && b.modes[leaf];
            let of_kind = || program.behaviours.iter().filter(is_of_kind);
            if of_kind().any(Behaviour::is_guard) {
                continue;
            }
            is_lacking = true;
            let other = of_kind()
                .find_map(|b| Some(format!(" ({} is not: {})", b.name, b.no_guard_since()?)));
            let message = format!(
                "has no reliable {kind}{}, expected one{all} without when or duration_s, with a \
                 constant weight above 0; or set unsafe_i_know = true and unsafe_because",
                other.unwrap_or_default()
            );
            if !is_unsafe {
                scope.note_mode(program, leaf, &message);
            }
        }
    }
    match (is_unsafe, is_lacking) {
        (true, false) => {
            let message = "is unnecessary: every mode has op_region and avoid_collision; remove it";
            scope.note("unsafe_because", message);
        }
        (false, false) => hold_below_guards(scope, program),
        _ => {}
    }
}

/// Ensures that no behaviour outweighs a safety behaviour in a mode in which both run.
fn hold_below_guards(scope: &Scope<'_>, program: &mut Program) {
    for leaf in program.leaves().collect::<Vec<_>>() {
        // A number can disable a guard: a weight below that of a goal, a range of zero, a region
        // wider than the field, or an expression with such a value. Guards therefore have constants
        // within limits, and nothing outweighs them.
        let weight = |kind: &str| {
            let is_guard = |b: &&Behaviour| b.task.kind() == kind && b.modes[leaf] && b.is_guard();
            let guards = program.behaviours.iter().filter(is_guard);
            let weights = guards.filter_map(|b| b.weight.constant());
            weights.fold(0.0, f64::max)
        };
        let most = weight("op_region").min(weight("avoid_collision"));
        let path = program.path(leaf);
        let goals = program.behaviours.iter_mut();
        for behaviour in goals.filter(|b| b.modes[leaf] && !b.task.is_safety()) {
            match behaviour.weight.constant() {
                Some(weight) if weight > most => {
                    let message = format!(
                        "is {weight} in mode {path}, expected at most {most}, the weight of op_region or \
                        avoid_collision there"
                    );
                    scope.note(&format!("behaviour.{}.weight", behaviour.name), &message);
                }
                Some(_) => {}
                None => behaviour.weight.range.1 = behaviour.weight.range.1.min(most),
            }
        }
    }
}

impl Behaviour {
    /// Whether this is a safety behaviour that always works: it covers the whole field or all other
    /// boats, has no condition and no end, and has a positive weight and effective numbers.
    pub fn is_guard(&self) -> bool {
        matches!(self.task, Task::OpRegion(_) | Task::AvoidCollision(_))
            && self.no_guard_since().is_none()
    }

    /// The reason why this op_region or avoid_collision is not reliable, if any.
    fn no_guard_since(&self) -> Option<String> {
        let numbers = match &self.task {
            Task::OpRegion(task) => [
                ("margin_m", &task.margin_m, (0.0, f64::INFINITY)),
                ("save_m", &task.save_m, (1.0, f64::INFINITY)),
                ("lookahead_s", &task.lookahead_s, (1.0, f64::INFINITY)),
                ("exit_s", &task.exit_s, (0.0, 10.0)),
                (
                    "recovery_speed_m_s",
                    &task.recovery_speed_m_s,
                    (0.1, f64::INFINITY),
                ),
            ]
            .to_vec(),
            Task::AvoidCollision(task) if task.contacts != Contacts::All => {
                return Some("it is not for all contacts".to_owned());
            }
            Task::AvoidCollision(task) => [
                ("outer_m", &task.outer_m, (5.0, f64::INFINITY)),
                ("cpa_max_m", &task.cpa_max_m, (3.0, f64::INFINITY)),
                ("time_on_leg_s", &task.time_on_leg_s, (1.0, f64::INFINITY)),
            ]
            .to_vec(),
            _ => return Some("it is of a different kind".to_owned()),
        };
        if self.when.is_some() {
            return Some("it has a condition".to_owned());
        }
        if self.duration_s.is_some() {
            return Some("it has a duration_s".to_owned());
        }
        if self.weight.constant().is_some_and(|weight| weight <= 0.0) {
            return Some("weight is 0".to_owned());
        }
        let weight = [("weight", &self.weight, (0.0, f64::INFINITY))];
        weight
            .into_iter()
            .chain(numbers)
            .find_map(|(key, number, (least, most))| match number.constant() {
                None => Some(format!("{key} is not constant")),
                Some(value) if value < least => {
                    Some(format!("{key} is {value}, less than {least}"))
                }
                Some(value) if value > most => Some(format!("{key} is {value}, more than {most}")),
                Some(_) => None,
            })
    }
}
