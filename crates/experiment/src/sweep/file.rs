//! Sweep files: strategies play the same games repeatedly while scenario values change.

use super::axis::{Axis, AxisValue, Target};
use crate::tournament::{Entrant, check_entries};
use scenario::keys::FilePath;
use scenario::strategy::Strategy;
use scenario::{
    Document, Overrides, Problems, Scenario, ScenarioFile, check_variants, tidied_path,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Strategies against one opponent at many points of a scenario space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sweep {
    /// The sweep file's stem.
    #[schemars(skip)]
    pub name: String,
    /// Its path.
    #[serde(default)]
    #[schemars(skip)]
    pub path: PathBuf,
    /// Description, in one line.
    #[schemars(extend("default" = ""))]
    pub about: String,
    /// Game file, whose strategies are replaced.
    #[schemars(with = "FilePath")]
    pub game: PathBuf,
    /// Strategy file of the opponent.
    #[schemars(with = "FilePath")]
    pub opponent: PathBuf,
    /// Games per entry and point, half of them on each side; odd numbers are rounded up. All points
    /// use the same seeds.
    #[schemars(range(min = 2, max = 1000000), extend("default" = 20))]
    pub games: u32,
    /// First seed, incremented every two games. It also selects the points of a sampled design.
    #[schemars(range(min = 0, max = i64::MAX), extend("default" = 1))]
    pub seed: u64,
    /// How points are selected.
    #[schemars(extend("default" = "grid"))]
    pub design: Design,
    /// Number of points of a sampled design.
    #[schemars(range(min = 1, max = 65536), extend("default" = 64))]
    pub points: u32,
    /// The strategies compared.
    #[serde(rename = "entry")]
    #[schemars(length(min = 1, max = 100))]
    pub entries: Vec<Entrant>,
    /// The quantities that vary between points.
    #[serde(rename = "axis")]
    #[schemars(length(min = 1, max = 50))]
    pub axes: Vec<Axis>,
}

/// How points are selected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Every combination of levels.
    Grid,
    /// The nominal point, and each level of each axis with all other axes at their nominal values.
    OneAtATime,
    /// `points` points; each axis is divided into as many equally likely intervals, with one point
    /// in each (McKay and others, Technometrics 1979).
    LatinHypercube,
    /// The first `points` of a scrambled Sobol sequence (Burley, JCGT 2020).
    Sobol,
}

impl ScenarioFile for Sweep {
    type Keys = Sweep;
    const NAME: &'static str = "sweep";
    const FOLDER: &'static str = "sweeps";

    fn check(document: &Document<Sweep>) -> Option<Sweep> {
        checked(document)
    }

    /// Checks the game with enough values of every axis to cover all values, one axis at a time.
    fn check_games(&self) -> Result<(), Problems> {
        let teams = scenario::load(&self.game)?.teams.into_iter();
        let teams: Vec<String> = teams.map(|team| team.name).collect();
        let nominal: Vec<AxisValue> = self.axes.iter().map(Axis::nominal).collect();
        let overrides = |values: &[AxisValue]| self.overrides(&teams, 0, 0, values);
        let changed = |(i, value): (usize, AxisValue)| {
            let mut values = nominal.clone();
            values[i] = value;
            overrides(&values)
        };
        let values = self.axes.iter().map(Axis::telling_values).enumerate();
        let values = values.flat_map(|(i, values)| values.into_iter().map(move |one| (i, one)));
        let checked = check_variants(&self.game, &overrides(&nominal), values.map(changed));
        let Err(Problems(mut problems)) = checked else {
            return Ok(());
        };
        // Each value is read as a separate setting, so the source line of its problem is not in the
        // file.
        for problem in problems.iter_mut().filter(|one| one.path == self.path) {
            problem.source.clear();
        }
        Problems::of(problems)
    }
}

impl Sweep {
    /// The overrides of the game's files and numbers at a point, for an entry on a side (0: the
    /// first team, 1: the second). `values` are the values of the axes.
    ///
    /// # Panics
    /// If the entry or side does not exist, or a key is invalid; a checked sweep has only valid
    /// keys.
    pub fn overrides(
        &self,
        teams: &[String],
        entry: usize,
        side: usize,
        values: &[AxisValue],
    ) -> Overrides {
        let mut opponent = self.opponent.clone();
        let mut settings = vec![];
        for (axis, value) in self.axes.iter().zip(values) {
            if axis.target() != Target::Opponent {
                let setting = axis.setting(&teams[side], value, &self.path);
                settings.push(setting.expect("a checked sweep has valid keys"));
            } else if let AxisValue::Text(file) = value {
                opponent = beside(&self.path, file);
            }
        }
        let own = self.entries[entry].strategy.clone();
        let strategies = match side {
            0 => [own, opponent],
            _ => [opponent, own],
        };
        Overrides {
            strategies: teams.iter().cloned().zip(strategies).collect(),
            settings,
            ..Overrides::default()
        }
    }
}

