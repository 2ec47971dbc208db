//! Checks expressions: resolves names, and checks types.

use super::cel::{DEEPEST, Parsed};
use super::scope::Scope;
use crate::guess::{did_you_mean, listed};
use crate::strategy::{Expression, Fact, Join, Kind, Measure, Named, Place};
use ::cel::common::ast::{CallExpr, Expr, IdedExpr, LiteralValue, operators};

/// Reserved words of CEL.
const RESERVED: &str = "as break const continue else false for function if import in let loop package namespace null return true \
                        var void while";
/// Names of functions other than measures.
pub(super) const CALLS: [&str; 3] = ["min", "max", "mates"];

/// A part of an expression, and its kind. The kind of a constant string has that string as its only
/// value.
type Read = (Expression, Kind);

/// The expression parsed for `key`, which must be of the kind `wanted`; reports faults.
pub(super) fn read(
    scope: &Scope<'_>,
    key: &str,
    parsed: &Parsed,
    wanted: &Kind,
) -> Option<Expression> {
    Reader {
        scope,
        key,
        parsed,
        among_mates: false,
        depth: 0,
    }
    .of_kind(&parsed.root, wanted)
}

struct Reader<'a, 'b> {
    scope: &'a Scope<'b>,
    key: &'a str,
    parsed: &'a Parsed,
    /// Whether this is inside `mates(...)`, where only shared variables are available.
    among_mates: bool,
    depth: usize,
}

impl Reader<'_, '_> {
    /// Reports a fault in a part.
    fn refuse<T>(&self, part: &IdedExpr, message: &str) -> Option<T> {
        let message = format!("`{}` {message}", self.key);
        let diagnostics = &self.scope.document.loader.diagnostics;
        diagnostics.note(self.parsed.place(part), message);
        None
    }

    fn of_kind(&mut self, part: &IdedExpr, wanted: &Kind) -> Option<Expression> {
        let (expression, found) = self.any(part)?;
        if found == *wanted {
            return Some(expression);
        }
        let wanted = if *wanted == Kind::Truth {
            "true or false, such as a comparison"
        } else {
            "a number"
        };
        let found = in_words(&expression, &found);
        self.refuse(part, &format!("contains {found}, expected {wanted}"))
    }

    fn any(&mut self, part: &IdedExpr) -> Option<Read> {
        if self.depth > DEEPEST {
            let message = format!("is nested too deeply, expected at most {DEEPEST} levels");
            return self.refuse(part, &message);
        }
        match &part.expr {
            Expr::Literal(literal) => self.literal(part, literal),
            Expr::Ident(name) => self.name(part, name),
            Expr::Call(call) if call.target.is_none() => {
                self.depth += 1;
                let read = self.call(part, call);
                self.depth -= 1;
                read
            }
            Expr::Call(call) => self.not_allowed(part, &format!("the method {}()", call.func_name)),
            Expr::Select(select) if select.test => self.not_allowed(part, "has()"),
            Expr::Select(select) => self.not_allowed(part, &format!("the field .{}", select.field)),
            Expr::List(_) => self.not_allowed(part, "a list"),
            Expr::Map(_) | Expr::Struct(_) => self.not_allowed(part, "a map"),
            Expr::Comprehension(_) => self.not_allowed(part, "a macro"),
            Expr::Unspecified => self.not_allowed(part, "nothing"),
        }
    }

    fn not_allowed<T>(&self, part: &IdedExpr, what: &str) -> Option<T> {
        let allowed = "numbers, strings, true, false, names, ! - + * / < <= > >= == != && || ?:, min(), max(), mates()";
        let measures = Measure::names().join("(), ");
        self.refuse(
            part,
            &format!("contains {what}; only {allowed} and the measures {measures}() are allowed"),
        )
    }

    fn literal(&self, part: &IdedExpr, literal: &LiteralValue) -> Option<Read> {
        let number = |value: f64| Some((Expression::Constant(value), Kind::Number));
        match literal {
            LiteralValue::Boolean(is) => Some((Expression::truth(*is.inner()), Kind::Truth)),
            LiteralValue::Double(value) => number(*value.inner()),
            LiteralValue::Int(value) => number(*value.inner() as f64),
            LiteralValue::UInt(value) => number(*value.inner() as f64),
            LiteralValue::String(text) => {
                let kind = Kind::Text(vec![text.inner().to_owned()]);
                Some((Expression::Constant(0.0), kind))
            }
            LiteralValue::Bytes(_) => self.not_allowed(part, "a string of bytes"),
            LiteralValue::Null => self.not_allowed(part, "\"null\""),
        }
    }

