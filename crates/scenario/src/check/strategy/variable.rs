//! Checks the variables of a strategy, and the values assigned to them.

use super::expression::{CALLS, is_reserved, text_value};
use super::scope::Scope;
use crate::guess::listed;
use crate::raw;
use crate::read::Document;
use crate::strategy::{Expression, Fact, Kind, Measure, Named, Place, SHARED_MAX, Variable};

/// Maximum number of variables of a program.
const MOST: usize = 1000;

/// Checks the variables, in order of name.
pub(super) fn variables(document: &Document<raw::Strategy>) -> Vec<Variable> {
    let given = &document.raw.variables;
    let scope = Scope {
        document,
        variables: &[],
    };
    if given.len() > MOST {
        let message = format!("has {} entries, expected at most {MOST}", given.len());
        scope.note("variables", &message);
        return vec![];
    }
    let variables = given.iter();
    let variables = variables.filter_map(|(name, given)| one(&scope, name, given));
    let variables: Vec<Variable> = variables.collect();
    let shared = variables.iter().filter(|variable| variable.shared).count();
    if shared > SHARED_MAX {
        let message = format!("has {shared} shared entries, expected at most {SHARED_MAX}");
        scope.note("variables", &message);
    }
    variables
}

fn one(scope: &Scope<'_>, name: &str, given: &raw::Variable) -> Option<Variable> {
    let path = format!("variables.{name}");
    if !is_free(scope, &path, name) {
        return None;
    }
    let (kind, initial, shared) = match given {
        raw::Variable::Number(number) => (Kind::Number, *number, false),
        raw::Variable::Truth(is) => (Kind::Truth, f64::from(u8::from(*is)), false),
        raw::Variable::Table(table) => {
            let (kind, initial) = kind_of(scope, &path, table)?;
            (kind, initial, table.shared)
        }
    };
    Some(Variable {
        name: name.to_owned(),
        kind,
        initial,
        shared,
    })
}

/// Whether a variable may have this name: it must be an unused CEL identifier.
fn is_free(scope: &Scope<'_>, path: &str, name: &str) -> bool {
    if !scope.document.is_name(path, "variable", name) {
        return false;
    }
    let taken = if name.starts_with(|c: char| c.is_ascii_digit()) {
        "begins with a digit"
    } else if is_reserved(name) {
        "is a reserved word in CEL"
    } else if Fact::by_name(name).is_some() {
        "is a fact"
    } else if Place::by_name(name).is_some() {
        "is a place or a boat"
    } else if CALLS.contains(&name) || Measure::by_name(name).is_some() {
        "is a function"
    } else {
        return true;
    };
    let message = format!("variable is {name:?}, which {taken}, expected a different name");
    scope.document.note(path, message);
    false
}

/// A variable's kind and initial value.
fn kind_of(scope: &Scope<'_>, path: &str, table: &raw::VariableTable) -> Option<(Kind, f64)> {
    let initial_path = format!("{path}.initial");
    let texts = table.values.iter().flatten();
    let texts: Vec<String> = texts.map(|value| value.0.clone()).collect();
    for (i, text) in texts.iter().enumerate() {
        if !text.is_empty() && texts[..i].contains(text) {
            let message = format!("has {text:?} twice, expected unique values");
            scope.note(&format!("{path}.values.{i}"), &message);
        }
    }
    let has_values = table.values.is_some();
    match &table.initial {
        None if has_values => Some((Kind::Text(texts), 0.0)),
        None => {
            if scope.document.is_sound(&initial_path) {
                let expected = "the allowed strings, or initial with a number or boolean";
                scope.note_missing(&format!("{path}.values"), expected);
            }
            None
        }
        Some(raw::Value::Truth(is)) if !has_values => Some((Kind::Truth, f64::from(u8::from(*is)))),
        Some(raw::Value::Number(number)) if !has_values => Some((Kind::Number, *number)),
        Some(raw::Value::Text(text)) if has_values => {
            let initial = text_at(scope, &initial_path, &texts, text)?.constant()?;
            Some((Kind::Text(texts), initial))
        }
        Some(raw::Value::Text(text)) => {
            let expected = "the allowed strings as well: values = [...]";
            let message = format!("is the string {text:?}, expected {expected}");
            scope.refuse(&initial_path, &message)
        }
        Some(other) => {
            let expected = texts.join(", ");
            let message = format!("is {}, expected one of {expected}", in_words(other));
            scope.refuse(&initial_path, &message)
        }
    }
}

/// The string at `path` as a value of a variable with these `values`.
fn text_at(scope: &Scope<'_>, path: &str, values: &[String], text: &str) -> Option<Expression> {
    let wrong = |allowed| scope.refuse(path, &format!("is {text:?}, {allowed}"));
    text_value(values, text).map_or_else(wrong, Some)
}

fn in_words(given: &raw::Value) -> String {
    match given {
        raw::Value::Number(number) => number.to_string(),
        raw::Value::Truth(is) => is.to_string(),
        raw::Value::Text(text) => format!("{text:?}"),
    }
}

pub(super) fn set(scope: &Scope<'_>, path: &str, given: &raw::Values) -> Vec<(u16, Expression)> {
    let one = |(name, value): (&String, _)| assigned(scope, &format!("{path}.{name}"), name, value);
    given.iter().filter_map(one).collect()
}

fn assigned(
    scope: &Scope<'_>,
    path: &str,
    name: &str,
    given: &raw::Value,
) -> Option<(u16, Expression)> {
    let Some((index, variable)) = scope.variable(name) else {
        let expected = match scope.names().as_slice() {
            [] => "a variable, but [variables] has none".to_owned(),
            known => format!("one of the variables {}", listed(name, known)),
        };
        return scope.refuse(path, &format!("is unknown, expected {expected}"));
    };
    let value = match (&variable.kind, given) {
        (Kind::Text(values), raw::Value::Text(text)) => text_at(scope, path, values, text)?,
        (Kind::Truth, raw::Value::Truth(is)) => Expression::truth(*is),
        (Kind::Number, raw::Value::Number(number)) => Expression::Constant(*number),
        (kind, raw::Value::Text(text)) => scope.expression(path, text, kind)?,
        (kind, other) => {
            let expected = match kind {
                Kind::Text(values) => format!("one of {}", values.join(", ")),
                Kind::Truth => "true, false or an expression".to_owned(),
                Kind::Number => "a finite number or an expression".to_owned(),
            };
            let message = format!("is {}, expected {expected}", in_words(other));
            return scope.refuse(path, &message);
        }
    };
    Some((index, value))
}
