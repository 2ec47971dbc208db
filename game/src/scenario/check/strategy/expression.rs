//! Expressions, checked: names become what they stand for, and types must fit.

use super::cel::{DEEPEST, Parsed};
use super::scope::Scope;
use crate::scenario::guess::did_you_mean;
use crate::strategy::{Expression, Fact, Join, Kind, Measure, Named, Place};
use ::cel::common::ast::{CallExpr, Expr, IdedExpr, LiteralValue, operators};

/// Words that CEL keeps for itself.
const RESERVED: &str = "as break const continue else false for function if import in let loop package namespace null return true \
                        var void while";
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
    fn of(is_truth: bool) -> Type {
        if is_truth { Type::Truth } else { Type::Number }
    }

    fn in_words(&self) -> String {
        match self {
            Type::Truth => "true or false".to_owned(),
            Type::Number => "a number".to_owned(),
            Type::Text(_) => "a text".to_owned(),
            Type::Quote(text) => format!("the text {text:?}"),
        }
    }
}

/// Reads an expression that was parsed.
pub(super) struct Reader<'a, 'b> {
    scope: &'a mut Scope<'b>,
    key: &'a str,
    parsed: &'a Parsed,
    /// Within `mates(...)`, where only shared variables are known.
    among_mates: bool,
}

impl<'a, 'b> Reader<'a, 'b> {
    /// For the expression that is given for `key`.
    pub(super) fn new(scope: &'a mut Scope<'b>, key: &'a str, parsed: &'a Parsed) -> Reader<'a, 'b> {
        Reader { scope, key, parsed, among_mates: false }
    }

    /// The expression, which must be of type `wanted`; what is wrong with it is noted.
    pub(super) fn expression(&mut self, wanted: Wanted) -> Option<Expression> {
        self.of_type(&self.parsed.root, wanted, 0)
    }

    fn note(&mut self, part: &IdedExpr, message: &str) {
        let message = format!("{} {message}", self.key);
        self.scope.diagnostics.note(self.parsed.place(part), message);
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
        let variables = self.scope.variables;
        if let Some(index) = variables.iter().position(|variable| variable.name == name) {
            let variable = &variables[index];
            if self.among_mates && !variable.shared {
                return self.refused_to_mates(part, name, "not shared");
            }
            let kind = match &variable.kind {
                Kind::Truth => Type::Truth,
                Kind::Number => Type::Number,
                Kind::Text(values) => Type::Text(values.clone()),
            };
            return Some((Expression::Variable(index as u16), kind));
        }
        if let Some(fact) = Fact::by_name(name) {
            if self.among_mates {
                return self.refused_to_mates(part, name, "a fact");
            }
            return Some((Expression::Fact(fact), Type::of(fact.is_truth())));
        }
        if Place::by_name(name).is_some() {
            self.note(part, &format!("has the place {name} here, expected it in a measure, as in distance({name})"));
            return None;
        }
        let mut known: Vec<&str> = variables.iter().map(|variable| variable.name.as_str()).collect();
        let listed = if known.is_empty() { String::new() } else { format!(" ({})", known.join(", ")) };
        known.extend(Fact::names());
        let message = format!(
            "has {name:?} here, which is unknown, expected a variable{listed}, a fact such as tagged or time_s, or a call \
             such as distance(own_flag){}",
            did_you_mean(name, &known)
        );
        self.note(part, &message);
        None
    }

    fn refused_to_mates<T>(&mut self, part: &IdedExpr, name: &str, what: &str) -> Option<T> {
        self.note(part, &format!("asks mates for {name}, which is {what}, expected a shared variable"));
        None
    }

