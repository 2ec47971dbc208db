//! A sweep file and the files it names, checked. What the values of its axes make of the game is seen where that is read.

use super::StrategyFiles;
use crate::diagnostics::Diagnostics;
use crate::read::Document;
use crate::{Axis, AxisValue, Scenario, Sweep};
use std::collections::BTreeSet;
use std::path::Path;

/// Checks a sweep.
pub(crate) fn sweep(diagnostics: &mut Diagnostics, document: &Document<Sweep>) -> Option<Sweep> {
    let mut sweep = document.raw.clone();
    sweep.path = diagnostics.sources.problem(document.at(""), String::new()).path;
    diagnostics.referenced::<Scenario, _>(document, "game", &sweep.game);
    sweep.game = diagnostics.resolve(document.at("game"), &sweep.game);
    let mut strategies = StrategyFiles::default();
    sweep.opponent = strategies.read(diagnostics, document, "opponent", &sweep.opponent);
    let mut names = BTreeSet::new();
    for (i, entry) in sweep.entries.iter_mut().enumerate() {
        let name_path = format!("entry.{i}.name");
        entry.strategy = strategies.read(diagnostics, document, &format!("entry.{i}.strategy"), &entry.strategy);
        if document.is_sound(&name_path) && !names.insert(&entry.name) {
            let message = format!("name is {:?} again, expected a different one for each entry", entry.name);
            diagnostics.note(document.at(&name_path), message);
        }
    }
    let mut keys = BTreeSet::new();
    for (i, axis) in sweep.axes.iter_mut().enumerate() {
        let at = format!("axis.{i}");
        let key_at = document.at(&format!("{at}.key"));
        let place = diagnostics.sources.problem(key_at, String::new());
        axis.place = (place.line, place.column);
        if document.is_sound(&at) {
            check_axis(diagnostics, document, &at, axis);
            if !keys.insert(axis.key.clone()) {
                diagnostics
                    .note(key_at, format!("key is {:?} again, expected a different one for each axis", axis.key));
            }
        }
    }
    document.is_faultless(diagnostics).then_some(sweep)
}

fn check_axis(diagnostics: &mut Diagnostics, document: &Document<Sweep>, at: &str, axis: &Axis) {
    let place = |key: &str| document.at(&format!("{at}.{key}"));
    let given: Vec<&str> = ["values", "range", "normal", "log_normal"]
        .into_iter()
        .filter(|key| document.has(&format!("{at}.{key}")))
        .collect();
    let sort = |value: &AxisValue| std::mem::discriminant(value);
    let wrong = |key: &str, message: String| Some((place(key), message));
    let files = || "files as values, as in values = [\"../seas/calm.toml\"]";
    let problem = if !axis.is_of_files()
        && let Err(error) = axis.setting("team", &AxisValue::Number(0.0), Path::new(""))
    {
        wrong("key", format!("key is {:?}, expected sea, boat, rules, field or opponent, or more: {error}", axis.key))
    } else if given.len() != 1 {
        let found = if given.is_empty() { "none".to_owned() } else { given.join(" and ") };
        wrong("key", format!("{} has {found}, expected one of values, range, normal, log_normal", axis.key))
    } else if axis.is_of_files() && !axis.values.iter().all(|value| matches!(value, AxisValue::Text(_))) {
        wrong("values", format!("values of {} are not files, expected {}", axis.key, files()))
    } else if axis.is_of_files() && axis.values.is_empty() {
        wrong(given[0], format!("{} has no values, expected {}", axis.key, files()))
    } else if axis.values.is_empty() && given[0] == "values" {
        wrong("values", format!("{} has no values, expected one at least", axis.key))
    } else if axis.values.windows(2).any(|pair| sort(&pair[0]) != sort(&pair[1])) {
        wrong("values", format!("values of {} are of different sorts, expected all numbers or all texts", axis.key))
    } else if axis.values.iter().enumerate().any(|(k, value)| axis.values[..k].contains(value)) {
        wrong("values", format!("values of {} has one twice, expected different ones", axis.key))
    } else if let Some([low, high]) = axis.range.filter(|[low, high]| low >= high) {
        wrong("range", format!("range is [{low}, {high}], expected the lower number first"))
    } else if let Some([low, _]) = axis.range.filter(|[low, _]| axis.log && *low <= 0.0) {
        wrong("range", format!("range begins at {low}, expected more than 0 with log"))
    } else if axis.log && axis.range.is_none() {
        wrong("log", "log is given without range, expected with it only".to_owned())
    } else if let Some([_, sigma]) = axis.normal.filter(|[_, sigma]| *sigma <= 0.0) {
        wrong("normal", format!("normal has a deviation of {sigma}, expected more than 0"))
    } else if let Some(pair) =
        axis.log_normal.filter(|[median, sigma]| *median <= 0.0 || !(0.0..=10.0).contains(sigma) || *sigma == 0.0)
    {
        wrong("log_normal", format!("log_normal is {pair:?}, expected a median above 0 and a deviation of at most 10"))
    } else {
        None
    };
    if let Some((at, message)) = problem {
        diagnostics.note(at, message);
    }
}
