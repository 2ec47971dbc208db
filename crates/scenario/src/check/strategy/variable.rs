//! Checks the variables of a strategy, and the values assigned to them.

use super::expression::{CALLS, is_reserved, text_value};
use super::scope::Scope;
use crate::diagnostics::Diagnostics;
use crate::guess::did_you_mean;
use crate::raw;
use crate::read::Document;
use crate::strategy::{Expression, Fact, Kind, Measure, Named, Place, SHARED_MAX, Variable};

/// Maximum number of variables of a program.
const MOST: usize = 1000;

/// Checks the variables, by name.
pub(super) fn variables(
    diagnostics: &mut Diagnostics,
    document: &Document<raw::Strategy>,
) -> Vec<Variable> {
    let given = &document.raw.variables;
    let mut scope = Scope {
        diagnostics,
        document,
        variables: &[],
    };
    if given.len() > MOST {
        scope.note(
            "variables",
            &format!("has {} entries, expected at most {MOST}", given.len()),
        );
        return vec![];
    }
    let variables: Vec<Variable> = given
        .iter()
        .filter_map(|(name, given)| one(&mut scope, name, given))
        .collect();
    let shared = variables.iter().filter(|variable| variable.shared).count();
    if shared > SHARED_MAX {
        scope.note(
            "variables",
            &format!("has {shared} shared entries, expected at most {SHARED_MAX}"),
        );
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
    Some(Variable {
        name: name.to_owned(),
        kind,
        initial,
        shared,
    })
}

/// Whether a variable may have this name: a CEL identifier that is not in use.
fn is_free(scope: &mut Scope<'_>, path: &str, name: &str) -> bool {
    let at = scope.document.at(path);
    if !scope.diagnostics.is_name(at, "variable", name) {
        return false;
    }
    let taken = [
        (
            name.starts_with(|c: char| c.is_ascii_digit()),
            "begins with a digit",
        ),
        (is_reserved(name), "is a reserved word in CEL"),
        (Fact::by_name(name).is_some(), "is a fact"),
        (Place::by_name(name).is_some(), "is a place or a boat"),
        (
            CALLS.contains(&name) || Measure::by_name(name).is_some(),
            "is a function",
        ),
    ];
    let taken = taken.into_iter().find(|(is_so, _)| *is_so);
    if let Some((_, taken)) = taken {
        scope.diagnostics.note(
            at,
            format!("variable is {name:?}, which {taken}, expected another name"),
        );
    }
    taken.is_none()
}

/// A variable's kind and initial value.
fn kind_of(scope: &mut Scope<'_>, path: &str, table: &raw::VariableTable) -> Option<(Kind, f64)> {
    let initial_path = format!("{path}.initial");
    let texts: Vec<String> = table
        .values
        .iter()
        .flatten()
        .map(|value| value.0.clone())
        .collect();
    for (i, text) in texts
        .iter()
        .enumerate()
        .filter(|(i, text)| !text.is_empty() && texts[..*i].contains(text))
    {
        scope.note(
            &format!("{path}.values.{i}"),
            &format!("has {text:?} twice, expected unique values"),
        );
    }
    let has_values = table.values.is_some();
    match &table.initial {
        None if has_values => Some((Kind::Text(texts), 0.0)),
        None => {
            if scope.document.is_sound(&initial_path) {
                let expected = "the allowed texts, or initial with a number or boolean";
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
        Some(raw::Value::Text(text)) => scope.refuse(
            &initial_path,
            &format!("is the string {text:?}, expected the allowed texts as well: values = [...]"),
        ),
        Some(other) => scope.refuse(
            &initial_path,
            &format!(
                "is {}, expected one of {}",
                in_words(other),
                texts.join(", ")
            ),
        ),
    }
}

/// The text at `path` as a value of a variable with these `values`.
fn text_at(scope: &mut Scope<'_>, path: &str, values: &[String], text: &str) -> Option<Expression> {
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

pub(super) fn set(
    scope: &mut Scope<'_>,
    path: &str,
    given: &raw::Values,
) -> Vec<(u16, Expression)> {
    given
        .iter()
        .filter_map(|(name, value)| assigned(scope, &format!("{path}.{name}"), name, value))
        .collect()
}

fn assigned(
    scope: &mut Scope<'_>,
    path: &str,
    name: &str,
    given: &raw::Value,
) -> Option<(u16, Expression)> {
    let Some((index, variable)) = scope.variable(name) else {
        let known: Vec<&str> = scope
            .variables
            .iter()
            .map(|variable| variable.name.as_str())
            .collect();
        let expected = match known.as_slice() {
            [] => "a variable, but [variables] has none".to_owned(),
            _ => format!(
                "one of the variables {}{}",
                known.join(", "),
                did_you_mean(name, &known)
            ),
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
            return scope.refuse(
                path,
                &format!("is {}, expected {expected}", in_words(other)),
            );
        }
    };
    Some((index, value))
}
