//! Modes that can never be: decided over everything that their conditions can tell apart.

use super::formula::{Formula, Formulas, given_to};
use super::scope::Scope;
use crate::strategy::{Expression, Program};
use std::collections::BTreeSet;

/// Of one mode no more cases than this are looked at; it is then taken to be possible.
const MOST_CASES: usize = 200_000;
/// Of a program no more steps than this are made; modes that are left are taken to be possible.
const MOST_STEPS: usize = 50_000_000;

/// Notes every mode whose conditions can never choose it. Parts of such a mode have had their say with it.
pub(super) fn check(scope: &mut Scope<'_>, program: &Program) {
    let formulas = Formulas::of(program);
    let mut search = Search { formulas: &formulas, values: vec![None; formulas.values.len()], cases: 0, steps: 0 };
    let mut never = vec![false; program.modes.len()];
    for (i, mode) in program.modes.iter().enumerate() {
        never[i] = mode.parent.is_some_and(|parent| never[parent]);
        if never[i] || search.is_possible(&wanted(program, &formulas, i, true)) {
            continue;
        }
        never[i] = true;
        let before: Vec<&str> = before(program, i).map(|other| program.modes[other].name.as_str()).collect();
        let alone = wanted(program, &formulas, i, false);
        let why = if !alone.is_empty() && !search.is_possible(&alone) {
            format!("its when never holds{}", only_ever(program, i))
        } else if before.is_empty() {
            "its when never holds in the modes that it is in".to_owned()
        } else {
            format!("whenever it could be, one before it is: {}", before.join(", "))
        };
        scope.note_mode(program, i, &format!("can never be ({why}), expected one that can"));
    }
}

/// What the variables of a mode's condition ever are, where that is not everything.
fn only_ever(program: &Program, mode: usize) -> String {
    let mut asked = BTreeSet::new();
    let when = program.modes[mode].when.iter();
    when.for_each(|when| when.walk(&mut |part| asked.extend(Some(part).and_then(variable))));
    let mut words = String::new();
    for index in asked {
        let Some(values) = given_to(program, index) else { continue };
        let word = |value: &f64| program.value_text(index, &Expression::Constant(*value));
        let values: Vec<String> = values.iter().map(word).collect();
        let name = &program.variables[usize::from(index)].name;
        words.push_str(&format!("; {name} is only ever {}", values.join(" or ")));
    }
    words
}

fn variable(part: &Expression) -> Option<u16> {
    if let Expression::Variable(index) = part { Some(*index) } else { None }
}

/// The parts of the same mode that are asked before this one.
fn before(program: &Program, mode: usize) -> impl Iterator<Item = usize> {
    (0..mode).filter(move |other| program.modes[*other].parent == program.modes[mode].parent)
}

/// What must hold, and what must not, for a mode to be; alone, only its own condition.
fn wanted<'a>(program: &Program, formulas: &'a Formulas, mode: usize, in_place: bool) -> Vec<(&'a Formula, bool)> {
    let condition = |mode: usize| formulas.of_modes[mode].as_ref();
    let mut wanted: Vec<(&Formula, bool)> = condition(mode).map(|when| (when, true)).into_iter().collect();
    let mut at = Some(mode).filter(|_| in_place);
    while let Some(mode) = at {
        wanted.extend(before(program, mode).filter_map(condition).map(|when| (when, false)));
        at = program.modes[mode].parent;
        wanted.extend(at.and_then(condition).map(|when| (when, true)));
    }
    wanted.extend(formulas.laws.iter().map(|law| (law, true)));
    wanted
}

/// A search through the cases that conditions can tell apart.
struct Search<'a> {
    formulas: &'a Formulas,
    /// For each term, the value that is tried.
    values: Vec<Option<f64>>,
    cases: usize,
    steps: usize,
}

impl Search<'_> {
    /// Whether there is a case in which all that is wanted holds; `true` as well where there are too many.
    fn is_possible(&mut self, wanted: &[(&Formula, bool)]) -> bool {
        self.cases = 0;
        self.values.fill(None);
        self.is_possible_from(wanted)
    }

    fn is_possible_from(&mut self, wanted: &[(&Formula, bool)]) -> bool {
        self.cases += 1;
        if self.cases > MOST_CASES || self.steps > MOST_STEPS {
            return true;
        }
        let mut open = None;
        for (formula, must) in wanted {
            match formula.holds(&self.values, &mut self.steps) {
                Some(holds) if holds != *must => return false,
                Some(_) => {}
                None => open = open.or(Some(*formula)),
            }
        }
        let Some(open) = open else { return true };
        let term = open.open_term(&self.values).expect("a formula that is open has an open term");
        for value in &self.formulas.values[term] {
            self.values[term] = Some(*value);
            if self.is_possible_from(wanted) {
                return true;
            }
        }
        self.values[term] = None;
        false
    }
}
