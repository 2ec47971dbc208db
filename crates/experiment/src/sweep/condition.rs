//! A condition on a metric of an entry, as people type it: `strategy_5.win_share < 0.5`.

use super::Sweep;
use super::metric::{METRICS, Metric};
use std::fmt;
use thiserror::Error;

/// A metric of an entry below or above a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// The entry.
    pub entry: usize,
    /// The metric.
    pub metric: &'static Metric,
    /// Whether it holds below the threshold, or above.
    pub is_below: bool,
    /// The number.
    pub threshold: f64,
}

/// Why a text is no condition.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ConditionError {
    /// It has another form.
    #[error("{0:?} is no condition, expected ENTRY.METRIC < NUMBER or > NUMBER, as in {1}.win_share < 0.5")]
    Form(String, String),
    /// There is no such entry.
    #[error("there is no entry {0:?}, expected one of {1}")]
    Entry(String, String),
    /// There is no such metric.
    #[error("there is no metric {0:?}, expected one of {list}", list = METRICS.each_ref().map(|metric| metric.name).join(", "))]
    Metric(String),
}

impl Condition {
    /// Reads a condition on a sweep. The entry may be left out where there is one alone.
    ///
    /// # Errors
    /// [`ConditionError`]: it is none, or names what the sweep does not have.
    pub fn parse(text: &str, sweep: &Sweep) -> Result<Condition, ConditionError> {
        let names: Vec<&str> = sweep.entries.iter().map(|entry| entry.name.as_str()).collect();
        let wrong = || ConditionError::Form(text.to_owned(), names[0].to_owned());
        let at = text.find(['<', '>']).ok_or_else(wrong)?;
        let (left, number) = (text[..at].trim(), text[at + 1..].trim());
        let threshold = number.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(wrong)?;
        let (entry, metric) = match left.split_once('.') {
            Some((entry, metric)) => {
                let place = names.iter().position(|name| *name == entry);
                (place.ok_or_else(|| ConditionError::Entry(entry.to_owned(), names.join(", ")))?, metric)
            }
            None if names.len() == 1 => (0, left),
            None => return Err(wrong()),
        };
        let metric = Metric::named(metric).ok_or_else(|| ConditionError::Metric(metric.to_owned()))?;
        Ok(Condition { entry, metric, is_below: text[at..].starts_with('<'), threshold })
    }

    /// By how much a number is on the side where it does not hold: below 0 where it does.
    pub(crate) fn margin(&self, number: f64) -> f64 {
        if self.is_below { number - self.threshold } else { self.threshold - number }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.is_below { '<' } else { '>' };
        write!(f, "{} {sign} {}", self.metric.name, self.threshold)
    }
}
