//! Expressions, checked: names become what they stand for, and types must fit.

use super::cel::{self, DEEPEST, Parsed};
use crate::field::Field;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::At;
use crate::strategy::{Boat, Expression, Fact, Join, Kind, Mark, Measure, Place, Variable};
use ::cel::common::ast::{CallExpr, Expr, IdedExpr, LiteralValue, operators};

/// Words that CEL keeps for itself.
pub(super) const RESERVED: [&str; 21] = [
    "as",
    "break",
    "const",
    "continue",
    "else",
    "false",
    "for",
    "function",
    "if",
    "import",
    "in",
    "let",
    "loop",
    "package",
    "namespace",
    "null",
    "return",
    "true",
    "var",
    "void",
    "while",
];
/// What stands for a call and is no measure.
pub(super) const CALLS: [&str; 3] = ["min", "max", "mates"];

/// What an expression must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wanted {
    Truth,
    Number,
}

/// What a part is.
enum Type {
    Truth,
    Number,
    /// A variable that has one of these texts.
    Text(Vec<String>),
    /// A text as such.
    Quote(String),
}

impl Type {
    fn in_words(&self) -> String {
        match self {
            Type::Truth => "true or false".to_owned(),
            Type::Number => "a number".to_owned(),
            Type::Text(_) => "a text".to_owned(),
            Type::Quote(text) => format!("the text {text:?}"),
        }
    }
}

/// The expression given for `key`, which must be of type `wanted`; what is wrong with it is noted.
pub(super) fn expression(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    key: &str,
    given: &At<String>,
    wanted: Wanted,
) -> Option<Expression> {
    let parsed = cel::parse(diagnostics, key, given)?;
    let mut reader = Reader { diagnostics, variables, key, parsed: &parsed, among_mates: false };
    reader.of_type(&parsed.root, wanted, 0)
}

struct Reader<'a> {
    diagnostics: &'a mut Diagnostics,
    variables: &'a [Variable],
    key: &'a str,
    parsed: &'a Parsed,
    /// Within `mates(...)`, where only shared variables are known.
    among_mates: bool,
}