/// Resolves a file named in another file.
fn beside(file: &Path, named: &str) -> PathBuf {
    tidied_path(&file.parent().unwrap_or(Path::new("")).join(named))
}

fn checked(document: &Document<Sweep>) -> Option<Sweep> {
    let mut sweep = document.raw.clone();
    sweep.path = document.position("").0;
    document.resolved::<Scenario>("game", &mut sweep.game);
    document.resolved::<Strategy>("opponent", &mut sweep.opponent);
    check_entries(document, &mut sweep.entries);
    let mut keys = BTreeSet::new();
    for (i, axis) in sweep.axes.iter_mut().enumerate() {
        let at = format!("axis.{i}");
        let key_path = format!("{at}.key");
        let (_, line, column) = document.position(&key_path);
        axis.place = (line, column);
        if document.is_sound(&at) {
            check_axis(document, &at, axis);
            if !keys.insert(axis.key.clone()) {
                let message = format!(
                    "the key {:?} is used twice, expected a unique key for each axis",
                    axis.key
                );
                document.note(&key_path, message);
            }
        }
    }
    document.is_faultless().then_some(sweep)
}

fn check_axis(document: &Document<Sweep>, at: &str, axis: &Axis) {
    let given: Vec<&'static str> = ["values", "range", "normal", "log_normal"]
        .into_iter()
        .filter(|key| document.has(&format!("{at}.{key}")))
        .collect();
    let problem = problem_of_key(axis, &given)
        .map(|message| ("key", message))
        .or_else(|| problem_of_values(axis, given[0]))
        .or_else(|| problem_of_distribution(axis));
    if let Some((key, message)) = problem {
        document.note(&format!("{at}.{key}"), message);
    }
}

fn problem_of_key(axis: &Axis, given: &[&str]) -> Option<String> {
    let key = &axis.key;
    if !axis.is_of_files()
        && let Err(error) = axis.setting("team", &AxisValue::Number(0.0), Path::new(""))
    {
        return Some(format!(
            "key is {key:?}, expected sea, boat, rules, field, opponent or a key such as sea.wind.speed_m_s: {error}"
        ));
    }
    let found = match given {
        [_] => return None,
        [] => "none".to_owned(),
        several => several.join(" and "),
    };
    Some(format!(
        "{key} has {found}, expected one of values, range, normal, log_normal"
    ))
}

fn problem_of_values(axis: &Axis, given: &'static str) -> Option<(&'static str, String)> {
    let Axis { key, values, .. } = axis;
    let files = "files as values, as in values = [\"../seas/calm.toml\"]";
    let kind = |value: &AxisValue| std::mem::discriminant(value);
    let is_text = |value: &AxisValue| matches!(value, AxisValue::Text(_));
    if axis.is_of_files() && !values.iter().all(is_text) {
        let message = format!("values of {key} are not files, expected {files}");
        Some(("values", message))
    } else if axis.is_of_files() && values.is_empty() {
        Some((given, format!("{key} has no values, expected {files}")))
    } else if values.is_empty() && given == "values" {
        let message = format!("{key} has no values, expected at least one");
        Some(("values", message))
    } else if values
        .windows(2)
        .any(|pair| kind(&pair[0]) != kind(&pair[1]))
    {
        let message = format!("values of {key} have different types, expected values of one type");
        Some(("values", message))
    } else if (1..values.len()).any(|k| values[..k].contains(&values[k])) {
        let message = format!("values of {key} contain a duplicate, expected unique values");
        Some(("values", message))
    } else {
        None
    }
}

fn problem_of_distribution(axis: &Axis) -> Option<(&'static str, String)> {
    if let Some([low, high]) = axis.range.filter(|[low, high]| low >= high) {
        let message = format!("range is [{low}, {high}], expected the lower number first");
        Some(("range", message))
    } else if let Some([low, _]) = axis.range.filter(|[low, _]| axis.log && *low <= 0.0) {
        let message = format!("range begins at {low}, expected more than 0 with log");
        Some(("range", message))
    } else if axis.log && axis.range.is_none() {
        let message = "log is given without range, which it requires".to_owned();
        Some(("log", message))
    } else if let Some([_, sigma]) = axis.normal.filter(|[_, sigma]| *sigma <= 0.0) {
        let message = format!("normal has a deviation of {sigma}, expected more than 0");
        Some(("normal", message))
    } else {
        let is_bad = |[median, sigma]: &[f64; 2]| {
            *median <= 0.0 || !(0.0..=10.0).contains(sigma) || *sigma == 0.0
        };
        axis.log_normal.filter(is_bad).map(|pair| {
            let message = format!(
                "log_normal is {pair:?}, expected a median above 0 and a deviation above 0 and at most 10"
            );
            ("log_normal", message)
        })
    }
}
