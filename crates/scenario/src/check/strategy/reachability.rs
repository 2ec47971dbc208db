//! Detects unreachable modes by enumerating all cases that their conditions distinguish.
//!
//! A term is a fact, a variable, a measure or a count of teammates. A number compared with
//! constants gets one value for each constant and for each gap between constants. Other conditions,
//! such as a comparison of two numbers, are terms that may be true or false. This may overestimate
//! the number of cases, but never underestimates it.

use super::scope::Scope;
use crate::strategy::{Expression, Fact, Join, Kind, Measure, Program, Task};
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of cases per mode; with more, the mode counts as reachable.
const MOST_CASES: usize = 200_000;
/// Maximum number of steps per program; after these, the remaining modes count as reachable.
const MOST_STEPS: usize = 50_000_000;
/// Maximum number of terms per program; with more, all modes count as reachable.
const MOST_TERMS: usize = u16::MAX as usize;

/// Reports every unreachable mode, but not its children.
pub(super) fn check(scope: &Scope<'_>, program: &Program) {
    let mut terms = Terms {
        program,
        index: BTreeMap::new(),
        values: vec![],
    };
    let conditions = program.modes.iter().map(|mode| mode.when.as_ref());
    let conditions = conditions.map(|when| when.map(|when| terms.formula(when)));
    let conditions: Vec<Option<Expression>> = conditions.collect();
    let laws = laws().map(|law| terms.formula(&law));
    if terms.values.len() > MOST_TERMS {
        return;
    }
    for values in &mut terms.values {
        values.sort_by(f64::total_cmp);
        values.dedup();
    }
    let tried = vec![None; terms.values.len()];
    let mut search = Search {
        laws: &laws,
        values: terms.values,
        tried,
        cases: 0,
        steps: 0,
    };
    let mut never = vec![false; program.modes.len()];
    for (i, mode) in program.modes.iter().enumerate() {
        never[i] = mode.parent.is_some_and(|parent| never[parent]);
        if never[i] || search.is_possible(&wanted(program, &conditions, i)) {
            continue;
        }
        never[i] = true;
        let before: Vec<&str> = before(program, i)
            .map(|other| program.modes[other].name.as_str())
            .collect();
        let why = if conditions[i]
            .as_ref()
            .is_some_and(|when| !search.is_possible(&[(when, true)]))
        {
            format!("its when never holds{}", only_ever(program, i))
        } else if before.is_empty() {
            "its when never holds in its parent modes".to_owned()
        } else {
            format!("an earlier mode always applies: {}", before.join(", "))
        };
        scope.note_mode(program, i, &format!("can never be active ({why})"));
    }
}

/// The end of a message: the values of those variables in a mode's condition that are only ever
/// assigned constants.
fn only_ever(program: &Program, mode: usize) -> String {
    let mut asked = BTreeSet::new();
    let when = program.modes[mode].when.iter();
    when.for_each(|when| when.walk(&mut |part| asked.extend(part.as_variable())));
    let mut words = String::new();
    for index in asked {
        let Some(values) = given_to(program, index) else {
            continue;
        };
        let word = |value: &f64| program.value_text(index, &Expression::Constant(*value));
        let values: Vec<String> = values.iter().map(word).collect();
        let name = &program.variables[usize::from(index)].name;
        words.push_str(&format!("; {name} is only ever {}", values.join(" or ")));
    }
    words
}

/// The siblings with priority over this one.
fn before(program: &Program, mode: usize) -> impl Iterator<Item = usize> {
    (0..mode).filter(move |other| program.modes[*other].parent == program.modes[mode].parent)
}

/// The conditions that must hold, and those that must not, for a mode to be active.
fn wanted<'a>(
    program: &Program,
    conditions: &'a [Option<Expression>],
    mode: usize,
) -> Vec<(&'a Expression, bool)> {
    let condition = |mode: usize| conditions[mode].as_ref();
    let mut wanted = vec![];
    let mut at = Some(mode);
    while let Some(mode) = at {
        wanted.extend(condition(mode).map(|when| (when, true)));
        wanted.extend(
            before(program, mode)
                .filter_map(condition)
                .map(|when| (when, false)),
        );
        at = program.modes[mode].parent;
    }
    wanted
}

