//! The axes of a sweep: the quantities that vary between points, and their values.

use scenario::Setting;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;

/// A quantity that varies between points. Requires one of `values`, `range`, `normal` and
/// `log_normal`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Axis {
    /// A kind of file and its key, such as `sea.wind.speed_m_s`, `boat.gps.noise_m`,
    /// `rules.tag_radius_m`, `link.delay_s`, or, for the entries' strategies,
    /// `strategy.behaviour.pursue.weight`; `sea`, `boat`, `rules` or `field`, with files as values;
    /// or `opponent`, with strategy files.
    #[schemars(length(min = 1), extend("x-expected" = "a key such as sea.wind.speed_m_s"))]
    pub key: String,
    /// Levels: numbers, Booleans, strings or files, all of one type.
    #[schemars(length(max = 1000))]
    pub values: Vec<AxisValue>,
    /// Lower and upper limit. A sampled design draws values uniformly between them or, with `log`,
    /// uniformly in their logarithm.
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    pub range: Option<[f64; 2]>,
    /// Whether the levels of a range are spaced logarithmically.
    #[schemars(extend("default" = false))]
    pub log: bool,
    /// Mean and standard deviation of a normal distribution, truncated at 3 standard deviations.
    #[schemars(inner(range(min = -1e9, max = 1e9)))]
    pub normal: Option<[f64; 2]>,
    /// Median, and standard deviation of the logarithm, of a log-normal distribution, truncated at
    /// 3 standard deviations.
    #[schemars(inner(range(min = 0, max = 1e9)))]
    pub log_normal: Option<[f64; 2]>,
    /// Number of levels in a grid. They are evenly spaced for a range, and equally likely for a
    /// distribution.
    #[schemars(range(min = 2, max = 1000), extend("default" = 5))]
    pub count: u32,
    /// Value while another axis varies alone. Default: the middle level.
    pub nominal: Option<AxisValue>,
    /// Line and column of the axis in the sweep file.
    #[serde(default)]
    #[schemars(skip)]
    pub place: (usize, usize),
}

/// A value of an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline, extend("x-expected" = "a number, a string, true or false"))]
pub enum AxisValue {
    /// A number.
    Number(f64),
    /// A Boolean.
    Truth(bool),
    /// A string, or the path of a file.
    Text(String),
}

impl fmt::Display for AxisValue {
    /// As displayed: a file by its stem.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Number(number) => write!(f, "{number}"),
            AxisValue::Truth(truth) => write!(f, "{truth}"),
            AxisValue::Text(text) => match text.strip_suffix(".toml") {
                Some(path) => f.write_str(path.rsplit('/').next().unwrap_or(path)),
                None => f.write_str(text),
            },
        }
    }
}

impl AxisValue {
    /// The value as TOML. Whole numbers have no decimal point, since some keys require integers.
    pub fn toml(&self) -> String {
        match self {
            AxisValue::Text(text) => serde_json::Value::from(text.as_str()).to_string(),
            other => other.to_string(),
        }
    }

    /// The value as a number, if it is one.
    pub fn number(&self) -> Option<f64> {
        if let AxisValue::Number(number) = self {
            Some(*number)
        } else {
            None
        }
    }
}

/// The target of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// A key in files of one kind.
    Key,
    /// A file that the game names under the same key as the axis.
    File,
    /// The strategy of the opponents.
    Opponent,
}

impl Axis {
    /// The target of this axis.
    pub(super) fn target(&self) -> Target {
        match self.key.as_str() {
            "opponent" => Target::Opponent,
            "sea" | "boat" | "rules" | "field" => Target::File,
            _ => Target::Key,
        }
    }

    /// The key of the axis's setting in a game in which the entry plays as this team.
    fn setting_key(&self, team: &str) -> String {
        match (self.target(), self.key.strip_prefix("strategy.")) {
            (Target::File, _) => format!("game.{}", self.key),
            (_, Some(key)) => format!("strategy.{team}.{key}"),
            (_, None) => self.key.clone(),
        }
    }

    /// The setting for a value in a game in which the entry plays as this team.
    ///
    /// # Errors
    /// If the key of the axis does not begin with a kind of file.
    pub(super) fn setting(
        &self,
        team: &str,
        value: &AxisValue,
        path: &Path,
    ) -> Result<Setting, String> {
        Setting::new(
            &self.setting_key(team),
            value.toml(),
            path.to_owned(),
            self.place,
        )
    }

    /// The meaning of its key, from the reference of scenario files; `None` if the key is not
    /// there.
    pub fn meaning(&self) -> Option<String> {
        match self.target() {
            Target::Opponent => Some("Strategy of the opponents.".to_owned()),
            // The key of a strategy begins with a team; its name does not matter.
            _ => scenario::meaning(&self.setting_key("team")),
        }
    }

    /// Whether its values are the paths of files.
    pub fn is_of_files(&self) -> bool {
        self.target() != Target::Key
    }

    /// The levels of the axis in a grid, in order.
    pub fn levels(&self) -> Vec<AxisValue> {
        if !self.values.is_empty() {
            return self.values.clone();
        }
        let count = self.count.max(2);
        let share = |i: u32| match self.range {
            Some(_) => f64::from(i) / f64::from(count - 1),
            None => (f64::from(i) + 0.5) / f64::from(count),
        };
        (0..count).map(|i| self.at(share(i))).collect()
    }

