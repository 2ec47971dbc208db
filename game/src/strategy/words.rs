//! Expressions in words: as they would be typed into a file.

use super::{Expression, Join, Kind, Place, Program};

/// How tightly a part of an expression holds together, loosest first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Hold {
    Choice,
    Or,
    And,
    Relation,
    Sum,
    Product,
    Sign,
    Word,
}

impl Program {
    /// What kind of value an expression of this program has.
    #[must_use]
    pub fn kind_of(&self, expression: &Expression) -> Kind {
        let truth = |is_truth: bool| if is_truth { Kind::Truth } else { Kind::Number };
        match expression {
            Expression::Constant(_) | Expression::Mates(_) | Expression::Minus(_) => Kind::Number,
            Expression::Variable(index) => self.variables[usize::from(*index)].kind.clone(),
            Expression::Fact(fact) => truth(fact.is_truth()),
            Expression::Measure(measure, _) => truth(measure.is_truth()),
            Expression::Not(_) => Kind::Truth,
            Expression::Join(join, _) => truth(join.is_truth()),
            Expression::Choose(parts) => match self.kind_of(&parts.1) {
                Kind::Number => self.kind_of(&parts.2),
                kind => kind,
            },
        }
    }

    /// A condition of this program, as it would be typed.
    #[must_use]
    pub fn condition_in_words(&self, expression: &Expression) -> String {
        self.words(expression, &Kind::Truth, Hold::Choice)
    }

    /// A number of this program, as it would be typed.
    #[must_use]
    pub fn number_in_words(&self, expression: &Expression) -> String {
        self.words(expression, &Kind::Number, Hold::Choice)
    }

    /// A value for a variable of this program, as it would be typed.
    #[must_use]
    pub fn value_in_words(&self, variable: u16, expression: &Expression) -> String {
        self.words(expression, &self.variables[usize::from(variable)].kind, Hold::Choice)
    }

    /// An expression where a value of `kind` stands and everything looser than `around` needs brackets.
    fn words(&self, expression: &Expression, kind: &Kind, around: Hold) -> String {
        let (words, hold) = match expression {
            Expression::Constant(value) => constant(*value, kind),
            Expression::Variable(index) => (self.variables[usize::from(*index)].name.clone(), Hold::Word),
            Expression::Fact(fact) => (fact.name().to_owned(), Hold::Word),
            Expression::Measure(measure, place) => (format!("{}({})", measure.name(), place.words()), Hold::Word),
            Expression::Mates(condition) => (format!("mates({})", self.condition_in_words(condition)), Hold::Word),
            Expression::Not(inner) => (format!("!{}", self.words(inner, &Kind::Truth, Hold::Sign)), Hold::Sign),
            // Two signs in a row cancel each other, and a sign before a digit belongs to it.
            Expression::Minus(inner) => (format!("-({})", self.number_in_words(inner)), Hold::Sign),
            Expression::Join(join, sides) => self.joined(*join, &sides.0, &sides.1),
            Expression::Choose(parts) => {
                let condition = self.words(&parts.0, &Kind::Truth, Hold::Or);
                let then = self.words(&parts.1, kind, Hold::Or);
                let otherwise = self.words(&parts.2, kind, Hold::Choice);
                (format!("{condition} ? {then} : {otherwise}"), Hold::Choice)
            }
        };
        if hold < around { format!("({words})") } else { words }
    }

    fn joined(&self, join: Join, left: &Expression, right: &Expression) -> (String, Hold) {
        let (sign, hold) = match join {
            Join::Or => ("||", Hold::Or),
            Join::And => ("&&", Hold::And),
            Join::Equal => ("==", Hold::Relation),
            Join::Unequal => ("!=", Hold::Relation),
            Join::Less => ("<", Hold::Relation),
            Join::AtMost => ("<=", Hold::Relation),
            Join::More => (">", Hold::Relation),
            Join::AtLeast => (">=", Hold::Relation),
            Join::Plus => ("+", Hold::Sum),
            Join::Minus => ("-", Hold::Sum),
            Join::Times => ("*", Hold::Product),
            Join::Over => ("/", Hold::Product),
            Join::Least | Join::Greatest => {
                let name = if join == Join::Least { "min" } else { "max" };
                let words = format!("{name}({}, {})", self.number_in_words(left), self.number_in_words(right));
                return (words, Hold::Word);
            }
        };
        let kind = match join {
            Join::And | Join::Or => Kind::Truth,
            // Of two sides one may be a constant, which alone does not say what it is.
            Join::Equal | Join::Unequal => match (self.kind_of(left), self.kind_of(right)) {
                (Kind::Number, kind) | (kind, _) => kind,
            },
            _ => Kind::Number,
        };
        // Chains of these are the same with and without brackets; of others the left side comes first.
        let (at_left, at_right) = match join {
            Join::And | Join::Or => (hold, hold),
            _ if hold == Hold::Relation => (Hold::Sum, Hold::Sum),
            Join::Plus | Join::Minus => (hold, Hold::Product),
            _ => (hold, Hold::Sign),
        };
        (format!("{} {sign} {}", self.words(left, &kind, at_left), self.words(right, &kind, at_right)), hold)
    }
}

fn constant(value: f64, kind: &Kind) -> (String, Hold) {
    match kind {
        Kind::Truth => ((if value == 0.0 { "false" } else { "true" }).to_owned(), Hold::Word),
        Kind::Text(values) => {
            let text = values.get(value as usize).map_or("", String::as_str);
            (format!("'{text}'"), Hold::Word)
        }
        Kind::Number if value < 0.0 => (value.to_string(), Hold::Sign),
        Kind::Number => (value.to_string(), Hold::Word),
    }
}

impl Join {
    /// Whether what is joined is true or false.
    #[must_use]
    pub fn is_truth(self) -> bool {
        !matches!(self, Join::Plus | Join::Minus | Join::Times | Join::Over | Join::Least | Join::Greatest)
    }
}

impl Place {
    /// The place as it would be typed.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Place::At(at) => format!("[{}, {}]", at.east, at.north),
            Place::Point(name) => name.clone(),
            Place::Mark(mark) => mark.name().to_owned(),
            Place::Boat(boat) => boat.name().to_owned(),
        }
    }
}