/// Implications between facts.
fn laws() -> [Expression; 3] {
    let fact = Expression::Fact;
    let join = |join, a, b| Expression::Join(join, Box::new((a, b)));
    let implies = |a, b| join(Join::Or, Expression::Not(Box::new(a)), b);
    let some_in_zone = join(
        Join::More,
        fact(Fact::EnemiesInZone),
        Expression::Constant(0.0),
    );
    [
        join(Join::Equal, fact(Fact::EnemyInZone), some_in_zone),
        implies(fact(Fact::HasFlag), fact(Fact::EnemyFlagTaken)),
        implies(fact(Fact::MateHasFlag), fact(Fact::EnemyFlagTaken)),
    ]
}

/// The terms of a program's conditions.
struct Terms<'a> {
    program: &'a Program,
    /// Index of each term by its printed form.
    index: BTreeMap<String, usize>,
    /// For each term, one value per distinguishable case.
    values: Vec<Vec<f64>>,
}

impl Terms<'_> {
    /// A condition with terms replaced by variables, numbered by the terms' indices; adds new
    /// terms.
    fn formula(&mut self, condition: &Expression) -> Expression {
        if let Some(value) = condition.constant() {
            return Expression::Constant(value);
        }
        match condition {
            Expression::Not(inner) => Expression::Not(Box::new(self.formula(inner))),
            Expression::Join(join, sides) if self.joins_truths(*join, sides) => Expression::Join(
                *join,
                Box::new((self.formula(&sides.0), self.formula(&sides.1))),
            ),
            Expression::Join(join, sides) => {
                match (
                    self.compared(&sides.0, &sides.1),
                    self.compared(&sides.1, &sides.0),
                ) {
                    (Some(left), Some(right)) => Expression::Join(*join, Box::new((left, right))),
                    _ => self.term(condition),
                }
            }
            Expression::Choose(parts) => {
                let (condition, then, otherwise) = &**parts;
                Expression::Choose(Box::new((
                    self.formula(condition),
                    self.formula(then),
                    self.formula(otherwise),
                )))
            }
            _ => self.term(condition),
        }
    }

    /// Whether the operator joins two Booleans; a constant alone does not determine its kind.
    fn joins_truths(&self, join: Join, sides: &(Expression, Expression)) -> bool {
        let is_truth = |side| self.program.kind_of(side) == Kind::Truth;
        matches!(join, Join::And | Join::Or) || is_truth(&sides.0) || is_truth(&sides.1)
    }

    fn term(&mut self, term: &Expression) -> Expression {
        let entry = self.index.entry(format!("{term:?}"));
        let index = *entry.or_insert(self.values.len());
        if index == self.values.len() {
            self.values.push(self.values_of(term).0);
        }
        Expression::Variable(index as u16)
    }

    /// One side of a comparison between a term and a constant; `None` for other comparisons.
    fn compared(&mut self, side: &Expression, other: &Expression) -> Option<Expression> {
        if let Some(constant) = side.constant() {
            return Some(Expression::Constant(constant));
        }
        let constant = other.constant().filter(|_| side.asks())?;
        let variable = self.term(side);
        if let (values, Some(is_whole)) = self.values_of(side) {
            let above = constant.next_up().max(if is_whole {
                constant.floor() + 1.0
            } else {
                f64::NEG_INFINITY
            });
            let is_possible =
                |value: &f64| *value >= values[0] && (!is_whole || value.fract() == 0.0);
            let index = usize::from(variable.as_variable()?);
            self.values[index].extend([constant, above].into_iter().filter(is_possible));
        }
        Some(variable)
    }

    /// All values of a term; or, for a number, its lower bound and whether it is an integer.
    fn values_of(&self, term: &Expression) -> (Vec<f64>, Option<bool>) {
        let number = |least, is_whole| (vec![least], Some(is_whole));
        match term {
            Expression::Fact(fact) if !fact.is_truth() => number(0.0, fact.is_whole()),
            Expression::Measure(Measure::Closing, _) | Expression::Between(Measure::Closing, _) => {
                number(f64::NEG_INFINITY, false)
            }
            Expression::Measure(measure, _) | Expression::Between(measure, _)
                if !measure.is_truth() =>
            {
                number(0.0, measure.is_whole())
            }
            Expression::Mates(_) => number(0.0, true),
            Expression::Variable(index) => {
                match (
                    given_to(self.program, *index),
                    &self.program.variables[usize::from(*index)].kind,
                ) {
                    (Some(values), _) => (values, None),
                    (None, Kind::Number) => number(f64::NEG_INFINITY, false),
                    (None, Kind::Truth) => (vec![0.0, 1.0], None),
                    (None, Kind::Text(texts)) => {
                        ((0..texts.len()).map(|text| text as f64).collect(), None)
                    }
                }
            }
            _ => (vec![0.0, 1.0], None),
        }
    }
}

