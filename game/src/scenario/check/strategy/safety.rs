//! Safety is not optional: every mode has what keeps a boat on the field and off other boats, or the file says why not.

use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::raw::{At, RawStrategy};
use crate::strategy::{Behaviour, Contacts, Program, Task};

/// Why the file wants to do without, if it does.
pub(super) fn because(diagnostics: &mut Diagnostics, raw: &RawStrategy) -> Option<At<String>> {
    let knows = raw.unsafe_i_know.as_ref().filter(|knows| knows.value);
    match (knows, &raw.unsafe_because) {
        (None, None) => None,
        (None, Some(because)) => {
            diagnostics
                .note(because.at, "unsafe_because is given without unsafe_i_know = true, expected both or neither");
            None
        }
        (Some(knows), None) => {
            diagnostics.note_missing(knows.at, "unsafe_because", "the reason");
            None
        }
        (Some(_), Some(because)) if because.value.trim().is_empty() => {
            diagnostics.note(because.at, "unsafe_because is empty, expected the reason");
            None
        }
        (Some(_), Some(because)) => Some(because.clone()),
    }
}

/// Notes every mode that lacks something, or the reason that nothing needs. Whoever keeps the boat safe is outweighed by no
/// other behaviour: numbers that would are noted, expressions are held below.
pub(super) fn check(
    diagnostics: &mut Diagnostics,
    program: &mut Program,
    (places, raw): (&[usize], &RawStrategy),
    because: Option<&At<String>>,
) {
    let mut lacking = vec![];
    for leaf in program.leaves() {
        for kind in ["op_region", "avoid_collision"] {
            let of_kind = || program.behaviours.iter().filter(|b| b.task.kind() == kind && b.modes[leaf]);
            if !of_kind().any(Behaviour::is_guard) {
                lacking.push((leaf, kind, of_kind().find_map(|b| Some((b.name.clone(), b.no_guard_since()?)))));
            }
        }
    }
    match because {
        Some(because) if lacking.is_empty() => {
            diagnostics.note(
                because.at,
                "unsafe_because is not needed: every mode has op_region and avoid_collision, expected none",
            );
        }
        Some(_) => {}
        None => {
            for (leaf, kind, other) in &lacking {
                let all = if *kind == "avoid_collision" { " for all contacts" } else { "" };
                let other = other.as_ref().map(|(name, why)| format!(" ({name} is none: {why})")).unwrap_or_default();
                let message = format!(
                    "mode {} has no {kind} on guard{other}, expected a behaviour of this kind{all}, without when and \
                     duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
                    program.path(*leaf)
                );
                diagnostics.note(places[*leaf], message);
            }
            if lacking.is_empty() {
                hold_below_guards(diagnostics, program, raw);
            }
        }
    }
}

/// Sees to it that no behaviour outweighs what keeps the boat safe in a mode in which both run.
fn hold_below_guards(diagnostics: &mut Diagnostics, program: &mut Program, raw: &RawStrategy) {
    for leaf in program.leaves().collect::<Vec<_>>() {
        let weight = |kind: &str| {
            let guards = program.behaviours.iter().filter(|b| b.task.kind() == kind && b.modes[leaf] && b.is_guard());
            guards.filter_map(|b| b.weight.constant()).fold(0.0, f64::max)
        };
        let most = weight("op_region").min(weight("avoid_collision"));
        let path = program.path(leaf);
        for behaviour in &mut program.behaviours {
            let is_safety =
                matches!(behaviour.task, Task::OpRegion(_) | Task::AvoidCollision(_) | Task::AvoidObstacle(_));
            if is_safety || !behaviour.modes[leaf] {
                continue;
            }
            let Some(weight) = behaviour.weight.constant() else {
                behaviour.weight.range.1 = behaviour.weight.range.1.min(most);
                continue;
            };
            if weight > most {
                let given = raw.behaviour.0.iter().find(|given| given.value.name == behaviour.name);
                let at =
                    given.map_or(0, |given| given.value.common.weight.as_ref().map_or(given.at, |weight| weight.at));
                let message = format!(
                    "weight is {weight} in mode {path}, expected at most {most}, which op_region or avoid_collision has there"
                );
                diagnostics.note(at, message);
            }
        }
    }
}

impl Behaviour {
    /// Whether this is a behaviour that keeps the boat safe wherever it is in force: on the field or off all other
    /// boats, without a condition, without end, with a weight, and with numbers with which it can.
    #[must_use]
    pub fn is_guard(&self) -> bool {
        matches!(self.task, Task::OpRegion(_) | Task::AvoidCollision(_)) && self.no_guard_since().is_none()
    }

    /// Why this op_region or avoid_collision cannot be relied on, if it cannot.
    fn no_guard_since(&self) -> Option<String> {
        let numbers = match &self.task {
            Task::OpRegion(task) => [
                ("margin_m", &task.margin_m, (0.0, f64::INFINITY)),
                ("save_m", &task.save_m, (1.0, f64::INFINITY)),
                ("lookahead_s", &task.lookahead_s, (1.0, f64::INFINITY)),
                ("exit_s", &task.exit_s, (0.0, 10.0)),
                ("recovery_speed_m_s", &task.recovery_speed_m_s, (0.1, f64::INFINITY)),
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
            _ => return Some("it is of another kind".to_owned()),
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
        weight.into_iter().chain(numbers).find_map(|(key, number, (least, most))| match number.constant() {
            None => Some(format!("{key} is no number")),
            Some(value) if value < least => Some(format!("{key} is {value}, less than {least}")),
            Some(value) if value > most => Some(format!("{key} is {value}, more than {most}")),
            Some(_) => None,
        })
    }
}
