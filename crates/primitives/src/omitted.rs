//! Numbers omitted from a file.

use serde::{Deserialize, Deserializer};

/// Reads a number; an omitted one is NaN until validation of the file estimates it. A deserialised
/// scenario must have all numbers.
///
/// # Errors
/// If the value is not a number.
pub fn number_or_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}
