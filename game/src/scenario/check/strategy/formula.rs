//! Conditions as formulas over terms that each have a few values: all that the conditions can tell apart.
//!
//! A term is a fact, a variable, a measure or a count of mates. A number that is compared with constants has one value
//! for each of them and for each gap between them. What cannot be had so, such as a comparison of two numbers, is a
//! term of its own that may hold or not: more cases than there are, never fewer.

use crate::strategy::{Expression, Fact, Join, Kind, Measure, Program};
use std::collections::BTreeMap;

/// A condition in terms.
#[derive(Debug)]
pub(super) enum Formula {
    Known(bool),
    /// A term as such.
    Term(usize),
    /// A term beside a constant.
    Compared(usize, Join, f64),
    Not(Box<Formula>),
    And(Box<(Formula, Formula)>),
    Or(Box<(Formula, Formula)>),
    Same(Box<(Formula, Formula)>),
    Choose(Box<(Formula, Formula, Formula)>),
}

/// The conditions of a program's modes.
#[derive(Debug)]
pub(super) struct Formulas {
    /// The condition of each mode.
    pub(super) of_modes: Vec<Option<Formula>>,
    /// What holds always.
    pub(super) laws: Vec<Formula>,
    /// The values that each term may have.
    pub(super) values: Vec<Vec<f64>>,
}

impl Formulas {
    /// Those of `program`.
    pub(super) fn of(program: &Program) -> Formulas {
        let mut terms = Terms { program, index: BTreeMap::new(), bounds: vec![] };
        let of_modes = program.modes.iter().map(|mode| mode.when.as_ref().map(|when| terms.formula(when))).collect();
        let known: Vec<Expression> = laws().into_iter().filter(|law| terms.knows_all(law)).collect();
        let laws = known.iter().map(|law| terms.formula(law)).collect();
        Formulas { of_modes, laws, values: terms.bounds.iter().map(Bounds::values).collect() }
    }
}

/// Facts that say something about each other.
fn laws() -> [Expression; 3] {
    let fact = Expression::Fact;
    let join = |join, a, b| Expression::Join(join, Box::new((a, b)));
    let implies = |a, b| join(Join::Or, Expression::Not(Box::new(a)), b);
    let some_in_zone = join(Join::More, fact(Fact::EnemiesInZone), Expression::Constant(0.0));
    [
        join(Join::Equal, fact(Fact::EnemyInZone), some_in_zone),
        implies(fact(Fact::HasFlag), fact(Fact::EnemyFlagTaken)),
        implies(fact(Fact::MateHasFlag), fact(Fact::EnemyFlagTaken)),
    ]
}

/// What a term may be.
#[derive(Debug)]
enum Bounds {
    /// One of these.
    These(Vec<f64>),
    /// A number, told apart by comparing it with constants.
    Number { constants: Vec<f64>, least: f64, is_whole: bool },
}

impl Bounds {
    /// One value for everything that can be told apart.
    fn values(&self) -> Vec<f64> {
        let (constants, least, is_whole) = match self {
            Bounds::These(values) => return values.clone(),
            Bounds::Number { constants, least, is_whole } => (constants, *least, *is_whole),
        };
        let mut sorted = constants.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let first = sorted.first().copied().unwrap_or(0.0);
        let last = sorted.last().copied().unwrap_or(0.0);
        let mut values = vec![if least.is_finite() { least } else { (first.floor() - 1.0).min(first.next_down()) }];
        for pair in sorted.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            values.push(low);
            values.push(if is_whole { low.floor() + 1.0 } else { 0.5 * low + 0.5 * high });
        }
        values.extend([last, (last.floor() + 1.0).max(last.next_up())]);
        values.retain(|value| *value >= least && (!is_whole || value.fract() == 0.0));
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }
}

/// The terms of a program's conditions.
struct Terms<'a> {
    program: &'a Program,
    /// By how they print.
    index: BTreeMap<String, usize>,
    bounds: Vec<Bounds>,
}

