//! Prints expressions in CEL, as written in a file.

use super::{Expression, Join, Kind, Named, Place, Program};

/// Precedence of an expression's parts, lowest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Choice,
    Or,
    And,
    Relation,
    Sum,
    Product,
    Sign,
    Atom,
}

impl Program {
    /// The kind of an expression's value in this program.
    pub fn kind_of(&self, expression: &Expression) -> Kind {
        match expression {
            Expression::Constant(_) | Expression::Mates(_) | Expression::Minus(_) => Kind::Number,
            Expression::Variable(index) => self.variables[usize::from(*index)].kind.clone(),
            Expression::Fact(fact) => Kind::of(fact.is_truth()),
            Expression::Measure(measure, _) | Expression::Between(measure, _) => {
                Kind::of(measure.is_truth())
            }
            Expression::Not(_) => Kind::Truth,
            Expression::Join(join, _) => Kind::of(join.is_truth()),
            Expression::Choose(parts) => match self.kind_of(&parts.1) {
                Kind::Number => self.kind_of(&parts.2),
                kind => kind,
            },
        }
    }

    /// A condition of this program, as written.
    pub fn condition_text(&self, expression: &Expression) -> String {
        self.text(expression, &Kind::Truth, Precedence::Choice)
    }

    /// A number of this program, as written.
    pub fn number_text(&self, expression: &Expression) -> String {
        self.text(expression, &Kind::Number, Precedence::Choice)
    }

    /// A value for a variable of this program, as written.
    pub fn value_text(&self, variable: u16, expression: &Expression) -> String {
        let kind = &self.variables[usize::from(variable)].kind;
        self.text(expression, kind, Precedence::Choice)
    }

    /// An expression in the place of a value of `kind`; parts with lower precedence than `around`
    /// need brackets.
    fn text(&self, expression: &Expression, kind: &Kind, around: Precedence) -> String {
        let atom = |text: String| (text, Precedence::Atom);
        let (text, binds) = match expression {
            Expression::Constant(value) => match kind {
                Kind::Text(_) => atom(format!("'{}'", kind.text_of(*value))),
                Kind::Number if *value < 0.0 => (kind.text_of(*value), Precedence::Sign),
                _ => atom(kind.text_of(*value)),
            },
            Expression::Variable(index) => atom(self.variables[usize::from(*index)].name.clone()),
            Expression::Fact(fact) => atom(fact.name().to_owned()),
            Expression::Measure(measure, place) => {
                atom(format!("{}({})", measure.name(), place.text()))
            }
            Expression::Between(measure, places) => {
                let [from, to] = [&places.0, &places.1].map(Place::text);
                atom(format!("{}({from}, {to})", measure.name()))
            }
            Expression::Mates(condition) => {
                atom(format!("mates({})", self.condition_text(condition)))
            }
            Expression::Not(inner) => {
                let inner = self.text(inner, &Kind::Truth, Precedence::Sign);
                (format!("!{inner}"), Precedence::Sign)
            }
            // Two signs in a row cancel out, and a sign before a digit belongs to the number.
            Expression::Minus(inner) => {
                (format!("-({})", self.number_text(inner)), Precedence::Sign)
            }
            Expression::Join(join, sides) => self.joined(*join, &sides.0, &sides.1),
            Expression::Choose(parts) => {
                let condition = self.text(&parts.0, &Kind::Truth, Precedence::Or);
                let then = self.text(&parts.1, kind, Precedence::Or);
                let otherwise = self.text(&parts.2, kind, Precedence::Choice);
                let text = format!("{condition} ? {then} : {otherwise}");
                (text, Precedence::Choice)
            }
        };
        if binds < around {
            format!("({text})")
        } else {
            text
        }
    }

    fn joined(&self, join: Join, left: &Expression, right: &Expression) -> (String, Precedence) {
        let sign = join.name();
        let binds = match join {
            Join::Least | Join::Greatest => {
                let [left, right] = [left, right].map(|side| self.number_text(side));
                return (format!("{sign}({left}, {right})"), Precedence::Atom);
            }
            Join::Or => Precedence::Or,
            Join::And => Precedence::And,
            Join::Plus | Join::Minus => Precedence::Sum,
            Join::Times | Join::Over => Precedence::Product,
            _ => Precedence::Relation,
        };
        let kind = match join {
            Join::And | Join::Or => Kind::Truth,
            // One of the two sides may be a constant, which alone does not determine its kind.
            Join::Equal | Join::Unequal => match (self.kind_of(left), self.kind_of(right)) {
                (Kind::Number, kind) | (kind, _) => kind,
            },
            _ => Kind::Number,
        };
        // `&&` and `||` are associative; all other operators group from the left.
        let (at_left, at_right) = match join {
            Join::And | Join::Or => (binds, binds),
            _ if binds == Precedence::Relation => (Precedence::Sum, Precedence::Sum),
            Join::Plus | Join::Minus => (binds, Precedence::Product),
            _ => (binds, Precedence::Sign),
        };
        let left = self.text(left, &kind, at_left);
        let right = self.text(right, &kind, at_right);
        (format!("{left} {sign} {right}"), binds)
    }
}

impl Place {
    /// The place as written.
    fn text(&self) -> String {
        match self {
            Place::At(at) => format!("[{}, {}]", at.east, at.north),
            Place::Point(name) => name.clone(),
            Place::Mark(mark) => mark.name().to_owned(),
            Place::Boat(boat) => boat.name().to_owned(),
        }
    }
}
