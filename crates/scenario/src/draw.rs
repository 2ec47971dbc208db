//! Randomised numbers: distributions in place of numbers in a file, drawn for every game.
//!
//! Reading a file replaces each distribution with a number, so that the rest of a scenario contains
//! only numbers. Files with distributions are checked at both ends of each distribution, so that
//! most faults are found before the first game.

use super::loader::{Basis, Loader};
use super::overrides::Overrides;
use super::tree::{Node, Table, Value};
use primitives::stream::Stream;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Normal and log-normal numbers are redrawn until they are within this many standard deviations.
const WITHIN_SIGMA: f64 = 3.0;

/// A number drawn for a game.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Owner and key, as in `blue_one/hull.mass_kg`; the owner is a vehicle, `sea`, `link`,
    /// `sharing` or `game`.
    pub parameter: String,
    /// The number, in the file's unit.
    pub value: f64,
}

/// The data for redrawing a game with a different seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    pub(super) game: PathBuf,
    pub(super) overrides: Overrides,
    /// Every file, as read.
    pub(super) files: Vec<(PathBuf, String)>,
    #[serde(skip)]
    pub(super) basis: Basis,
    /// The seed of the current numbers.
    pub(super) seed: Option<u64>,
}

/// The method of drawing numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Drawing {
    /// The minimum of each distribution.
    Least,
    /// The maximum of each distribution.
    Greatest,
    /// Random numbers for the game with this seed.
    Seed(u64),
}

/// The owner of drawn numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Owner<'a> {
    /// The vehicle, `sea`, or the shared table.
    pub(super) name: &'a str,
    /// The offset in a path at which the owner's part begins.
    pub(super) path_from: usize,
}

/// The kind of distribution that a table specifies, if any.
pub(super) fn distribution_kind(table: &Table) -> Option<&'static str> {
    ["uniform", "normal", "log_normal", "choice"]
        .into_iter()
        .find(|kind| table.contains_key(*kind))
}

/// The number drawn from the distribution at `path`, a whole one if `is_whole`; reports an invalid
/// distribution.
pub(super) fn draw(
    loader: &Loader,
    node: &Node,
    table: &Table,
    owner: &Owner<'_>,
    (path, is_whole): (&str, bool),
) -> Option<Value> {
    let path = path.get(owner.path_from..).unwrap_or_default();
    let stream = format!("draw/{}/{path}", owner.name);
    let Some(value) = number(table, loader.drawing, &stream, is_whole) else {
        let key = path.rsplit('.').next().unwrap_or(path);
        let message = format!(
            "{key} is not a valid distribution, expected one of {{ uniform = [low, high] }} with low < high, {{ normal = [mean, sigma] }}, \
             {{ log_normal = [median, sigma] }} with a median above 0, {{ choice = [a, b, ...] }}, \
             optionally with times = FACTOR"
        );
        loader.diagnostics.note(node.at, message);
        return None;
    };
    loader.drawn.borrow_mut().push(Drawn {
        parameter: format!("{}/{path}", owner.name),
        value,
    });
    // Whole numbers up to 1e15 are exact, and some keys accept only whole numbers.
    let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
    Some(if is_whole {
        Value::Whole(value as i64)
    } else {
        Value::Number(value)
    })
}

/// The number drawn from a distribution with this stream; `None` if the distribution is invalid.
fn number(table: &Table, drawing: Drawing, stream: &str, is_whole: bool) -> Option<f64> {
    let kind = distribution_kind(table)?;
    let finite = |node: &Node| node.as_number().filter(|number| number.is_finite());
    let Value::List(items) = &table[kind].value else {
        return None;
    };
    let numbers: Vec<f64> = items.iter().map(finite).collect::<Option<_>>()?;
    let times = table.get("times").map_or(Some(1.0), finite)?;
    if !table.keys().all(|key| key == kind || key == "times") {
        return None;
    }
    let stream = |seed: u64| Stream::new(seed, stream);
    let sigmas = || match drawing {
        Drawing::Least => -WITHIN_SIGMA,
        Drawing::Greatest => WITHIN_SIGMA,
        Drawing::Seed(seed) => within(&mut stream(seed)),
    };
    match (kind, numbers.as_slice()) {
        ("uniform", &[low, high]) if low <= high && is_whole => {
            let is_sound = times == 1.0 && low.fract() == 0.0 && high.fract() == 0.0;
            is_sound.then(|| match drawing {
                Drawing::Least => low,
                Drawing::Greatest => high,
                Drawing::Seed(seed) => low + stream(seed).below((high - low) as u64 + 1) as f64,
            })
        }
        ("uniform", &[low, high]) if low <= high => {
            let (low, high) = (
                (low * times).min(high * times),
                (low * times).max(high * times),
            );
            Some(match drawing {
                Drawing::Least => low,
                Drawing::Greatest => high,
                Drawing::Seed(seed) => stream(seed).between(low, high),
            })
        }
        ("normal", &[mean, sigma]) if sigma >= 0.0 => {
            Some(mean * times + sigmas() * (sigma * times).abs())
        }
        ("log_normal", &[median, sigma])
            if median * times > 0.0 && (0.0..=10.0).contains(&sigma) =>
        {
            Some(median * times * libm::exp(sigmas() * sigma))
        }
        ("choice", choices) => {
            let mut scaled = choices.iter().map(|choice| choice * times);
            match drawing {
                Drawing::Least => scaled.reduce(f64::min),
                Drawing::Greatest => scaled.reduce(f64::max),
                Drawing::Seed(seed) => {
                    scaled.nth(stream(seed).below(choices.len().max(1) as u64) as usize)
                }
            }
        }
        _ => None,
    }
}

/// A standard normal number, redrawn until it is within bounds.
fn within(stream: &mut Stream) -> f64 {
    loop {
        let number = stream.normal();
        if number.abs() <= WITHIN_SIGMA {
            return number;
        }
    }
}
