//! Range-checked numbers from the command line.

/// Parses a number from the command line and checks its range.
pub fn within(low: f64, high: f64, unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text: &str| {
        let number = text.parse().map_err(|_| format!("{text:?} is not a number, expected {low} to {high} {unit}"))?;
        let is_within = (low..=high).contains(&number);
        if is_within { Ok(number) } else { Err(format!("{text} is not within {low} to {high} {unit}")) }
    }
}

/// Parses a number of seconds from the command line.
///
/// # Errors
/// If it is not a number from 0 to a million.
pub fn seconds(text: &str) -> Result<f64, String> {
    within(0.0, 1e6, "s")(text)
}
