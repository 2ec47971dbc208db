//! Means and their confidence intervals.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// The minimum number of observations for an interval: with fewer, all are often equal, and the
/// interval would have no width.
pub(crate) const OBSERVATIONS_MIN: usize = 5;

/// The mean of independent observations with its 95 % confidence interval, by Student's t.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// The lower bound of the interval; `None` with fewer than five observations.
    pub low: Option<f64>,
    /// The upper bound; `None` with fewer than five observations.
    pub high: Option<f64>,
}

impl Estimate {
    /// The estimate from `observations`.
    ///
    /// # Panics
    /// If `observations` is empty.
    pub fn of(observations: &[f64]) -> Estimate {
        let count = observations.len();
        assert!(count > 0, "a mean needs values");
        let (mean, squares) = mean_and_squares(observations);
        let degrees = count as f64 - 1.0;
        // Each seed is one observation: all its games have the same sea, which may favour an entry
        // from both sides and against all opponents. The interval covers other seeds but not other
        // opponents, because opponents are not chosen at random.
        let quantile = quantile(degrees).filter(|_| count >= OBSERVATIONS_MIN);
        let half = quantile.map(|quantile| quantile * (squares / degrees / count as f64).sqrt());
        Estimate {
            mean,
            low: half.map(|half| mean - half),
            high: half.map(|half| mean + half),
        }
    }

    /// The ratio of two sums over independent observations, each a part and its whole, with its
    /// interval by linearisation (Cochran, Sampling Techniques, 1977, section 2.11); `None` if the
    /// sum of the wholes is zero.
    pub fn of_ratio(observations: &[(f64, f64)]) -> Option<Estimate> {
        let whole: f64 = observations.iter().map(|(_, whole)| whole).sum();
        if whole <= 0.0 {
            return None;
        }
        let ratio = observations.iter().map(|(part, _)| part).sum::<f64>() / whole;
        let mean_whole = whole / observations.len() as f64;
        let offs: Vec<f64> = observations
            .iter()
            .map(|(part, whole)| (part - ratio * whole) / mean_whole)
            .collect();
        let Estimate { low, high, .. } = Estimate::of(&offs);
        Some(Estimate {
            mean: ratio,
            low: low.map(|low| ratio + low),
            high: high.map(|high| ratio + high),
        })
    }

    /// The mean and, if there is an interval, its half-width; both multiplied by `times`, with this
    /// many decimal places.
    pub(crate) fn shown(&self, times: f64, digits: usize) -> String {
        let half = self.half_width().map_or(String::new(), |half| {
            format!(" ± {:.digits$}", half * times)
        });
        format!("{:.digits$}{half}", self.mean * times)
    }

    /// Half the width of the interval.
    pub fn half_width(&self) -> Option<f64> {
        self.high.map(|high| high - self.mean)
    }
}

/// The mean of numbers, and the sum of their squared differences from it.
pub(crate) fn mean_and_squares(numbers: &[f64]) -> (f64, f64) {
    let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
    (
        mean,
        numbers
            .iter()
            .map(|number| (number - mean) * (number - mean))
            .sum(),
    )
}

/// Half the width of a 95 % interval in standard errors, by Student's t; `None` without degrees of
/// freedom.
pub(crate) fn quantile(degrees: f64) -> Option<f64> {
    StudentsT::new(0.0, 1.0, degrees)
        .ok()
        .map(|student| student.inverse_cdf(0.975))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published tables give four decimal places.
    const TABLE: f64 = 0.00005;

    #[test]
    fn the_interval_is_that_of_the_tables_of_student() {
        // With equally many observations of 0 and 1, the deviation is known, and the quantile
        // follows.
        for (count, quantile) in [
            (6, 2.5706),
            (10, 2.2622),
            (30, 2.0452),
            (100, 1.9842),
            (1000, 1.9623),
        ] {
            let observations: Vec<f64> = (0..count).map(|i| f64::from(i % 2)).collect();
            let estimate = Estimate::of(&observations);
            let error = (0.25 / f64::from(count - 1)).sqrt();
            let got = estimate.half_width().unwrap_or(f64::NAN) / error;
            assert!(
                estimate.mean == 0.5 && (got - quantile).abs() < TABLE,
                "{count}: {got}, tables say {quantile}"
            );
        }
    }

    #[test]
    fn a_ratio_is_the_share_of_successes_with_the_interval_of_a_proportion() {
        // 700 successes in 1000 independent trials, and 1000 trials that are not counted.
        let trials: Vec<(f64, f64)> = (0..2000)
            .map(|i| {
                if i < 1000 {
                    (f64::from(u8::from(i < 700)), 1.0)
                } else {
                    (0.0, 0.0)
                }
            })
            .collect();
        let estimate = Estimate::of_ratio(&trials).expect("trials");
        let want = 1.9612 * (0.7_f64 * 0.3 / 1000.0).sqrt();
        let half = estimate.half_width().unwrap_or(f64::NAN);
        assert!(
            (estimate.mean - 0.7).abs() < 1e-12 && (half - want).abs() < 0.0001,
            "{estimate:?}, not {want}"
        );
        // A ratio that is equal in every observation is known exactly, whatever the wholes.
        let equal =
            Estimate::of_ratio(&[(1.0, 2.0), (4.0, 8.0), (2.0, 4.0), (1.0, 2.0), (3.0, 6.0)])
                .expect("wholes");
        assert!(
            equal.mean == 0.5 && equal.half_width().is_some_and(|half| half.abs() < 1e-12),
            "{equal:?}"
        );
        assert_eq!(Estimate::of_ratio(&[(0.0, 0.0); 3]), None);
    }

    #[test]
    fn equal_observations_are_known_exactly_and_few_say_nothing_about_the_width() {
        let equal = Estimate::of(&[3.0; 5]);
        assert_eq!(
            (equal.mean, equal.low, equal.high),
            (3.0, Some(3.0), Some(3.0))
        );
        assert_eq!(
            Estimate::of(&[4.0; 4]),
            Estimate {
                mean: 4.0,
                low: None,
                high: None
            }
        );
    }
}
