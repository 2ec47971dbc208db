//! Numbers of behaviours, constant or dependent on the game.

use super::{Expression, Values};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A number of a behaviour, which may be an expression. The helm evaluates it at every decision.
/// Angles are in degrees, as in files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its value.
    pub expression: Expression,
    /// The allowed range, to which values are clamped.
    pub range: (f64, f64),
}

impl Parameter {
    /// Its current value.
    pub fn value(&self, values: &impl Values) -> f64 {
        self.expression
            .value(values)
            .clamp(self.range.0, self.range.1)
    }

    /// Its value, if it is constant.
    pub fn constant(&self) -> Option<f64> {
        self.expression
            .constant()
            .map(|value| value.clamp(self.range.0, self.range.1))
    }
}

/// In a file, a number or an expression as a string; its range is that of the key.
impl JsonSchema for Parameter {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "parameter".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "title": "a number or an expression", "type": ["number", "string"] })
    }
}