/// All values of a variable, if only constants are assigned to it.
fn given_to(program: &Program, variable: u16) -> Option<Vec<f64>> {
    let sets = |task: &Task| matches!(task, Task::Policy(policy) if policy.sets == Some(variable));
    if program.behaviours.iter().any(|one| sets(&one.task)) {
        return None;
    }
    let entered = program.modes.iter().flat_map(|mode| &mode.enter);
    let ruled = program.rules.iter().flat_map(|rule| &rule.set);
    let set = entered
        .chain(ruled)
        .map(|(variable, value)| (*variable, value));
    let posts = program.behaviours.iter().flat_map(|one| &one.posts);
    let set = set.chain(posts.map(|post| (post.variable, &post.value)));
    let mut values = vec![program.variables[usize::from(variable)].initial];
    for (_, value) in set.filter(|(index, _)| *index == variable) {
        values.push(value.constant()?);
    }
    values.sort_by(f64::total_cmp);
    values.dedup();
    Some(values)
}

/// A search through the distinguishable cases.
struct Search<'a> {
    laws: &'a [Expression],
    /// The possible values of each term.
    values: Vec<Vec<f64>>,
    /// The value being tried for each term.
    tried: Vec<Option<f64>>,
    cases: usize,
    steps: usize,
}

impl Search<'_> {
    /// Whether all of `wanted` can hold in some case; also `true` if there are too many cases.
    fn is_possible(&mut self, wanted: &[(&Expression, bool)]) -> bool {
        let laws = self.laws.iter().map(|law| (law, true));
        self.cases = 0;
        self.tried.fill(None);
        self.is_possible_from(&wanted.iter().copied().chain(laws).collect::<Vec<_>>())
    }

    fn is_possible_from(&mut self, wanted: &[(&Expression, bool)]) -> bool {
        self.cases += 1;
        if self.cases > MOST_CASES || self.steps > MOST_STEPS {
            return true;
        }
        let mut open = None;
        for (formula, must) in wanted {
            match self.value(formula) {
                Ok(value) if (value != 0.0) != *must => return false,
                Ok(_) => {}
                Err(term) => open = open.or(Some(term)),
            }
        }
        let Some(term) = open else { return true };
        for i in 0..self.values[term].len() {
            self.tried[term] = Some(self.values[term][i]);
            if self.is_possible_from(wanted) {
                return true;
            }
        }
        self.tried[term] = None;
        false
    }

    /// The value of a formula if the tried values determine it, otherwise a term to try. Counts the
    /// steps.
    fn value(&mut self, formula: &Expression) -> Result<f64, usize> {
        self.steps += 1;
        match formula {
            Expression::Constant(value) => Ok(*value),
            Expression::Variable(term) => self.tried[usize::from(*term)].ok_or(usize::from(*term)),
            Expression::Not(inner) => self
                .value(inner)
                .map(|value| f64::from(u8::from(value == 0.0))),
            Expression::Join(join, sides) => {
                let a = self.value(&sides.0);
                let b = self.value(&sides.1);
                match join {
                    // One side may be enough to determine the value.
                    Join::And if [a, b].contains(&Ok(0.0)) => Ok(0.0),
                    Join::Or if [a, b].contains(&Ok(1.0)) => Ok(1.0),
                    _ => Ok(join.of(a?, b?)),
                }
            }
            Expression::Choose(parts) => match self.value(&parts.0) {
                Ok(holds) => self.value(if holds == 0.0 { &parts.2 } else { &parts.1 }),
                Err(open) => {
                    let then = self.value(&parts.1);
                    let otherwise = self.value(&parts.2);
                    then.ok().filter(|_| then == otherwise).ok_or(open)
                }
            },
            _ => unreachable!("terms have been replaced by variables"),
        }
    }
}
