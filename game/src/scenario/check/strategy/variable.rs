//! Variables of a strategy, checked, and values that are given to them.

use super::expression::{CALLS, Wanted, is_reserved, values_allowed};
use super::scope::Scope;
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::guess::did_you_mean;
use crate::scenario::raw;
use crate::scenario::read::Document;
use crate::strategy::{Expression, Fact, Kind, Measure, Named, Place, SHARED_MAX, Variable};

/// The most variables of a program.
const MOST: usize = 1000;

/// Checks the variables, by name.
pub(super) fn variables(diagnostics: &mut Diagnostics, document: &Document<raw::Strategy>) -> Vec<Variable> {
    let given = &document.raw.variables;
    let mut scope = Scope { diagnostics, document, variables: &[] };
    if given.len() > MOST {
        scope.note("variables", &format!("has {} entries, expected at most {MOST}", given.len()));
        return vec![];
    }
    let variables: Vec<Variable> = given.iter().filter_map(|(name, given)| one(&mut scope, name, given)).collect();
    let shared = variables.iter().filter(|variable| variable.shared).count();
    if shared > SHARED_MAX {
        scope.note("variables", &format!("has {shared} shared ones, expected at most {SHARED_MAX}"));
    }
    variables
}

fn one(scope: &mut Scope<'_>, name: &str, given: &raw::Variable) -> Option<Variable> {
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
    Some(Variable { name: name.to_owned(), kind, initial, shared })
}

/// Whether a variable may be called `name`: it must be a name for CEL too, and nobody else's.
fn is_free(scope: &mut Scope<'_>, path: &str, name: &str) -> bool {
    let at = scope.document.at(path);
    if !scope.diagnostics.is_name(at, "variable", name) {
        return false;
    }
    let taken = if name.starts_with(|c: char| c.is_ascii_digit()) {
        "begins with a digit"
    } else if is_reserved(name) {
        "is a word that CEL reserves"
    } else if Fact::by_name(name).is_some() {
        "is a fact"
    } else if Place::by_name(name).is_some() {
        "is a place or a boat"
    } else if CALLS.contains(&name) || Measure::by_name(name).is_some() {
        "is a call"
    } else {
        return true;
    };
    scope.diagnostics.note(at, format!("variable is {name:?}, which {taken}, expected another name"));
    false
}

/// What a variable can be, and what it is at first.
fn kind_of(scope: &mut Scope<'_>, path: &str, table: &raw::VariableTable) -> Option<(Kind, f64)> {
    let initial_path = format!("{path}.initial");
    let Some(values) = &table.values else {
        return match &table.initial {
            Some(raw::Value::Truth(is)) => Some((Kind::Truth, f64::from(u8::from(*is)))),
            Some(raw::Value::Number(number)) => Some((Kind::Number, *number)),
            Some(raw::Value::Text(text)) => {
                scope.note(
                    &initial_path,
                    &format!("is the string {text:?}, expected its values as well: values = [...]"),
                );
                None
            }
            None => {
                if scope.document.is_sound(&initial_path) {
                    let expected = "the texts it may have, or initial, a number or a truth";
                    scope.note_missing(&format!("{path}.values"), expected);
                }
                None
            }
        };
    };
    let texts: Vec<String> = values.iter().map(|value| value.0.clone()).collect();
    for (i, text) in texts.iter().enumerate().filter(|(i, text)| !text.is_empty() && texts[..*i].contains(text)) {
        scope.note(&format!("{path}.values.{i}"), &format!("has {text:?} again, expected different ones"));
    }
    let initial = match &table.initial {
        None => 0,
        Some(raw::Value::Text(text)) => text_of(scope, &initial_path, &texts, text)?,
        Some(other) => {
            let found = in_words(other);
            scope.note(&initial_path, &format!("is {found}, expected one of {}", texts.join(", ")));
            return None;
        }
    };
    Some((Kind::Text(texts), initial as f64))
}

/// Which of a variable's values a text is.
fn text_of(scope: &mut Scope<'_>, path: &str, values: &[String], text: &str) -> Option<usize> {
    let index = values.iter().position(|value| value == text);
    if index.is_none() {
        scope.note(path, &format!("is {text:?}, {}", values_allowed(values, text)));
    }
    index
}

fn in_words(given: &raw::Value) -> String {
    match given {
        raw::Value::Number(number) => number.to_string(),
        raw::Value::Truth(is) => is.to_string(),
        raw::Value::Text(text) => format!("{text:?}"),
    }
}

/// Checks the values that are given to variables at `path`.
pub(super) fn set(scope: &mut Scope<'_>, path: &str, given: &raw::Values) -> Vec<(u16, Expression)> {
    let mut set = vec![];
    for (name, value) in given {
        let path = format!("{path}.{name}");
        match scope.variables.iter().position(|variable| variable.name == *name) {
            Some(index) => set.extend(assigned(scope, &path, index, value).map(|value| (index as u16, value))),
            None => unknown(scope, &path, name),
        }
    }
    set
}

fn unknown(scope: &mut Scope<'_>, path: &str, name: &str) {
    let known: Vec<&str> = scope.variables.iter().map(|variable| variable.name.as_str()).collect();
    let expected = match known.as_slice() {
        [] => "a name from [variables], which has none".to_owned(),
        _ => format!("one of the variables {}{}", known.join(", "), did_you_mean(name, &known)),
    };
    scope.note(path, &format!("is unknown, expected {expected}"));
}

fn assigned(scope: &mut Scope<'_>, path: &str, variable: usize, given: &raw::Value) -> Option<Expression> {
    let kind = &scope.variables[variable].kind;
    match (kind, given) {
        (Kind::Text(values), raw::Value::Text(text)) => {
            text_of(scope, path, values, text).map(|index| Expression::Constant(index as f64))
        }
        (Kind::Truth, raw::Value::Truth(is)) => Some(Expression::Constant(f64::from(u8::from(*is)))),
        (Kind::Number, raw::Value::Number(number)) => Some(Expression::Constant(*number)),
        (Kind::Truth, raw::Value::Text(text)) => scope.expression(path, text, Wanted::Truth),
        (Kind::Number, raw::Value::Text(text)) => scope.expression(path, text, Wanted::Number),
        (kind, other) => {
            let expected = match kind {
                Kind::Text(values) => format!("one of {}", values.join(", ")),
                Kind::Truth => "true, false or an expression".to_owned(),
                Kind::Number => "a finite number or an expression".to_owned(),
            };
            scope.note(path, &format!("is {}, expected {expected}", in_words(other)));
            None
        }
    }
}
