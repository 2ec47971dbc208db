//! Numbers that are drawn anew for every game: where a file gives a distribution instead of a number.
//!
//! A distribution is replaced by a number before the file is checked, so that all the rest of a scenario knows numbers
//! only. Files with distributions are checked at both ends of them as well: what passes there will not be refused in
//! the middle of a campaign.

use super::diagnostics::Diagnostics;
use super::overrides::Overrides;
use crate::stream::Stream;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Normal and log-normal numbers lie within this many standard deviations: they are drawn until they do.
const WITHIN_SIGMA: f64 = 3.0;

/// A number that was drawn for a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Whose and which: the vehicle, `sea`, `link` or `sharing`, and the key, as in `blue_one/hull.mass_kg`.
    pub parameter: String,
    /// The number, in the file's unit.
    pub value: f64,
}

/// All that is needed to draw a game again under another seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    /// The game file.
    pub(super) game: PathBuf,
    /// The files that take the place of the game's own.
    pub(super) overrides: Overrides,
    /// Every file, as read.
    pub(super) files: Vec<(PathBuf, String)>,
    /// The seed that the numbers at hand were drawn with.
    pub(super) seed: Option<u64>,
}

/// Which numbers are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawing {
    /// The least of each distribution.
    Least,
    /// The greatest of each.
    Greatest,
    /// Those of the game with this seed.
    Seed(u64),
}

/// Where distributions may stand in a kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawable {
    /// Nowhere.
    Nothing,
    /// In this table.
    Table(&'static str),
    /// Everywhere.
    Everything,
}

#[derive(Clone, Debug, PartialEq)]
enum Distribution {
    Uniform(f64, f64),
    Normal(f64, f64),
    LogNormal(f64, f64),
    Choice(Vec<f64>),
}

/// The numbers, as text, that take the place of the distributions in `table`, in the order of [`put`].
pub(super) fn numbers(
    diagnostics: &mut Diagnostics,
    table: &DeTable<'_>,
    drawable: Drawable,
    owner: &str,
) -> Vec<String> {
    let mut found = vec![];
    match drawable {
        Drawable::Nothing => {}
        Drawable::Everything => in_table(diagnostics, table, owner, "", &mut found),
        Drawable::Table(key) => {
            if let Some(DeValue::Table(inner)) = table.get(key).map(Spanned::get_ref) {
                in_table(diagnostics, inner, key, "", &mut found);
            }
        }
    }
    found
}

/// Puts numbers in the places of the distributions.
pub(super) fn put<'i>(table: &mut DeTable<'i>, drawable: Drawable, numbers: &'i [String]) {
    let mut numbers = numbers.iter();
    match drawable {
        Drawable::Nothing => {}
        Drawable::Everything => table.iter_mut().for_each(|(_, value)| put_in(value.get_mut(), &mut numbers)),
        Drawable::Table(key) => {
            if let Some(inner) = table.get_mut(key) {
                put_in(inner.get_mut(), &mut numbers);
            }
        }
    }
}

fn put_in<'i>(value: &mut DeValue<'i>, numbers: &mut std::slice::Iter<'i, String>) {
    match value {
        DeValue::Table(table) if kind_of(table).is_some() => {
            // Rust writes the shortest text that reads back to the same number, and TOML reads it likewise.
            let number = numbers.next().and_then(|text| DeValue::parse(text).ok());
            *value = number.expect("a number for each distribution").into_inner();
        }
        DeValue::Table(table) => table.iter_mut().for_each(|(_, value)| put_in(value.get_mut(), numbers)),
        DeValue::Array(array) => array.iter_mut().for_each(|value| put_in(value.get_mut(), numbers)),
        _ => {}
    }
}

fn in_table(diagnostics: &mut Diagnostics, table: &DeTable<'_>, owner: &str, path: &str, found: &mut Vec<String>) {
    for (key, value) in table.iter() {
        let dot = if path.is_empty() { "" } else { "." };
        in_value(diagnostics, value, owner, &format!("{path}{dot}{}", key.get_ref()), found);
    }
}

fn in_value(
    diagnostics: &mut Diagnostics,
    value: &Spanned<DeValue<'_>>,
    owner: &str,
    path: &str,
    found: &mut Vec<String>,
) {
    match value.get_ref() {
        DeValue::Table(table) => match kind_of(table) {
            Some(kind) => {
                let number =
                    distribution(diagnostics, table, kind, value.span().start, path).map_or(0.0, |distribution| {
                        let value = distribution.number(diagnostics.drawing, owner, path);
                        diagnostics.drawn.push(Drawn { parameter: format!("{owner}/{path}"), value });
                        value
                    });
                found.push(written(number));
            }
            None => in_table(diagnostics, table, owner, path, found),
        },
        DeValue::Array(array) => {
            for (i, value) in array.iter().enumerate() {
                in_value(diagnostics, value, owner, &format!("{path}.{i}"), found);
            }
        }
        _ => {}
    }
}