    fn name(&self, part: &IdedExpr, name: &str) -> Option<Read> {
        if let Some((index, variable)) = self.scope.variable(name) {
            if self.among_mates && !variable.shared {
                return self.refuse_to_mates(part, name, "not shared");
            }
            return Some((Expression::Variable(index), variable.kind.clone()));
        }
        if let Some(fact) = Fact::by_name(name) {
            if self.among_mates {
                return self.refuse_to_mates(part, name, "a fact");
            }
            return Some((Expression::Fact(fact), Kind::of(fact.is_truth())));
        }
        if Place::by_name(name).is_some() {
            let expected = format!("it in a measure, as in distance({name})");
            let message = format!("contains the place {name}, expected {expected}");
            return self.refuse(part, &message);
        }
        let mut known = self.scope.names();
        let listed = if known.is_empty() {
            String::new()
        } else {
            format!(" ({})", known.join(", "))
        };
        known.extend(Fact::names());
        let message = format!(
            "contains {name:?}, which is unknown, expected a variable{listed}, a fact such as tagged or time_s, or a call \
             such as distance(own_flag){}",
            did_you_mean(name, &known)
        );
        self.refuse(part, &message)
    }

    fn refuse_to_mates<T>(&self, part: &IdedExpr, name: &str, what: &str) -> Option<T> {
        let message =
            format!("uses {name} in mates(), but {name} is {what}; expected a shared variable");
        self.refuse(part, &message)
    }

    fn call(&mut self, part: &IdedExpr, call: &CallExpr) -> Option<Read> {
        // CEL names an infix operator by its symbol between underscores.
        let name = call.func_name.as_str();
        let sign = name.trim_matches('_');
        let join = Join::by_name(sign).filter(|_| CALLS.contains(&sign) == (sign == name));
        match (join, name, call.args.as_slice()) {
            (Some(join @ (Join::Equal | Join::Unequal)), _, [a, b]) => {
                self.equality(part, join, a, b)
            }
            (Some(join), _, [a, b]) => {
                let wanted = Kind::of(matches!(join, Join::And | Join::Or));
                let a = self.of_kind(a, &wanted);
                let b = self.of_kind(b, &wanted);
                let sides = Box::new((a?, b?));
                Some((Expression::Join(join, sides), Kind::of(join.is_truth())))
            }
            (_, operators::LOGICAL_NOT, [a]) => {
                let inner = Box::new(self.of_kind(a, &Kind::Truth)?);
                Some((Expression::Not(inner), Kind::Truth))
            }
            (_, operators::NEGATE, [a]) => {
                let inner = Box::new(self.of_kind(a, &Kind::Number)?);
                Some((Expression::Minus(inner), Kind::Number))
            }
            (_, operators::CONDITIONAL, [condition, then, otherwise]) => {
                self.choice(condition, then, otherwise)
            }
            (_, operators::MODULO, _) => self.not_allowed(part, "\"%\""),
            (_, operators::IN, _) => self.not_allowed(part, "\"in\""),
            (_, operators::INDEX, _) => self.not_allowed(part, "an index [...]"),
            (_, "mates", [_]) if self.among_mates => {
                let message = "contains mates() within mates(), expected shared variables";
                self.refuse(part, message)
            }
            (_, "mates", [condition]) => {
                self.among_mates = true;
                let condition = self.of_kind(condition, &Kind::Truth);
                self.among_mates = false;
                Some((Expression::Mates(Box::new(condition?)), Kind::Number))
            }
            (_, name, arguments) => self.measure(part, name, arguments),
        }
    }

    /// A measure; reports calls of other functions.
    fn measure(&mut self, part: &IdedExpr, name: &str, arguments: &[IdedExpr]) -> Option<Read> {
        let given = format!("passes {} arguments to {name}(), expected", arguments.len());
        let kind = |measure: Measure| Kind::of(measure.is_truth());
        match (Measure::by_name(name), arguments) {
            (Some(_), _) if self.among_mates => {
                self.refuse_to_mates(part, &format!("{name}()"), "a measure")
            }
            (Some(measure), [place]) => {
                let place = self.place(place, name)?;
                Some((Expression::Measure(measure, place), kind(measure)))
            }
            (Some(measure), [from, to]) if measure.is_of_two() => {
                let from = self.place(from, name);
                let to = self.place(to, name);
                let places = Box::new((from?, to?));
                Some((Expression::Between(measure, places), kind(measure)))
            }
            (Some(measure), _) if measure.is_of_two() => {
                self.refuse(part, &format!("{given} one place or boat, or two"))
            }
            (Some(_), _) => self.refuse(part, &format!("{given} one place or boat")),
            _ if name == "mates" => {
                let message = format!("{given} one condition, or none as in mates > 0");
                self.refuse(part, &message)
            }
            _ if CALLS.contains(&name) => self.refuse(part, &format!("{given} two numbers")),
            _ => {
                let known = [&CALLS[..], &Measure::names()].concat();
                let expected = known.join("(), ") + "()" + &did_you_mean(name, &known);
                self.refuse(part, &format!("calls {name}(), expected one of {expected}"))
            }
        }
    }