    /// The values to check in place of all values: every listed one, or both ends and the second
    /// level of a range or distribution.
    pub(super) fn telling_values(&self) -> Vec<AxisValue> {
        let mut values = self.levels();
        if self.values.is_empty() {
            // A key allows an interval, or only the integers in it. The second level shows whether
            // the steps are integers.
            values = vec![self.at(0.0), values.swap_remove(1), self.at(1.0)];
        }
        values
    }

    /// The quantile of its distribution at `share`, from 0 to 1.
    ///
    /// # Panics
    /// If it has neither values, a range nor a distribution.
    pub fn at(&self, share: f64) -> AxisValue {
        let share = share.clamp(0.0, 1.0);
        if !self.values.is_empty() {
            let last = self.values.len() - 1;
            return self.values[((share * self.values.len() as f64) as usize).min(last)].clone();
        }
        AxisValue::Number(match (self.range, self.normal, self.log_normal) {
            (Some([low, high]), ..) if self.log => low * libm::pow(high / low, share),
            (Some([low, high]), ..) => low + (high - low) * share,
            (_, Some([mean, sigma]), _) => mean + sigma * truncated_normal(share),
            (.., Some([median, sigma])) => median * libm::exp(sigma * truncated_normal(share)),
            _ => unreachable!("an axis has values, a range or a distribution"),
        })
    }

    /// The value while a different axis varies alone.
    pub fn nominal(&self) -> AxisValue {
        self.nominal
            .clone()
            .unwrap_or_else(|| match self.values.len() {
                0 => self.at(0.5),
                count => self.values[(count - 1) / 2].clone(),
            })
    }
}

/// The quantile of the standard normal distribution truncated at 3 standard deviations.
fn truncated_normal(share: f64) -> f64 {
    const CUT: f64 = 3.0;
    let below = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
    let least = below(-CUT);
    let whole = below(CUT) - below(-CUT);
    let wanted = least + share * whole;
    // The distribution function is monotonic, and 60 bisections of a range of 6 deviations reach
    // the precision of a double.
    let mut low = -CUT;
    let mut high = CUT;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if below(middle) < wanted {
            &mut low
        } else {
            &mut high
        }) = middle;
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> Axis {
        Axis {
            key: "sea.wind.speed_m_s".to_owned(),
            values: vec![],
            range: None,
            log: false,
            normal: None,
            log_normal: None,
            count: 5,
            nominal: None,
            place: (1, 1),
        }
    }

    fn numbers(axis: &Axis) -> Vec<f64> {
        axis.levels().iter().filter_map(AxisValue::number).collect()
    }

    #[test]
    fn ranges_are_spaced_evenly_and_distributions_by_their_quantiles() {
        assert_eq!(
            numbers(&Axis {
                range: Some([2.0, 4.0]),
                ..axis()
            }),
            [2.0, 2.5, 3.0, 3.5, 4.0]
        );
        let log = numbers(&Axis {
            range: Some([0.01, 100.0]),
            log: true,
            ..axis()
        });
        for (got, want) in log.iter().zip([0.01, 0.1, 1.0, 10.0, 100.0]) {
            assert!((got / want - 1.0).abs() < 1e-12, "{log:?}");
        }
        // From tables: 10, 30, 50 ... per cent of the normal distribution lie below these values.
        // Truncation moves them by less than 0.01.
        let normal = numbers(&Axis {
            normal: Some([10.0, 2.0]),
            ..axis()
        });
        for (got, want) in normal.iter().zip([-1.2816, -0.5244, 0.0, 0.5244, 1.2816]) {
            assert!(((got - 10.0) / 2.0 - want).abs() < 0.01, "{normal:?}");
        }
        let log_normal = Axis {
            log_normal: Some([3.0, 0.5]),
            ..axis()
        };
        let ends = [0.0, 0.5, 1.0].map(|share| log_normal.at(share).number().unwrap_or(f64::NAN));
        for (got, want) in ends
            .iter()
            .zip([3.0 * libm::exp(-1.5), 3.0, 3.0 * libm::exp(1.5)])
        {
            assert!((got / want - 1.0).abs() < 1e-9, "{ends:?}");
        }
    }

    #[test]
    fn a_share_of_a_list_is_the_value_at_that_share_of_it() {
        let values = ["a", "b", "c", "d"].map(|text| AxisValue::Text(text.to_owned()));
        let axis = Axis {
            values: values.to_vec(),
            ..axis()
        };
        assert_eq!(
            [0.0, 0.24, 0.25, 0.99, 1.0].map(|share| axis.at(share).to_string()),
            ["a", "a", "b", "d", "d"]
        );
        assert_eq!(axis.nominal().to_string(), "b");
    }

    #[test]
    fn values_are_written_as_keys_take_them() {
        for (value, toml, shown) in [
            (AxisValue::Number(3.0), "3", "3"),
            (AxisValue::Number(0.1), "0.1", "0.1"),
            (AxisValue::Truth(true), "true", "true"),
            (
                AxisValue::Text("../seas/gale.toml".to_owned()),
                "\"../seas/gale.toml\"",
                "gale",
            ),
        ] {
            assert_eq!(
                (value.toml().as_str(), value.to_string().as_str()),
                (toml, shown)
            );
        }
    }
}