/// A number as a file would give it: whole ones without a point, for keys that take no others.
fn written(number: f64) -> String {
    // Up to here whole numbers are exact.
    let is_whole = number.fract() == 0.0 && number.abs() < 1e15;
    if is_whole { format!("{}", number as i64) } else { format!("{number:?}") }
}

/// The kind of distribution that a table means to be, if it does.
fn kind_of(table: &DeTable<'_>) -> Option<&'static str> {
    ["uniform", "normal", "log_normal", "choice"].into_iter().find(|kind| table.contains_key(*kind))
}

/// The distribution that a table is; a bad one is noted.
fn distribution(
    diagnostics: &mut Diagnostics,
    table: &DeTable<'_>,
    kind: &str,
    at: usize,
    path: &str,
) -> Option<Distribution> {
    let times = table.get("times").map_or(Some(1.0), |times| as_number(times.get_ref()));
    let numbers: Option<Vec<f64>> = match table.get(kind).map(Spanned::get_ref) {
        Some(DeValue::Array(array)) => array.iter().map(|value| as_number(value.get_ref())).collect(),
        _ => None,
    };
    let known = table.keys().all(|key| key.get_ref() == kind || key.get_ref() == "times");
    let found = numbers.zip(times).filter(|_| known).and_then(|(numbers, times)| of(kind, &numbers, times));
    if found.is_none() {
        let key = path.rsplit('.').next().unwrap_or(path);
        let message = format!(
            "{key} is no distribution, expected one of {{ uniform = [low, high] }}, {{ normal = [mean, sigma] }}, \
             {{ log_normal = [median, sigma] }} with a median above 0, {{ choice = [a, b, ...] }}; \
             and times = a factor, if wanted"
        );
        diagnostics.note(at, message);
    }
    found
}

fn as_number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|whole| whole as f64)
        }
        DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
        _ => None,
    };
    number.filter(|number| number.is_finite())
}

fn of(kind: &str, numbers: &[f64], times: f64) -> Option<Distribution> {
    let found = match (kind, numbers) {
        ("uniform", &[low, high]) if low <= high => {
            let (a, b) = (low * times, high * times);
            Distribution::Uniform(a.min(b), a.max(b))
        }
        ("normal", &[mean, sigma]) if sigma >= 0.0 => Distribution::Normal(mean * times, (sigma * times).abs()),
        ("log_normal", &[median, sigma]) if median * times > 0.0 && (0.0..=10.0).contains(&sigma) => {
            Distribution::LogNormal(median * times, sigma)
        }
        ("choice", choices) if !choices.is_empty() => {
            Distribution::Choice(choices.iter().map(|choice| choice * times).collect())
        }
        _ => return None,
    };
    Some(found)
}

impl Distribution {
    /// The number that is taken.
    fn number(&self, drawing: Drawing, owner: &str, path: &str) -> f64 {
        let end = match drawing {
            Drawing::Seed(seed) => return self.draw(&mut Stream::new(seed, &format!("draw/{owner}/{path}"))),
            Drawing::Least => -1.0,
            Drawing::Greatest => 1.0,
        };
        match self {
            Distribution::Uniform(low, high) => {
                if end < 0.0 {
                    *low
                } else {
                    *high
                }
            }
            Distribution::Normal(mean, sigma) => mean + end * WITHIN_SIGMA * sigma,
            Distribution::LogNormal(median, sigma) => median * libm::exp(end * WITHIN_SIGMA * sigma),
            Distribution::Choice(choices) => end * choices.iter().map(|x| end * x).fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn draw(&self, stream: &mut Stream) -> f64 {
        match self {
            Distribution::Uniform(low, high) => stream.between(*low, *high),
            Distribution::Normal(mean, sigma) => mean + sigma * within(stream),
            Distribution::LogNormal(median, sigma) => median * libm::exp(sigma * within(stream)),
            Distribution::Choice(choices) => choices[stream.below(choices.len() as u64) as usize],
        }
    }
}

/// A normal number of mean 0 and variance 1, drawn until it is within bounds.
fn within(stream: &mut Stream) -> f64 {
    loop {
        let number = stream.normal();
        if number.abs() <= WITHIN_SIGMA {
            return number;
        }
    }
}