impl Reader<'_> {
    fn note(&mut self, part: &IdedExpr, message: &str) {
        let message = format!("{} {message}", self.key);
        self.diagnostics.note(self.parsed.place(part), message);
    }

    fn of_type(&mut self, part: &IdedExpr, wanted: Wanted, depth: usize) -> Option<Expression> {
        let (expression, found) = self.any(part, depth)?;
        match (wanted, &found) {
            (Wanted::Truth, Type::Truth) | (Wanted::Number, Type::Number) => Some(expression),
            _ => {
                let wanted = match wanted {
                    Wanted::Truth => "true or false, such as a comparison",
                    Wanted::Number => "a number",
                };
                self.note(part, &format!("has {} here, expected {wanted}", found.in_words()));
                None
            }
        }
    }

    fn any(&mut self, part: &IdedExpr, depth: usize) -> Option<(Expression, Type)> {
        if depth > DEEPEST {
            self.note(part, &format!("is nested too deeply here, expected at most {DEEPEST} levels"));
            return None;
        }
        match &part.expr {
            Expr::Literal(literal) => self.literal(part, literal),
            Expr::Ident(name) => self.name(part, name),
            Expr::Call(call) if call.target.is_none() => self.call(part, call, depth + 1),
            Expr::Call(call) => self.refused(part, &format!("the method {}()", call.func_name)),
            Expr::Select(select) if select.test => self.refused(part, "has()"),
            Expr::Select(select) => self.refused(part, &format!("the field .{}", select.field)),
            Expr::List(_) => self.refused(part, "a list"),
            Expr::Map(_) | Expr::Struct(_) => self.refused(part, "a map"),
            Expr::Comprehension(_) => self.refused(part, "a macro"),
            Expr::Unspecified => self.refused(part, "nothing"),
        }
    }

    fn refused<T>(&mut self, part: &IdedExpr, what: &str) -> Option<T> {
        let allowed = "numbers, texts, true, false, names, ! - + * / < <= > >= == != && || ?:, min(), max(), \
                       mates() and the measures distance(), closing(), known(), on_own_side()";
        self.note(part, &format!("has {what} here, expected only {allowed}"));
        None
    }

    fn literal(&mut self, part: &IdedExpr, literal: &LiteralValue) -> Option<(Expression, Type)> {
        let number = |value: f64| Some((Expression::Constant(value), Type::Number));
        match literal {
            LiteralValue::Boolean(is) => Some((Expression::Constant(f64::from(u8::from(*is.inner()))), Type::Truth)),
            LiteralValue::Double(value) => number(*value.inner()),
            LiteralValue::Int(value) => number(*value.inner() as f64),
            LiteralValue::UInt(value) => number(*value.inner() as f64),
            LiteralValue::String(text) => Some((Expression::Constant(0.0), Type::Quote(text.inner().to_owned()))),
            LiteralValue::Bytes(_) => self.refused(part, "a string of bytes"),
            LiteralValue::Null => self.refused(part, "null"),
        }
    }

    fn name(&mut self, part: &IdedExpr, name: &str) -> Option<(Expression, Type)> {
        if let Some(index) = self.variables.iter().position(|variable| variable.name == name) {
            let variable = &self.variables[index];
            if self.among_mates && !variable.shared {
                self.note(part, &format!("asks mates for {name}, which is not shared, expected a shared variable"));
                return None;
            }
            let kind = match &variable.kind {
                Kind::Truth => Type::Truth,
                Kind::Number => Type::Number,
                Kind::Text(values) => Type::Text(values.clone()),
            };
            return Some((Expression::Variable(index as u16), kind));
        }
        if let Some(fact) = Fact::all().find(|fact| fact.name() == name) {
            if self.among_mates {
                self.note(part, &format!("asks mates for {name}, which is a fact, expected a shared variable"));
                return None;
            }
            let kind = if fact.is_truth() { Type::Truth } else { Type::Number };
            return Some((Expression::Fact(fact), kind));
        }
        if place_of(name).is_some() {
            let message = format!("has the place {name} here, expected it in a measure, as in distance({name})");
            self.note(part, &message);
            return None;
        }
        let mut known: Vec<&str> = self.variables.iter().map(|variable| variable.name.as_str()).collect();
        known.extend(Fact::all().map(|fact| fact.name()));
        let guess = nearest(name, &known).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
        let message = format!(
            "has {name:?} here, which is unknown, expected a variable{}, a fact such as tagged or time_s, or a call \
             such as distance(own_flag){guess}",
            in_brackets(self.variables)
        );
        self.note(part, &message);
        None
    }

    fn call(&mut self, part: &IdedExpr, call: &CallExpr, depth: usize) -> Option<(Expression, Type)> {
        let truth = |expression| (expression, Type::Truth);
        let number = |expression| (expression, Type::Number);
        match (call.func_name.as_str(), call.args.as_slice()) {
            (operators::LOGICAL_AND, [a, b]) => self.both(Join::And, a, b, Wanted::Truth, depth).map(truth),
            (operators::LOGICAL_OR, [a, b]) => self.both(Join::Or, a, b, Wanted::Truth, depth).map(truth),
            (operators::LESS, [a, b]) => self.both(Join::Less, a, b, Wanted::Number, depth).map(truth),
            (operators::LESS_EQUALS, [a, b]) => self.both(Join::AtMost, a, b, Wanted::Number, depth).map(truth),
            (operators::GREATER, [a, b]) => self.both(Join::More, a, b, Wanted::Number, depth).map(truth),
            (operators::GREATER_EQUALS, [a, b]) => self.both(Join::AtLeast, a, b, Wanted::Number, depth).map(truth),
            (operators::ADD, [a, b]) => self.both(Join::Plus, a, b, Wanted::Number, depth).map(number),
            (operators::SUBSTRACT, [a, b]) => self.both(Join::Minus, a, b, Wanted::Number, depth).map(number),
            (operators::MULTIPLY, [a, b]) => self.both(Join::Times, a, b, Wanted::Number, depth).map(number),
            (operators::DIVIDE, [a, b]) => self.both(Join::Over, a, b, Wanted::Number, depth).map(number),
            ("min", [a, b]) => self.both(Join::Least, a, b, Wanted::Number, depth).map(number),
            ("max", [a, b]) => self.both(Join::Greatest, a, b, Wanted::Number, depth).map(number),
            (operators::EQUALS, [a, b]) => self.equality(part, Join::Equal, a, b, depth).map(truth),
            (operators::NOT_EQUALS, [a, b]) => self.equality(part, Join::Unequal, a, b, depth).map(truth),
            (operators::LOGICAL_NOT, [a]) => {
                self.of_type(a, Wanted::Truth, depth).map(|inner| truth(Expression::Not(Box::new(inner))))
            }
            (operators::NEGATE, [a]) => {
                self.of_type(a, Wanted::Number, depth).map(|inner| number(Expression::Minus(Box::new(inner))))
            }
            (operators::CONDITIONAL, [condition, then, otherwise]) => self.choice(condition, then, otherwise, depth),
            (operators::MODULO, _) => self.refused(part, "%"),
            (operators::IN, _) => self.refused(part, "in"),
            (operators::INDEX, _) => self.refused(part, "an index [...]"),
            ("mates", [condition]) => self.mates(part, condition, depth).map(number),
            (name, arguments) => self.function(part, name, arguments),
        }
    }

    /// A measure, or what is none.
    fn function(&mut self, part: &IdedExpr, name: &str, arguments: &[IdedExpr]) -> Option<(Expression, Type)> {
        if let Some(measure) = Measure::all().find(|measure| measure.name() == name) {
            let [place] = arguments else {
                let message = format!("gives {} things to {name}(), expected one place or boat", arguments.len());
                self.note(part, &message);
                return None;
            };
            let kind = if measure.is_truth() { Type::Truth } else { Type::Number };
            if self.among_mates {
                self.note(part, &format!("asks mates for {name}(), which is a measure, expected a shared variable"));
                return None;
            }
            return self.place(place, name).map(|place| (Expression::Measure(measure, place), kind));
        }
        if CALLS.contains(&name) {
            let wanted = if name == "mates" { "one condition, or none as in mates > 0" } else { "two numbers" };
            self.note(part, &format!("gives {} things to {name}(), expected {wanted}", arguments.len()));
            return None;
        }
        let known: Vec<&str> = CALLS.into_iter().chain(Measure::all().map(Measure::name)).collect();
        let guess = nearest(name, &known).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
        let known: Vec<String> = known.iter().map(|name| format!("{name}()")).collect();
        self.note(part, &format!("calls {name}(), expected one of {}{guess}", known.join(", ")));
        None
    }

    fn place(&mut self, part: &IdedExpr, measure: &str) -> Option<Place> {
        let name = match &part.expr {
            Expr::Ident(name) => name.as_str(),
            Expr::Literal(LiteralValue::String(name)) => name.inner(),
            _ => {
                self.note(part, &format!("has a value in {measure}(), expected the name of a place or boat"));
                return None;
            }
        };
        let place = place_of(name);
        if place.is_none() {
            let message = format!("asks for the {measure} of {name:?}, {}", places_allowed(name));
            self.note(part, &message);
        }
        place
    }

    fn mates(&mut self, part: &IdedExpr, condition: &IdedExpr, depth: usize) -> Option<Expression> {
        if self.among_mates {
            self.note(part, "has mates() within mates(), expected shared variables");
            return None;
        }
        self.among_mates = true;
        let condition = self.of_type(condition, Wanted::Truth, depth);
        self.among_mates = false;
        condition.map(|condition| Expression::Mates(Box::new(condition)))
    }

    fn both(&mut self, join: Join, a: &IdedExpr, b: &IdedExpr, wanted: Wanted, depth: usize) -> Option<Expression> {
        let a = self.of_type(a, wanted, depth);
        let b = self.of_type(b, wanted, depth);
        Some(Expression::Join(join, Box::new((a?, b?))))
    }

    fn equality(
        &mut self,
        part: &IdedExpr,
        join: Join,
        a: &IdedExpr,
        b: &IdedExpr,
        depth: usize,
    ) -> Option<Expression> {
        let (left, right) = (self.any(a, depth), self.any(b, depth));
        let ((left, left_type), (right, right_type)) = (left?, right?);
        let joined = |left, right| Some(Expression::Join(join, Box::new((left, right))));
        match (&left_type, &right_type) {
            (Type::Truth, Type::Truth) | (Type::Number, Type::Number) => joined(left, right),
            (Type::Text(values), Type::Quote(text)) => joined(left, self.text(a, b, values, text)?),
            (Type::Quote(text), Type::Text(values)) => joined(self.text(b, a, values, text)?, right),
            (Type::Text(_) | Type::Quote(_), Type::Text(_) | Type::Quote(_)) => {
                self.note(part, "compares two texts, expected a text variable and one of its values");
                None
            }
            _ => {
                let message = format!(
                    "compares {} with {}, expected two of one kind",
                    left_type.in_words(),
                    right_type.in_words()
                );
                self.note(part, &message);
                None
            }
        }
    }

    /// The place of `text` among the values of a variable.
    fn text(&mut self, variable: &IdedExpr, part: &IdedExpr, values: &[String], text: &str) -> Option<Expression> {
        let place = values.iter().position(|value| value == text);
        if place.is_none() {
            let name = match &variable.expr {
                Expr::Ident(name) => name.as_str(),
                _ => "a text",
            };
            let message = format!("compares {name} with {text:?}, {}", values_allowed(values, text));
            self.note(part, &message);
        }
        place.map(|place| Expression::Constant(place as f64))
    }

    fn choice(
        &mut self,
        condition: &IdedExpr,
        then: &IdedExpr,
        otherwise: &IdedExpr,
        depth: usize,
    ) -> Option<(Expression, Type)> {
        let condition = self.of_type(condition, Wanted::Truth, depth);
        let first = self.any(then, depth);
        let wanted = match first.as_ref().map(|first| &first.1) {
            Some(Type::Truth) => Wanted::Truth,
            Some(Type::Number) => Wanted::Number,
            Some(other) => {
                let message = format!("has {} here, expected a number, or true or false", other.in_words());
                self.note(then, &message);
                return None;
            }
            None => {
                self.any(otherwise, depth);
                return None;
            }
        };
        let second = self.of_type(otherwise, wanted, depth);
        let (first, kind) = first?;
        Some((Expression::Choose(Box::new((condition?, first, second?))), kind))
    }
}