    fn place(&self, part: &IdedExpr, measure: &str) -> Option<Place> {
        let name = match &part.expr {
            Expr::Ident(name) => name.as_str(),
            Expr::Literal(LiteralValue::String(name)) => name.inner(),
            _ => {
                let message =
                    format!("passes a value to {measure}(), expected the name of a place or boat");
                return self.refuse(part, &message);
            }
        };
        Place::by_name(name).or_else(|| {
            let known = Place::names();
            let known: Vec<&str> = known.iter().map(String::as_str).collect();
            let expected = Place::names_in_short() + &did_you_mean(name, &known);
            let message = format!("uses the {measure} of {name:?}, expected {expected}");
            self.refuse(part, &message)
        })
    }

    fn equality(
        &mut self,
        part: &IdedExpr,
        join: Join,
        a: &IdedExpr,
        b: &IdedExpr,
    ) -> Option<Read> {
        let left = self.any(a);
        let right = self.any(b);
        let (left, left_kind) = left?;
        let (right, right_kind) = right?;
        let is_variable = |side: &Expression| side.as_variable().is_some();
        let sides = match (&left_kind, &right_kind) {
            (Kind::Text(one), Kind::Text(other)) => match (is_variable(&left), is_variable(&right))
            {
                (true, false) => (left, self.text(a, b, one, &other[0])?),
                (false, true) => (self.text(b, a, other, &one[0])?, right),
                _ => {
                    let expected = "a string variable and one of its values";
                    let message = format!("compares two strings, expected {expected}");
                    return self.refuse(part, &message);
                }
            },
            _ if left_kind == right_kind => (left, right),
            _ => {
                let [left, right] = [(left, left_kind), (right, right_kind)]
                    .map(|(side, kind)| in_words(&side, &kind));
                let message =
                    format!("compares {left} with {right}, expected two values of the same kind");
                return self.refuse(part, &message);
            }
        };
        Some((Expression::Join(join, Box::new(sides)), Kind::Truth))
    }

    /// The index of `text` among the values of a variable.
    fn text(
        &self,
        variable: &IdedExpr,
        part: &IdedExpr,
        values: &[String],
        text: &str,
    ) -> Option<Expression> {
        let name = match &variable.expr {
            Expr::Ident(name) => name,
            _ => "a string",
        };
        let wrong = |allowed| format!("compares {name} with {text:?}, {allowed}");
        let refuse = |allowed| self.refuse(part, &wrong(allowed));
        text_value(values, text).map_or_else(refuse, Some)
    }

    fn choice(
        &mut self,
        condition: &IdedExpr,
        then: &IdedExpr,
        otherwise: &IdedExpr,
    ) -> Option<Read> {
        let condition = self.of_kind(condition, &Kind::Truth);
        let Some((first, kind)) = self.any(then) else {
            self.any(otherwise);
            return None;
        };
        if let Kind::Text(_) = kind {
            let found = in_words(&first, &kind);
            let message = format!("contains {found}, expected a number, or true or false");
            return self.refuse(then, &message);
        }
        let second = self.of_kind(otherwise, &kind);
        let parts = Box::new((condition?, first, second?));
        Some((Expression::Choose(parts), kind))
    }
}

fn in_words(expression: &Expression, kind: &Kind) -> String {
    match kind {
        Kind::Truth => "true or false".to_owned(),
        Kind::Number => "a number".to_owned(),
        Kind::Text(_) if expression.as_variable().is_some() => "a string".to_owned(),
        Kind::Text(text) => format!("the string {:?}", text[0]),
    }
}

/// Whether `name` is a reserved word of CEL.
pub(super) fn is_reserved(name: &str) -> bool {
    RESERVED.split(' ').any(|word| word == name)
}

/// The index of a string among `values`, or a message with the allowed values and a suggestion.
pub(super) fn text_value(values: &[String], text: &str) -> Result<Expression, String> {
    let known: Vec<&str> = values.iter().map(String::as_str).collect();
    match known.iter().position(|value| *value == text) {
        Some(place) => Ok(Expression::Constant(place as f64)),
        None => Err(format!("expected one of {}", listed(text, &known))),
    }
}
