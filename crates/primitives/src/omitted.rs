//! Numbers that a file leaves out.

use serde::{Deserialize, Deserializer};

/// A number, or NaN for one that a file leaves out, until the check of the file estimates it. Where a scenario is read
/// again, all numbers must be there.
///
/// # Errors
/// What is there is no number.
pub fn number_or_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}
