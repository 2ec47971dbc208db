//! Variables of a strategy, checked, and values that are given to them.

use super::expression::{CALLS, RESERVED, Wanted, expression, place_of, values_allowed};
use crate::scenario::diagnostics::Diagnostics;
use crate::scenario::explain::nearest;
use crate::scenario::raw::{At, Given, RawSet, RawStrategy, RawVariable, Stated};
use crate::strategy::{Expression, Fact, Kind, Measure, SHARED_MAX, Variable};

/// The most variables of a program.
const MOST: usize = 1000;
/// The most texts of a variable.
const MOST_TEXTS: usize = 100;

/// Checks the variables, by name.
pub(super) fn variables(diagnostics: &mut Diagnostics, raw: &RawStrategy) -> Vec<Variable> {
    let Some(given) = &raw.variables else { return vec![] };
    if given.value.len() > MOST {
        diagnostics.note(given.at, format!("variables has {} entries, expected at most {MOST}", given.value.len()));
        return vec![];
    }
    let variables: Vec<Variable> =
        given.value.iter().filter_map(|(name, variable)| one(diagnostics, name, variable)).collect();
    let shared = variables.iter().filter(|variable| variable.shared).count();
    if shared > SHARED_MAX {
        diagnostics.note(given.at, format!("variables has {shared} shared ones, expected at most {SHARED_MAX}"));
    }
    variables
}

fn one(diagnostics: &mut Diagnostics, name: &str, given: &At<RawVariable>) -> Option<Variable> {
    if !is_free(diagnostics, name, given.at) {
        return None;
    }
    let (kind, initial, shared) = match &given.value {
        RawVariable::Plain(value) => {
            let (kind, initial) = plain(diagnostics, name, given.at, value)?;
            (kind, initial, false)
        }
        RawVariable::Stated(stated) => {
            let (kind, initial) = stated_kind(diagnostics, name, given.at, stated)?;
            (kind, initial, stated.shared.as_ref().is_some_and(|shared| shared.value))
        }
    };
    Some(Variable { name: name.to_owned(), kind, initial, shared })
}

/// Whether a variable may be called `name`: it must be a name for CEL too, and nobody else's.
fn is_free(diagnostics: &mut Diagnostics, name: &str, at: usize) -> bool {
    if !diagnostics.is_name(at, "variable", name) {
        return false;
    }
    let measures = Measure::all().map(Measure::name);
    let taken = if name.starts_with(|c: char| c.is_ascii_digit()) {
        "begins with a digit"
    } else if RESERVED.contains(&name) {
        "is a word that CEL reserves"
    } else if Fact::all().any(|fact| fact.name() == name) {
        "is a fact"
    } else if place_of(name).is_some() {
        "is a place or a boat"
    } else if CALLS.into_iter().chain(measures).any(|call| call == name) {
        "is a call"
    } else {
        return true;
    };
    diagnostics.note(at, format!("variable is {name:?}, which {taken}, expected another name"));
    false
}

fn plain(diagnostics: &mut Diagnostics, name: &str, at: usize, value: &Given) -> Option<(Kind, f64)> {
    match value {
        Given::Truth(is) => Some((Kind::Truth, f64::from(u8::from(*is)))),
        Given::Number(number) if number.is_finite() => Some((Kind::Number, *number)),
        Given::Number(number) => {
            diagnostics.note(at, format!("{name} is {}, expected a finite number", shown(*number)));
            None
        }
        Given::Text(text) => {
            diagnostics.note(at, format!("{name} is the string {text:?}, expected its values as well: values = [...]"));
            None
        }
    }
}

fn shown(number: f64) -> String {
    if number.is_nan() { "nan".to_owned() } else { number.to_string() }
}

