//! Modes that can never be: decided over everything that their conditions can tell apart.

use super::claim::{Claim, Claims, given_to};
use crate::scenario::diagnostics::Diagnostics;
use crate::strategy::{Expression, Program};
use std::collections::BTreeSet;

/// Of one mode no more cases than this are looked at; it is then taken to be possible.
const MOST_CASES: usize = 200_000;
/// Of a program no more steps than this are made; modes that are left are taken to be possible.
const MOST_STEPS: usize = 50_000_000;

/// Notes every mode whose conditions can never choose it. Parts of such a mode have had their say with it.
pub(super) fn check(diagnostics: &mut Diagnostics, program: &Program, places: &[usize]) {
    let claims = Claims::of(program);
    let mut search = Search { claims: &claims, held: vec![None; claims.terms()], cases: 0, steps: 0 };
    let mut never = vec![false; program.modes.len()];
    for (i, mode) in program.modes.iter().enumerate() {
        never[i] = mode.parent.is_some_and(|parent| never[parent]);
        if never[i] || search.is_possible(&wanted(program, &claims, i, true)) {
            continue;
        }
        never[i] = true;
        let before: Vec<&str> = before(program, i).map(|other| program.modes[other].name.as_str()).collect();
        let alone = wanted(program, &claims, i, false);
        let why = if !alone.is_empty() && !search.is_possible(&alone) {
            format!("its when never holds{}", only_ever(program, i))
        } else if before.is_empty() {
            "its when never holds in the modes that it is in".to_owned()
        } else {
            format!("whenever it could be, one before it is: {}", before.join(", "))
        };
        diagnostics.note(places[i], format!("mode {} can never be ({why}), expected one that can", program.path(i)));
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
        let word = |value: &f64| program.value_in_words(index, &Expression::Constant(*value));
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
fn wanted<'a>(program: &Program, claims: &'a Claims, mode: usize, in_place: bool) -> Vec<(&'a Claim, bool)> {
    let mut wanted: Vec<(&Claim, bool)> = claims.of_mode(mode).map(|claim| (claim, true)).into_iter().collect();
    let mut at = Some(mode).filter(|_| in_place);
    while let Some(mode) = at {
        wanted.extend(before(program, mode).filter_map(|other| claims.of_mode(other)).map(|claim| (claim, false)));
        at = program.modes[mode].parent;
        wanted.extend(at.and_then(|parent| claims.of_mode(parent)).map(|claim| (claim, true)));
    }
    wanted.extend(claims.laws().map(|law| (law, true)));
    wanted
}

/// A search through the cases that conditions can tell apart.
struct Search<'a> {
    claims: &'a Claims,
    /// For each term, the value that is looked at.
    held: Vec<Option<f64>>,
    cases: usize,
    steps: usize,
}

impl Search<'_> {
    /// Whether there is a case in which all that is wanted holds; `true` as well where there are too many.
    fn is_possible(&mut self, wanted: &[(&Claim, bool)]) -> bool {
        self.cases = 0;
        self.held.fill(None);
        self.is_possible_from(wanted)
    }

    fn is_possible_from(&mut self, wanted: &[(&Claim, bool)]) -> bool {
        self.cases += 1;
        if self.cases > MOST_CASES || self.steps > MOST_STEPS {
            return true;
        }
        let mut open = None;
        for (claim, must) in wanted {
            match claim.holds(&self.held, &mut self.steps) {
                Some(holds) if holds != *must => return false,
                Some(_) => {}
                None => open = open.or(Some(*claim)),
            }
        }
        let Some(open) = open else { return true };
        let term = open.open_term(&self.held).expect("a claim that is open has an open term");
        for value in self.claims.values(term) {
            self.held[term] = Some(*value);
            if self.is_possible_from(wanted) {
                return true;
            }
        }
        self.held[term] = None;
        false
    }
}