/// The mark, boat or named point called `name`.
pub(super) fn place_of(name: &str) -> Option<Place> {
    let is_point = || Field::point_names().iter().any(|point| point == name);
    Place::of_name(name).or_else(|| is_point().then(|| Place::Point(name.to_owned())))
}

/// What a place may be called, and what may have been meant by `name`.
pub(super) fn places_allowed(name: &str) -> String {
    let points = Field::point_names();
    let marks: Vec<&str> = Mark::all().map(Mark::name).collect();
    let boats: Vec<&str> = Boat::all().map(Boat::name).collect();
    let known: Vec<&str> = marks.iter().chain(&boats).copied().chain(points.iter().map(String::as_str)).collect();
    let guess = nearest(name, &known).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
    format!("expected {}, a boat ({}) or a named point such as CH{guess}", marks.join(", "), boats.join(", "))
}

/// Which texts are allowed, and which may have been meant by `text`.
pub(super) fn values_allowed(values: &[String], text: &str) -> String {
    let values: Vec<&str> = values.iter().map(String::as_str).collect();
    let guess = nearest(text, &values).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
    format!("expected one of {}{guess}", values.join(", "))
}

fn in_brackets(variables: &[Variable]) -> String {
    let names: Vec<&str> = variables.iter().map(|variable| variable.name.as_str()).collect();
    if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) }
}
