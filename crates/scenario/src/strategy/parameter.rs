//! Numbers of behaviours, which may follow the game.

use super::{Expression, Values};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A number of a behaviour. It may be an expression, which is evaluated anew at every decision: that is how behaviours are
/// updated while they run. Angles are compass degrees as in files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its value.
    pub expression: Expression,
    /// The values it may have; others become the nearest of these.
    pub range: (f64, f64),
}

impl Parameter {
    /// Its value now.
    #[must_use]
    pub fn value(&self, values: &impl Values) -> f64 {
        self.expression.value(values).clamp(self.range.0, self.range.1)
    }

    /// Its value, if that is always the same.
    #[must_use]
    pub fn constant(&self) -> Option<f64> {
        self.expression.constant().map(|value| value.clamp(self.range.0, self.range.1))
    }
}

/// In a file it is the number, or the expression as text; its range is that of the key.
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
