//! A node of a graph: its attributes and its errors.

use super::NetworkError;
use super::error::shown;
use super::proto::{AttributeProto, NodeProto};

/// The supported codes of `AttributeProto.AttributeType`.
const FLOAT: i32 = 1;
const INT: i32 = 2;
const STRING: i32 = 3;
const TENSOR: i32 = 4;
const FLOATS: i32 = 6;
const INTS: i32 = 7;

pub(super) struct Node<'a> {
    pub(super) proto: &'a NodeProto,
    /// The operator's name, as in the operator table.
    pub(super) operator: &'static str,
    /// The version of the operator set.
    pub(super) version: i64,
}

impl<'a> Node<'a> {
    pub(super) fn wrong(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> NetworkError {
        NetworkError::at(
            format!("node `{}` ({})", name(self.proto), self.operator),
            found,
            expected,
        )
    }

    /// The name of input `index`, if any.
    pub(super) fn input(&self, index: usize) -> Option<&'a str> {
        self.proto
            .input
            .get(index)
            .map(String::as_str)
            .filter(|name| !name.is_empty())
    }

    /// Rejects attributes that would be ignored.
    pub(super) fn check_attributes(&self, known: &[&str]) -> Result<(), NetworkError> {
        let unknown = self
            .proto
            .attribute
            .iter()
            .find(|attribute| !known.contains(&attribute.name.as_str()));
        let Some(unknown) = unknown else {
            return Ok(());
        };
        let expected = if known.is_empty() {
            "none".to_owned()
        } else {
            format!("only {}", known.join(", "))
        };
        Err(self.wrong(format!("the attribute {}", shown(&unknown.name)), expected))
    }

    pub(super) fn integer(&self, name: &str, default: i64) -> Result<i64, NetworkError> {
        Ok(self
            .attribute(name, INT, "an integer")?
            .map_or(default, |attribute| attribute.i.unwrap_or_default()))
    }

    pub(super) fn float(&self, name: &str, default: f32) -> Result<f32, NetworkError> {
        let attribute = self.attribute(name, FLOAT, "a number")?;
        let number = attribute.map_or(default, |attribute| attribute.f.unwrap_or_default());
        if !number.is_finite() {
            return Err(self.wrong(format!("{name} = {number}"), "a finite number"));
        }
        Ok(number)
    }

    pub(super) fn text(&self, name: &str, default: &'a str) -> Result<&'a str, NetworkError> {
        let attribute = self.attribute(name, STRING, "a string")?;
        let bytes = attribute.map(|attribute| attribute.s.as_deref().unwrap_or_default());
        let text = bytes.map_or(Ok(default), str::from_utf8);
        text.map_err(|_| self.wrong(format!("{name} in an unknown encoding"), "UTF-8 text"))
    }

    pub(super) fn integers(&self, name: &str) -> Result<Option<&'a [i64]>, NetworkError> {
        Ok(self
            .attribute(name, INTS, "a list of integers")?
            .map(|attribute| attribute.ints.as_slice()))
    }

    pub(super) fn floats(&self, name: &str) -> Result<Option<&'a [f32]>, NetworkError> {
        Ok(self
            .attribute(name, FLOATS, "a list of numbers")?
            .map(|attribute| attribute.floats.as_slice()))
    }

    pub(super) fn tensor(&self, name: &str) -> Result<Option<&'a AttributeProto>, NetworkError> {
        self.attribute(name, TENSOR, "a tensor")
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.proto
            .attribute
            .iter()
            .any(|attribute| attribute.name == name)
    }

    fn attribute(
        &self,
        name: &str,
        code: i32,
        expected: &str,
    ) -> Result<Option<&'a AttributeProto>, NetworkError> {
        let attribute = self
            .proto
            .attribute
            .iter()
            .find(|attribute| attribute.name == name);
        // Files of the first version lack type codes.
        match attribute {
            Some(other) if other.r#type != code && other.r#type != 0 => Err(self.wrong(
                format!("the attribute {name} of type {}", other.r#type),
                expected,
            )),
            _ => Ok(attribute),
        }
    }

    /// An axis of a tensor with `rank` dimensions; negative values count from the end.
    pub(super) fn axis(&self, axis: i64, rank: usize) -> Result<usize, NetworkError> {
        match usize::try_from(from_start(axis, rank)) {
            Ok(axis) if axis < rank => Ok(axis),
            _ => Err(self.wrong(format!("axis {axis}"), format!("one of {rank} axes"))),
        }
    }
}

/// An index among `length` elements; negative ones count from the end.
pub(super) fn from_start(index: i64, length: usize) -> i64 {
    if index < 0 {
        index.saturating_add_unsigned(length as u64)
    } else {
        index
    }
}

/// A node's name or, without one, its output's.
pub(super) fn name(proto: &NodeProto) -> String {
    let names = [Some(&proto.name), proto.output.first()];
    shown(
        names
            .into_iter()
            .flatten()
            .find(|name| !name.is_empty())
            .map_or("unnamed", String::as_str),
    )
}