fn stated_kind(diagnostics: &mut Diagnostics, name: &str, at: usize, stated: &Stated) -> Option<(Kind, f64)> {
    let Some(values) = &stated.values else {
        let Some(initial) = &stated.initial else {
            diagnostics.note_missing(
                at,
                &format!("{name}.values"),
                "the texts it may have, or initial, a number or a truth",
            );
            return None;
        };
        return plain(diagnostics, name, initial.at, &initial.value);
    };
    if !(1..=MOST_TEXTS).contains(&values.value.len()) {
        diagnostics.note(values.at, format!("values has {} entries, expected 1 to {MOST_TEXTS}", values.value.len()));
        return None;
    }
    let mut texts: Vec<String> = vec![];
    for value in &values.value {
        if diagnostics.is_name(value.at, "values", &value.value) && texts.contains(&value.value) {
            diagnostics.note(value.at, format!("values has {:?} again, expected different ones", value.value));
        }
        texts.push(value.value.clone());
    }
    let initial = match stated.initial.as_ref().map(|initial| (initial.at, &initial.value)) {
        None => 0,
        Some((at, Given::Text(text))) => text_of(diagnostics, "initial", at, &texts, text)?,
        Some((at, other)) => {
            let found = in_words(other);
            diagnostics.note(at, format!("initial is {found}, expected one of {}", texts.join(", ")));
            return None;
        }
    };
    Some((Kind::Text(texts), initial as f64))
}

fn text_of(diagnostics: &mut Diagnostics, key: &str, at: usize, values: &[String], text: &str) -> Option<usize> {
    let place = values.iter().position(|value| value == text);
    if place.is_none() {
        diagnostics.note(at, format!("{key} is {text:?}, {}", values_allowed(values, text)));
    }
    place
}

fn in_words(given: &Given) -> String {
    match given {
        Given::Number(number) => shown(*number),
        Given::Truth(is) => is.to_string(),
        Given::Text(text) => format!("{text:?}"),
    }
}

/// Checks values given to variables.
pub(super) fn set(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    given: Option<&RawSet>,
) -> Vec<(u16, Expression)> {
    let mut set = vec![];
    for (name, value) in given.into_iter().flatten() {
        let Some(index) = variables.iter().position(|variable| variable.name == *name) else {
            unknown(diagnostics, variables, name, value.at);
            continue;
        };
        let value = assigned(diagnostics, variables, &variables[index], value);
        set.extend(value.map(|value| (index as u16, value)));
    }
    set
}

fn unknown(diagnostics: &mut Diagnostics, variables: &[Variable], name: &str, at: usize) {
    let known: Vec<&str> = variables.iter().map(|variable| variable.name.as_str()).collect();
    let guess = nearest(name, &known).map(|guess| format!(" (did you mean {guess}?)")).unwrap_or_default();
    let expected = match known.as_slice() {
        [] => "a name from [variables], which has none".to_owned(),
        _ => format!("one of the variables {}", known.join(", ")),
    };
    diagnostics.note(at, format!("{name} is unknown, expected {expected}{guess}"));
}

fn assigned(
    diagnostics: &mut Diagnostics,
    variables: &[Variable],
    variable: &Variable,
    given: &At<Given>,
) -> Option<Expression> {
    let name = &variable.name;
    let wanted = match (&variable.kind, &given.value) {
        (Kind::Text(values), Given::Text(text)) => {
            let place = text_of(diagnostics, name, given.at, values, text)?;
            return Some(Expression::Constant(place as f64));
        }
        (Kind::Truth, Given::Truth(is)) => return Some(Expression::Constant(f64::from(u8::from(*is)))),
        (Kind::Number, Given::Number(number)) if number.is_finite() => return Some(Expression::Constant(*number)),
        (Kind::Truth, Given::Text(_)) => Wanted::Truth,
        (Kind::Number, Given::Text(_)) => Wanted::Number,
        (kind, other) => {
            let expected = match kind {
                Kind::Text(values) => format!("one of {}", values.join(", ")),
                Kind::Truth => "true, false or an expression".to_owned(),
                Kind::Number => "a finite number or an expression".to_owned(),
            };
            diagnostics.note(given.at, format!("{name} is {}, expected {expected}", in_words(other)));
            return None;
        }
    };
    let Given::Text(text) = &given.value else { unreachable!("only texts are left") };
    expression(diagnostics, variables, name, &At { value: text.clone(), at: given.at }, wanted)
}
