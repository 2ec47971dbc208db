//! A condition on a metric of an entry, in the form that users type: `strategy_5.win_share < 0.5`.

use super::Sweep;
use super::metric::{METRICS, Metric};
use std::fmt;
use thiserror::Error;

/// A metric of an entry below or above a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// The index of the entry.
    pub entry: usize,
    /// The index of the metric in [`METRICS`].
    pub metric: usize,
    /// Whether it holds below the threshold (`true`) or above.
    pub is_below: bool,
    /// The threshold, in the unit of the metric.
    pub threshold: f64,
}

/// Why a text is not a valid condition.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ConditionError {
    /// Its form is wrong.
    #[error(
        "{0:?} is not a condition, expected ENTRY.METRIC < NUMBER or > NUMBER, such as {1}.win_share < 0.5"
    )]
    Form(String, String),
    /// The entry is unknown.
    #[error("there is no entry {0:?}, expected one of {1}")]
    Entry(String, String),
    /// The metric is unknown.
    #[error("there is no metric {0:?}, expected one of {list}", list = METRICS.map(|metric| metric.name).join(", "))]
    Metric(String),
}

impl Condition {
    /// Parses a condition on a sweep. The entry may be omitted if the sweep has only one.
    ///
    /// # Errors
    /// [`ConditionError`] if the text is not a condition, or names an unknown entry or metric.
    pub fn parse(text: &str, sweep: &Sweep) -> Result<Condition, ConditionError> {
        let names: Vec<&str> = sweep
            .entries
            .iter()
            .map(|entry| entry.name.as_str())
            .collect();
        let wrong = || ConditionError::Form(text.to_owned(), names[0].to_owned());
        let at = text.find(['<', '>']).ok_or_else(wrong)?;
        let left = text[..at].trim();
        let number = text[at + 1..].trim();
        let threshold = number
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(wrong)?;
        let (entry, metric) = match left.split_once('.') {
            Some((entry, metric)) => {
                let place = names.iter().position(|name| *name == entry);
                (
                    place
                        .ok_or_else(|| ConditionError::Entry(entry.to_owned(), names.join(", ")))?,
                    metric,
                )
            }
            None if names.len() == 1 => (0, left),
            None => return Err(wrong()),
        };
        let metric =
            Metric::place(metric).ok_or_else(|| ConditionError::Metric(metric.to_owned()))?;
        Ok(Condition {
            entry,
            metric,
            is_below: text[at..].starts_with('<'),
            threshold,
        })
    }

    /// The distance of a number from the threshold; negative where the condition holds.
    pub(crate) fn margin(&self, number: f64) -> f64 {
        if self.is_below {
            number - self.threshold
        } else {
            self.threshold - number
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.is_below { '<' } else { '>' };
        write!(f, "{} {sign} {}", METRICS[self.metric].name, self.threshold)
    }
}