impl Terms<'_> {
    /// A condition as a formula; terms that are new are added.
    fn formula(&mut self, condition: &Expression) -> Formula {
        if let Some(value) = condition.constant() {
            return Formula::Known(value != 0.0);
        }
        match condition {
            Expression::Not(inner) => Formula::Not(Box::new(self.formula(inner))),
            Expression::Join(Join::And, sides) => Formula::And(self.both(sides)),
            Expression::Join(Join::Or, sides) => Formula::Or(self.both(sides)),
            Expression::Join(Join::Equal, sides) if self.are_truths(sides) => Formula::Same(self.both(sides)),
            Expression::Join(Join::Unequal, sides) if self.are_truths(sides) => {
                Formula::Not(Box::new(Formula::Same(self.both(sides))))
            }
            Expression::Choose(parts) => {
                let (condition, then, otherwise) = &**parts;
                Formula::Choose(Box::new((self.formula(condition), self.formula(then), self.formula(otherwise))))
            }
            Expression::Join(join, sides) => match (sides.0.constant(), sides.1.constant()) {
                (None, Some(value)) if is_term(&sides.0) => self.compared(&sides.0, *join, value),
                (Some(value), None) if is_term(&sides.1) => self.compared(&sides.1, join.swapped(), value),
                _ => Formula::Term(self.term(condition)),
            },
            _ => Formula::Term(self.term(condition)),
        }
    }

    fn both(&mut self, sides: &(Expression, Expression)) -> Box<(Formula, Formula)> {
        Box::new((self.formula(&sides.0), self.formula(&sides.1)))
    }

    fn compared(&mut self, term: &Expression, join: Join, value: f64) -> Formula {
        let term = self.term(term);
        if let Bounds::Number { constants, .. } = &mut self.bounds[term] {
            constants.push(value);
        }
        Formula::Compared(term, join, value)
    }

    /// Whether two things that are compared are truths; of a constant alone nobody can say.
    fn are_truths(&self, sides: &(Expression, Expression)) -> bool {
        [&sides.0, &sides.1].into_iter().any(|side| self.program.kind_of(side) == Kind::Truth)
    }

    fn term(&mut self, term: &Expression) -> usize {
        let bounds = self.bounds_of(term);
        *self.index.entry(format!("{term:?}")).or_insert_with(|| {
            self.bounds.push(bounds);
            self.bounds.len() - 1
        })
    }

    fn bounds_of(&self, term: &Expression) -> Bounds {
        let number = |least, is_whole| Bounds::Number { constants: vec![], least, is_whole };
        match term {
            Expression::Fact(fact) if !fact.is_truth() => number(0.0, fact.is_whole()),
            Expression::Measure(Measure::Closing, _) => number(f64::NEG_INFINITY, false),
            Expression::Measure(measure, _) if !measure.is_truth() => number(0.0, false),
            Expression::Mates(_) => number(0.0, true),
            Expression::Variable(index) => {
                match (given_to(self.program, *index), &self.program.variables[usize::from(*index)].kind) {
                    (Some(values), _) => Bounds::These(values),
                    (None, Kind::Number) => number(f64::NEG_INFINITY, false),
                    (None, Kind::Truth) => Bounds::These(vec![0.0, 1.0]),
                    (None, Kind::Text(texts)) => Bounds::These((0..texts.len()).map(|text| text as f64).collect()),
                }
            }
            _ => Bounds::These(vec![0.0, 1.0]),
        }
    }

    /// Whether all facts of a law occur in the conditions.
    fn knows_all(&self, law: &Expression) -> bool {
        let mut knows = true;
        law.walk(&mut |part| {
            knows &= !matches!(part, Expression::Fact(_)) || self.index.contains_key(&format!("{part:?}"));
        });
        knows
    }
}

/// The values that a variable ever has, if only constants are given to it.
pub(super) fn given_to(program: &Program, variable: u16) -> Option<Vec<f64>> {
    let entered = program.modes.iter().flat_map(|mode| &mode.enter);
    let ruled = program.rules.iter().flat_map(|rule| &rule.set);
    let set = entered.chain(ruled).map(|(variable, value)| (*variable, value));
    let posts = program.behaviours.iter().flat_map(|behaviour| &behaviour.posts);
    let set = set.chain(posts.map(|post| (post.variable, &post.value)));
    let mut values = vec![program.variables[usize::from(variable)].initial];
    for (_, value) in set.filter(|(index, _)| *index == variable) {
        values.push(value.constant()?);
    }
    values.sort_by(f64::total_cmp);
    values.dedup();
    Some(values)
}

fn is_term(expression: &Expression) -> bool {
    matches!(expression, Expression::Fact(_) | Expression::Variable(_) | Expression::Measure(..) | Expression::Mates(_))
}

impl Formula {
    /// Whether it holds, if the values of the terms that have one decide that. Counts its steps.
    pub(super) fn holds(&self, values: &[Option<f64>], steps: &mut usize) -> Option<bool> {
        *steps += 1;
        match self {
            Formula::Known(holds) => Some(*holds),
            Formula::Term(term) => values[*term].map(|value| value != 0.0),
            Formula::Compared(term, join, constant) => values[*term].map(|value| join.of(value, *constant) != 0.0),
            Formula::Not(inner) => inner.holds(values, steps).map(|holds| !holds),
            Formula::And(sides) | Formula::Or(sides) => {
                // One side may decide alone.
                let decisive = matches!(self, Formula::Or(_));
                match (sides.0.holds(values, steps), sides.1.holds(values, steps)) {
                    (Some(a), Some(b)) if a == b => Some(a),
                    (a, b) => [a, b].contains(&Some(decisive)).then_some(decisive),
                }
            }
            Formula::Same(sides) => {
                let (a, b) = (sides.0.holds(values, steps), sides.1.holds(values, steps));
                a.zip(b).map(|(a, b)| a == b)
            }
            Formula::Choose(parts) => {
                let (then, otherwise) = (parts.1.holds(values, steps), parts.2.holds(values, steps));
                match parts.0.holds(values, steps) {
                    Some(true) => then,
                    Some(false) => otherwise,
                    None => then.filter(|_| then == otherwise),
                }
            }
        }
    }

    /// A term of it that has no value yet and decides something.
    pub(super) fn open_term(&self, values: &[Option<f64>]) -> Option<usize> {
        let first = |parts: &[&Formula]| parts.iter().find_map(|part| part.open_term(values));
        match self {
            Formula::Known(_) => None,
            Formula::Term(term) | Formula::Compared(term, ..) => values[*term].is_none().then_some(*term),
            Formula::Not(inner) => first(&[inner]),
            Formula::And(sides) | Formula::Or(sides) | Formula::Same(sides) => first(&[&sides.0, &sides.1]),
            Formula::Choose(parts) => first(&[&parts.0, &parts.1, &parts.2]),
        }
    }
}
