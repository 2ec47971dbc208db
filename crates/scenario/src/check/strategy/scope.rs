//! The context for checking the parts of a program: the file and the variables.

use super::{cel, expression};
use crate::diagnostics::keys_of;
use crate::raw;
use crate::read::Document;
use crate::strategy::{Expression, Kind, Parameter, Program, Variable};
use serde_json::Value as Json;

/// A program file under check. Its values are addressed by path, as in `mode.1.when`.
pub(super) struct Scope<'a> {
    pub(super) document: &'a Document<'a, raw::Strategy>,
    pub(super) variables: &'a [Variable],
}

impl<'a> Scope<'a> {
    /// The variable with this name, and its index.
    pub(super) fn variable(&self, name: &str) -> Option<(u16, &'a Variable)> {
        let mut variables = self.variables.iter();
        let index = variables.position(|variable| variable.name == name)?;
        Some((index as u16, &self.variables[index]))
    }

    /// The names of all variables.
    pub(super) fn names(&self) -> Vec<&'a str> {
        let variables = self.variables.iter();
        variables.map(|variable| variable.name.as_str()).collect()
    }

    /// Reports a fault in the value at `path`; the message names its key.
    pub(super) fn note(&self, path: &str, message: &str) {
        let message = format!("{} {message}", key_of(path));
        self.document.note(path, message);
    }

    /// Like [`Scope::note`], for callers that cannot continue without the value.
    pub(super) fn refuse<T>(&self, path: &str, message: &str) -> Option<T> {
        self.note(path, message);
        None
    }

    /// Reports a missing value at `path`, unless there is a value of a different type.
    pub(super) fn note_missing(&self, path: &str, expected: &str) {
        self.document.note_missing(path, expected);
    }

    /// Reports a fault in a mode.
    pub(super) fn note_mode(&self, program: &Program, mode: usize, message: &str) {
        let message = format!("mode {} {message}", program.path(mode));
        self.document.note(&format!("mode.{mode}"), message);
    }

    /// The condition at `path`, if valid.
    pub(super) fn condition(&self, path: &str, text: Option<&str>) -> Option<Expression> {
        self.expression(path, text?, &Kind::Truth)
    }

    /// The expression at `path`, if it is valid and of the kind `wanted`.
    pub(super) fn expression(&self, path: &str, text: &str, wanted: &Kind) -> Option<Expression> {
        // The stand-in for a faulty value is not the user's input.
        let given = self.document.is_sound(path).then_some(text)?;
        let diagnostics = &self.document.loader.diagnostics;
        let at = self.document.at(path);
        let parsed = cel::parse(diagnostics, key_of(path), at, given)?;
        expression::read(self, key_of(path), &parsed, wanted)
    }

    /// The number or expression at `path`, limited to the range in the schema `about`.
    pub(super) fn parameter(&self, path: &str, given: &Json, about: &Json) -> Option<Parameter> {
        let range = (about["minimum"].as_f64()?, about["maximum"].as_f64()?);
        let expression = match given.as_str() {
            Some(text) => self.expression(path, text, &Kind::Number)?,
            None => Expression::Constant(given.as_f64()?),
        };
        match expression.constant() {
            Some(value) if !(range.0..=range.1).contains(&value) => {
                let message = format!("is {value}, expected {} to {}", range.0, range.1);
                self.refuse(path, &message)
            }
            _ => Some(Parameter { expression, range }),
        }
    }
}

/// The key at the end of a path.
fn key_of(path: &str) -> &str {
    keys_of(path).next().unwrap_or(path)
}
