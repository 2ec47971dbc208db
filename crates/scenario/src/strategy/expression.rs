//! Expressions of strategy files: conditions, weights and numbers that depend on the game.
//!
//! Files contain them in CEL. The check converts them to this tree, in which names are indices and
//! types are correct. All values are `f64`: false and true are 0 and 1, and a string is its index
//! among the values of its variable.

use super::{Fact, Measure, Place};
use serde::{Deserialize, Serialize};
use strum::{EnumMessage, IntoStaticStr, VariantArray};

/// A correctly typed expression.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Expression {
    /// A number, Boolean or string.
    Constant(f64),
    /// A variable of the strategy, by its index in [`super::Program::variables`].
    Variable(u16),
    /// A fact about the game.
    Fact(Fact),
    /// A measure of a place or a boat.
    Measure(Measure, Place),
    /// A measure between two places.
    Between(Measure, Box<(Place, Place)>),
    /// The number of teammates for which the condition holds, given each teammate's own values of
    /// shared variables.
    Mates(Box<Expression>),
    /// Logical negation.
    Not(Box<Expression>),
    /// Arithmetic negation.
    Minus(Box<Expression>),
    /// Two values joined by an operator.
    Join(Join, Box<(Expression, Expression)>),
    /// The second expression if the first is true, otherwise the third.
    Choose(Box<(Expression, Expression, Expression)>),
}

/// The operator that joins two values.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    Serialize,
    Deserialize,
    VariantArray,
    IntoStaticStr,
    EnumMessage,
)]
pub enum Join {
    /// Both are true; the second is evaluated only if the first is true.
    #[strum(serialize = "&&")]
    And,
    /// At least one is true; the second is evaluated only if the first is false.
    #[strum(serialize = "||")]
    Or,
    /// Equality.
    #[strum(serialize = "==")]
    Equal,
    /// Inequality.
    #[strum(serialize = "!=")]
    Unequal,
    /// The first is less.
    #[strum(serialize = "<")]
    Less,
    /// The first is at most the second.
    #[strum(serialize = "<=")]
    AtMost,
    /// The first is greater.
    #[strum(serialize = ">")]
    More,
    /// The first is at least the second.
    #[strum(serialize = ">=")]
    AtLeast,
    /// Sum.
    #[strum(serialize = "+")]
    Plus,
    /// Difference.
    #[strum(serialize = "-")]
    Minus,
    /// Product.
    #[strum(serialize = "*")]
    Times,
    /// Quotient; division by 0 yields 0.
    #[strum(serialize = "/")]
    Over,
    /// Minimum.
    #[strum(serialize = "min")]
    Least,
    /// Maximum.
    #[strum(serialize = "max")]
    Greatest,
}

/// The values for evaluating expressions. All default to 0.
pub trait Values {
    /// The value of a fact.
    fn fact(&self, _fact: Fact) -> f64 {
        0.0
    }
    /// The value of a variable.
    fn variable(&self, _index: u16) -> f64 {
        0.0
    }
    /// A measure of a place.
    fn measure(&self, _measure: Measure, _place: &Place) -> f64 {
        0.0
    }
    /// A measure from one place to another.
    fn between(&self, _measure: Measure, _from: &Place, _to: &Place) -> f64 {
        0.0
    }
    /// The number of teammates for which `condition` holds.
    fn mates(&self, _condition: &Expression) -> f64 {
        0.0
    }
}

/// For evaluating constants.
impl Values for () {}

impl Expression {
    /// The constant true or false.
    pub fn truth(is: bool) -> Expression {
        Expression::Constant(truth(is))
    }

    /// The value; NaN becomes 0.
    pub fn value(&self, values: &impl Values) -> f64 {
        let value = match self {
            Expression::Constant(value) => *value,
            Expression::Variable(index) => values.variable(*index),
            Expression::Fact(fact) => values.fact(*fact),
            Expression::Measure(measure, place) => values.measure(*measure, place),
            Expression::Between(measure, places) => values.between(*measure, &places.0, &places.1),
            Expression::Mates(condition) => values.mates(condition),
            Expression::Not(inner) => truth(!inner.is_true(values)),
            Expression::Minus(inner) => -inner.value(values),
            Expression::Join(join, sides) => match (join, sides.0.value(values)) {
                // One side may be enough to determine the value.
                (Join::And, 0.0) => 0.0,
                (Join::Or, left) if left != 0.0 => 1.0,
                (_, left) => join.of(left, sides.1.value(values)),
            },
            Expression::Choose(parts) => {
                let (condition, then, otherwise) = &**parts;
                if condition.is_true(values) {
                    then.value(values)
                } else {
                    otherwise.value(values)
                }
            }
        };
        if value.is_nan() { 0.0 } else { value }
    }

    /// Whether it is true.
    pub fn is_true(&self, values: &impl Values) -> bool {
        self.value(values) != 0.0
    }

    /// Its value if it depends neither on the game nor on variables.
    pub fn constant(&self) -> Option<f64> {
        let mut asks = false;
        self.walk(&mut |part| asks |= part.asks());
        (!asks).then(|| self.value(&()))
    }

    /// Whether it refers directly to the game or to a variable.
    pub fn asks(&self) -> bool {
        use Expression::{Between, Fact, Mates, Measure, Variable};
        matches!(
            self,
            Variable(_) | Fact(_) | Measure(..) | Between(..) | Mates(_)
        )
    }

    /// The variable, if the expression is one.
    pub fn as_variable(&self) -> Option<u16> {
        if let Expression::Variable(index) = self {
            Some(*index)
        } else {
            None
        }
    }

    /// Calls `visit` with this expression and all its parts.
    pub fn walk<'a>(&'a self, visit: &mut impl FnMut(&'a Expression)) {
        visit(self);
        match self {
            Expression::Mates(inner) | Expression::Not(inner) | Expression::Minus(inner) => {
                inner.walk(visit)
            }
            Expression::Join(_, sides) => [&sides.0, &sides.1]
                .into_iter()
                .for_each(|side| side.walk(visit)),
            Expression::Choose(parts) => [&parts.0, &parts.1, &parts.2]
                .into_iter()
                .for_each(|part| part.walk(visit)),
            Expression::Constant(_) | Expression::Variable(_) | Expression::Fact(_) => {}
            Expression::Measure(..) | Expression::Between(..) => {}
        }
    }
}

impl Join {
    /// Whether the result is a Boolean.
    pub fn is_truth(self) -> bool {
        !matches!(
            self,
            Join::Plus | Join::Minus | Join::Times | Join::Over | Join::Least | Join::Greatest
        )
    }

    /// The result for two values.
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Join::And => truth(a != 0.0 && b != 0.0),
            Join::Or => truth(a != 0.0 || b != 0.0),
            Join::Equal => truth(a == b),
            Join::Unequal => truth(a != b),
            Join::Less => truth(a < b),
            Join::AtMost => truth(a <= b),
            Join::More => truth(a > b),
            Join::AtLeast => truth(a >= b),
            Join::Plus => a + b,
            Join::Minus => a - b,
            Join::Times => a * b,
            Join::Over if b == 0.0 => 0.0,
            Join::Over => a / b,
            Join::Least => a.min(b),
            Join::Greatest => a.max(b),
        }
    }
}

fn truth(is: bool) -> f64 {
    f64::from(u8::from(is))
}
