//! Values that strategy files give as numbers or as expressions.

use crate::scenario::raw::At;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::fmt;

/// A number, or an expression that gives one.
#[derive(Clone, Debug)]
pub(in crate::scenario) enum Amount {
    /// The number.
    Number(f64),
    /// The expression.
    Text(String),
}

/// A value for a variable.
#[derive(Clone, Debug)]
pub(in crate::scenario) enum Given {
    /// A number.
    Number(f64),
    /// True or false.
    Truth(bool),
    /// For a text variable one of its values, else an expression.
    Text(String),
}

/// A variable.
#[derive(Clone, Debug)]
pub(in crate::scenario) enum RawVariable {
    /// By what it is at first.
    Plain(Given),
    /// In full.
    Stated(Stated),
}

/// A variable in full.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "Variable")]
pub(in crate::scenario) struct Stated {
    /// The texts that it may have: 1 to 100 of them. Required for a text variable, and for no other.
    pub(in crate::scenario) values: Option<At<Vec<At<String>>>>,
    /// What it is at first. Required, but for texts; default their first value.
    pub(in crate::scenario) initial: Option<At<Given>>,
    /// Whether the team is told of it. Default false.
    pub(in crate::scenario) shared: Option<At<bool>>,
}

struct AmountVisitor;

impl Visitor<'_> for AmountVisitor {
    type Value = Amount;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or an expression")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Amount, E> {
        Ok(Amount::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Amount, E> {
        Ok(Amount::Number(number as f64))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Amount, E> {
        Ok(Amount::Text(text.to_owned()))
    }
}

impl<'de> Deserialize<'de> for Amount {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Amount, D::Error> {
        deserializer.deserialize_any(AmountVisitor)
    }
}

impl JsonSchema for Amount {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Amount".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "string"] })
    }
}

struct GivenVisitor;

impl Visitor<'_> for GivenVisitor {
    type Value = Given;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, true, false or a string")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Given, E> {
        Ok(Given::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Given, E> {
        Ok(Given::Number(number as f64))
    }

    fn visit_bool<E: Error>(self, is: bool) -> Result<Given, E> {
        Ok(Given::Truth(is))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Given, E> {
        Ok(Given::Text(text.to_owned()))
    }
}

impl<'de> Deserialize<'de> for Given {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Given, D::Error> {
        deserializer.deserialize_any(GivenVisitor)
    }
}

impl JsonSchema for Given {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Given".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["number", "boolean", "string"] })
    }
}

struct VariableVisitor;

impl<'de> Visitor<'de> for VariableVisitor {
    type Value = RawVariable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, true, false, or a table { values = [...], initial = ..., shared = ... }")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<RawVariable, E> {
        Ok(RawVariable::Plain(Given::Number(number)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<RawVariable, E> {
        Ok(RawVariable::Plain(Given::Number(number as f64)))
    }

    fn visit_bool<E: Error>(self, is: bool) -> Result<RawVariable, E> {
        Ok(RawVariable::Plain(Given::Truth(is)))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RawVariable, A::Error> {
        Stated::deserialize(MapAccessDeserializer::new(map)).map(RawVariable::Stated)
    }
}

impl<'de> Deserialize<'de> for RawVariable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<RawVariable, D::Error> {
        deserializer.deserialize_any(VariableVisitor)
    }
}

impl JsonSchema for RawVariable {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "AnyVariable".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let stated = generator.subschema_for::<Stated>();
        json_schema!({ "anyOf": [{ "type": ["number", "boolean"] }, stated] })
    }
}