    fn call(&mut self, part: &IdedExpr, call: &CallExpr, depth: usize) -> Option<(Expression, Type)> {
        // CEL calls an infix operator by its sign between underscores.
        let name = call.func_name.as_str();
        let sign = name.trim_matches('_');
        let join = Join::by_name(sign).filter(|_| CALLS.contains(&sign) == (sign == name));
        match (join, name, call.args.as_slice()) {
            (Some(join @ (Join::Equal | Join::Unequal)), _, [a, b]) => self.equality(part, join, a, b, depth),
            (Some(join), _, [a, b]) => {
                let wanted = if matches!(join, Join::And | Join::Or) { Wanted::Truth } else { Wanted::Number };
                let (a, b) = (self.of_type(a, wanted, depth), self.of_type(b, wanted, depth));
                Some((Expression::Join(join, Box::new((a?, b?))), Type::of(join.is_truth())))
            }
            (_, operators::LOGICAL_NOT, [a]) => {
                self.of_type(a, Wanted::Truth, depth).map(|inner| (Expression::Not(Box::new(inner)), Type::Truth))
            }
            (_, operators::NEGATE, [a]) => {
                self.of_type(a, Wanted::Number, depth).map(|inner| (Expression::Minus(Box::new(inner)), Type::Number))
            }
            (_, operators::CONDITIONAL, [condition, then, otherwise]) => self.choice(condition, then, otherwise, depth),
            (_, operators::MODULO, _) => self.refused(part, "%"),
            (_, operators::IN, _) => self.refused(part, "in"),
            (_, operators::INDEX, _) => self.refused(part, "an index [...]"),
            (_, "mates", [condition]) => self.mates(part, condition, depth).map(|mates| (mates, Type::Number)),
            (_, name, arguments) => self.function(part, name, arguments),
        }
    }

    /// A measure, or what is none.
    fn function(&mut self, part: &IdedExpr, name: &str, arguments: &[IdedExpr]) -> Option<(Expression, Type)> {
        if let Some(measure) = Measure::by_name(name) {
            let [place] = arguments else {
                let message = format!("gives {} things to {name}(), expected one place or boat", arguments.len());
                self.note(part, &message);
                return None;
            };
            if self.among_mates {
                return self.refused_to_mates(part, &format!("{name}()"), "a measure");
            }
            let place = self.place(place, name)?;
            return Some((Expression::Measure(measure, place), Type::of(measure.is_truth())));
        }
        if CALLS.contains(&name) {
            let wanted = if name == "mates" { "one condition, or none as in mates > 0" } else { "two numbers" };
            self.note(part, &format!("gives {} things to {name}(), expected {wanted}", arguments.len()));
            return None;
        }
        let known = [&CALLS[..], &Measure::names()].concat();
        let message = format!("calls {name}(), expected one of {}(){}", known.join("(), "), did_you_mean(name, &known));
        self.note(part, &message);
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
        let place = Place::by_name(name);
        if place.is_none() {
            let known = Place::names();
            let guess = did_you_mean(name, &known.iter().map(String::as_str).collect::<Vec<_>>());
            let expected = Place::names_in_short();
            self.note(part, &format!("asks for the {measure} of {name:?}, expected {expected}{guess}"));
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

    fn equality(
        &mut self,
        part: &IdedExpr,
        join: Join,
        a: &IdedExpr,
        b: &IdedExpr,
        depth: usize,
    ) -> Option<(Expression, Type)> {
        let (left, right) = (self.any(a, depth), self.any(b, depth));
        let ((left, left_type), (right, right_type)) = (left?, right?);
        let joined = |left, right| Some((Expression::Join(join, Box::new((left, right))), Type::Truth));
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

/// Whether CEL keeps `name` for itself.
pub(super) fn is_reserved(name: &str) -> bool {
    RESERVED.split(' ').any(|word| word == name)
}

/// Which texts are allowed, and which may have been meant by `text`.
pub(super) fn values_allowed(values: &[String], text: &str) -> String {
    let values: Vec<&str> = values.iter().map(String::as_str).collect();
    format!("expected one of {}{}", values.join(", "), did_you_mean(text, &values))
}
