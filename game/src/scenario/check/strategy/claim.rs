//! Conditions as claims about terms that each have a few values: all that the conditions can tell apart.
//!
//! A term is a fact, a variable, a measure or a count of mates. A number that is compared with constants has one value
//! for each of them and for each gap between them. What cannot be had so, such as a comparison of two numbers, is a
//! term of its own that may hold or not: more cases than there are, never fewer.

use crate::strategy::{Expression, Fact, Join, Kind, Program};
use std::collections::BTreeMap;

/// A condition in terms.
#[derive(Debug)]
pub(super) enum Claim {
    Known(bool),
    /// A term as such.
    Term(usize),
    /// A term beside a constant, and whether the constant comes first.
    Compared(usize, Join, f64, bool),
    Not(Box<Claim>),
    And(Box<(Claim, Claim)>),
    Or(Box<(Claim, Claim)>),
    Same(Box<(Claim, Claim)>),
    Choose(Box<(Claim, Claim, Claim)>),
}

/// The conditions of a program's modes.
#[derive(Debug)]
pub(super) struct Claims {
    of_modes: Vec<Option<Claim>>,
    laws: Vec<Claim>,
    values: Vec<Vec<f64>>,
}

impl Claims {
    /// Those of `program`.
    pub(super) fn of(program: &Program) -> Claims {
        let mut terms = Terms { program, index: BTreeMap::new(), bounds: vec![] };
        let conditions = || program.modes.iter().map(|mode| mode.when.as_ref());
        conditions().flatten().for_each(|when| terms.gather(when));
        let laws: Vec<Expression> = laws().into_iter().filter(|law| terms.knows_all(law)).collect();
        laws.iter().for_each(|law| terms.gather(law));
        let values: Vec<Vec<f64>> = terms.bounds.iter().map(Bounds::values).collect();
        let claim = |when: &Expression| terms.claim(when);
        Claims {
            of_modes: conditions().map(|when| when.map(claim)).collect(),
            laws: laws.iter().map(claim).collect(),
            values,
        }
    }

    /// The condition of a mode.
    pub(super) fn of_mode(&self, mode: usize) -> Option<&Claim> {
        self.of_modes[mode].as_ref()
    }

    /// What holds always.
    pub(super) fn laws(&self) -> impl Iterator<Item = &Claim> {
        self.laws.iter()
    }

    /// How many terms there are.
    pub(super) fn terms(&self) -> usize {
        self.values.len()
    }

    /// The values that a term may have.
    pub(super) fn values(&self, term: usize) -> &[f64] {
        &self.values[term]
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
        let Bounds::Number { constants, least, is_whole } = self else {
            let Bounds::These(values) = self else { unreachable!("there is no third") };
            return values.clone();
        };
        let mut sorted = constants.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.dedup();
        let first = sorted.first().copied().unwrap_or(0.0);
        let last = sorted.last().copied().unwrap_or(0.0);
        let mut values = vec![if least.is_finite() { *least } else { (first.floor() - 1.0).min(first.next_down()) }];
        for pair in sorted.windows(2) {
            let (low, high) = (pair[0], pair[1]);
            values.push(low);
            values.push(if *is_whole { low.floor() + 1.0 } else { 0.5 * low + 0.5 * high });
        }
        values.extend([last, (last.floor() + 1.0).max(last.next_up())]);
        values.retain(|value| value >= least && (!is_whole || value.fract() == 0.0));
        values.sort_by(f64::total_cmp);
        values.dedup();
        values
    }
}

/// The terms of a program's conditions.
struct Terms<'a> {
    program: &'a Program,
    /// By their words.
    index: BTreeMap<String, usize>,
    bounds: Vec<Bounds>,
}

