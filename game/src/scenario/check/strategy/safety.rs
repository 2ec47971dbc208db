//! Safety is not optional: every mode has what keeps a boat on the field and off other boats, or the file says why not.

use crate::scenario::ledger::Ledger;
use crate::scenario::raw::{At, RawStrategy};
use crate::strategy::{Behaviour, Contacts, Program, Task};

/// Why the file wants to do without, if it does.
pub(super) fn because(ledger: &mut Ledger, raw: &RawStrategy) -> Option<At<String>> {
    let knows = raw.unsafe_i_know.as_ref().filter(|knows| knows.value);
    match (knows, &raw.unsafe_because) {
        (None, None) => None,
        (None, Some(because)) => {
            ledger.note(because.at, "unsafe_because is given without unsafe_i_know = true, expected both or neither");
            None
        }
        (Some(knows), None) => {
            ledger.note_missing(knows.at, "unsafe_because", "the reason");
            None
        }
        (Some(_), Some(because)) if because.value.trim().is_empty() => {
            ledger.note(because.at, "unsafe_because is empty, expected the reason");
            None
        }
        (Some(_), Some(because)) => Some(because.clone()),
    }
}

/// Notes every mode that lacks something, or the reason that nothing needs.
pub(super) fn check(ledger: &mut Ledger, program: &Program, places: &[usize], because: Option<&At<String>>) {
    let mut lacking = vec![];
    for leaf in program.leaves() {
        for kind in ["op_region", "avoid_collision"] {
            if !program.behaviours.iter().any(|behaviour| guards(behaviour, kind, leaf)) {
                lacking.push((leaf, kind));
            }
        }
    }
    match because {
        Some(because) if lacking.is_empty() => {
            ledger.note(
                because.at,
                "unsafe_because is not needed: every mode has op_region and avoid_collision, expected none",
            );
        }
        Some(_) => {}
        None => {
            for (leaf, kind) in lacking {
                let all = if kind == "avoid_collision" { " for all contacts" } else { "" };
                let message = format!(
                    "mode {} has no {kind} on guard, expected a behaviour of this kind{all}, without when and \
                     duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
                    program.path(leaf)
                );
                ledger.note(places[leaf], message);
            }
        }
    }
}

/// Whether the behaviour is of this kind and always heard in this mode.
fn guards(behaviour: &Behaviour, kind: &str, mode: usize) -> bool {
    behaviour.task.kind() == kind && behaviour.modes[mode] && behaviour.is_guard()
}

impl Behaviour {
    /// Whether this is a behaviour that keeps the boat safe wherever it is in force: on the field or off all other
    /// boats, without a condition, without end, and with a weight.
    #[must_use]
    pub fn is_guard(&self) -> bool {
        let keeps_safe = match &self.task {
            Task::OpRegion(_) => true,
            Task::AvoidCollision(avoid) => avoid.contacts == Contacts::All,
            _ => false,
        };
        let weight = self.weight.constant();
        keeps_safe && self.when.is_none() && self.duration_s.is_none() && weight.is_some_and(|weight| weight > 0.0)
    }
}