/// How a condition is looked at.
enum Look<'a> {
    Known(bool),
    Not(&'a Expression),
    And(&'a (Expression, Expression)),
    Or(&'a (Expression, Expression)),
    Same(&'a (Expression, Expression)),
    Unlike(&'a (Expression, Expression)),
    Choose(&'a (Expression, Expression, Expression)),
    /// A term and a constant, and whether the constant comes first.
    Compared(Join, &'a Expression, f64, bool),
    /// Something that may hold or not.
    Free(&'a Expression),
}

impl Terms<'_> {
    fn look<'e>(&self, condition: &'e Expression) -> Look<'e> {
        if let Some(value) = condition.constant() {
            return Look::Known(value != 0.0);
        }
        match condition {
            Expression::Not(inner) => Look::Not(inner),
            Expression::Join(Join::And, sides) => Look::And(sides),
            Expression::Join(Join::Or, sides) => Look::Or(sides),
            Expression::Join(Join::Equal, sides) if self.are_truths(sides) => Look::Same(sides),
            Expression::Join(Join::Unequal, sides) if self.are_truths(sides) => Look::Unlike(sides),
            Expression::Choose(parts) => Look::Choose(parts),
            Expression::Join(join, sides) => match (sides.0.constant(), sides.1.constant()) {
                (None, Some(value)) if is_term(&sides.0) => Look::Compared(*join, &sides.0, value, false),
                (Some(value), None) if is_term(&sides.1) => Look::Compared(*join, &sides.1, value, true),
                _ => Look::Free(condition),
            },
            _ => Look::Free(condition),
        }
    }

    /// Whether two things that are compared are truths; of a constant alone nobody can say.
    fn are_truths(&self, sides: &(Expression, Expression)) -> bool {
        [&sides.0, &sides.1].into_iter().any(|side| self.program.kind_of(side) == Kind::Truth)
    }

    /// Adds the terms of a condition.
    fn gather(&mut self, condition: &Expression) {
        match self.look(condition) {
            Look::Known(_) => {}
            Look::Not(inner) => self.gather(inner),
            Look::And(sides) | Look::Or(sides) | Look::Same(sides) | Look::Unlike(sides) => {
                self.gather(&sides.0);
                self.gather(&sides.1);
            }
            Look::Choose(parts) => {
                self.gather(&parts.0);
                self.gather(&parts.1);
                self.gather(&parts.2);
            }
            Look::Compared(_, term, value, _) => {
                let term = self.add(term);
                if let Bounds::Number { constants, .. } = &mut self.bounds[term] {
                    constants.push(value);
                }
            }
            Look::Free(condition) => drop(self.add(condition)),
        }
    }

    fn add(&mut self, term: &Expression) -> usize {
        let words = format!("{term:?}");
        if let Some(index) = self.index.get(&words) {
            return *index;
        }
        self.bounds.push(self.bounds_of(term));
        self.index.insert(words, self.bounds.len() - 1);
        self.bounds.len() - 1
    }

    fn bounds_of(&self, term: &Expression) -> Bounds {
        let number = |least, is_whole| Bounds::Number { constants: vec![], least, is_whole };
        match term {
            Expression::Fact(fact) if !fact.is_truth() => number(fact.least(), fact.is_whole()),
            Expression::Measure(measure, _) if !measure.is_truth() => number(measure.least(), false),
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

    fn claim(&self, condition: &Expression) -> Claim {
        let two = |sides: &(Expression, Expression)| Box::new((self.claim(&sides.0), self.claim(&sides.1)));
        let index = |term: &Expression| self.index[&format!("{term:?}")];
        match self.look(condition) {
            Look::Known(holds) => Claim::Known(holds),
            Look::Not(inner) => Claim::Not(Box::new(self.claim(inner))),
            Look::And(sides) => Claim::And(two(sides)),
            Look::Or(sides) => Claim::Or(two(sides)),
            Look::Same(sides) => Claim::Same(two(sides)),
            Look::Unlike(sides) => Claim::Not(Box::new(Claim::Same(two(sides)))),
            Look::Choose(parts) => {
                Claim::Choose(Box::new((self.claim(&parts.0), self.claim(&parts.1), self.claim(&parts.2))))
            }
            Look::Compared(join, term, constant, is_first) => Claim::Compared(index(term), join, constant, is_first),
            Look::Free(condition) => Claim::Term(index(condition)),
        }
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

impl Claim {
    /// Whether it holds, if the terms that are held decide that. Counts its steps.
    pub(super) fn holds(&self, held: &[Option<f64>], steps: &mut usize) -> Option<bool> {
        *steps += 1;
        match self {
            Claim::Known(holds) => Some(*holds),
            Claim::Term(term) => held[*term].map(|value| value != 0.0),
            Claim::Compared(term, join, constant, is_first) => held[*term].map(|value| {
                let (a, b) = if *is_first { (*constant, value) } else { (value, *constant) };
                join.of(a, b) != 0.0
            }),
            Claim::Not(inner) => inner.holds(held, steps).map(|holds| !holds),
            Claim::And(sides) => match (sides.0.holds(held, steps), sides.1.holds(held, steps)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
            Claim::Or(sides) => match (sides.0.holds(held, steps), sides.1.holds(held, steps)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            },
            Claim::Same(sides) => {
                let (a, b) = (sides.0.holds(held, steps), sides.1.holds(held, steps));
                a.zip(b).map(|(a, b)| a == b)
            }
            Claim::Choose(parts) => {
                let (then, otherwise) = (parts.1.holds(held, steps), parts.2.holds(held, steps));
                match parts.0.holds(held, steps) {
                    Some(true) => then,
                    Some(false) => otherwise,
                    None => then.filter(|_| then == otherwise),
                }
            }
        }
    }

    /// A term of it that is not held and decides something.
    pub(super) fn open_term(&self, held: &[Option<f64>]) -> Option<usize> {
        match self {
            Claim::Known(_) => None,
            Claim::Term(term) | Claim::Compared(term, ..) => held[*term].is_none().then_some(*term),
            Claim::Not(inner) => inner.open_term(held),
            Claim::And(sides) | Claim::Or(sides) | Claim::Same(sides) => {
                sides.0.open_term(held).or_else(|| sides.1.open_term(held))
            }
            Claim::Choose(parts) => {
                let rest = || parts.1.open_term(held).or_else(|| parts.2.open_term(held));
                parts.0.open_term(held).or_else(rest)
            }
        }
    }
}
