//! A training run's folder on the page: learning curves, evaluation results and recorded episodes.

use super::games::{Game, Games, Source};
use super::report::{PAGE, read};
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use shore::page::{Report, Shown};
use std::path::{Path, PathBuf};

/// Maximum points of a curve: more would not be visible.
const POINTS_MAX: usize = 1000;
/// Maximum number of listed episodes: the newest.
const EPISODES_MAX: usize = 1000;
/// Columns of an update besides its samples and stage.
const UPDATES: [&str; 7] = ["reward", "policy_loss", "value_loss", "entropy", "divergence", "clipped", "epochs"];
/// Columns of an evaluation against an opponent.
const EVALUATIONS: [&str; 6] = ["won", "drawn", "lost", "points", "points_against", "left_field"];
const EPISODES: [&str; 3] = ["points", "points_against", "steps"];

/// The folder of a training run, which may still be running.
pub(super) struct TrainingReport {
    folder: PathBuf,
    name: String,
    games: Games,
}

impl TrainingReport {
    /// Whether a folder contains a training run.
    pub(super) fn is_in(folder: &Path) -> bool {
        folder.join("updates.csv").exists()
    }

    /// Opens the training in a folder; its tables must be readable.
    pub(super) fn open(folder: &Path, games: Games) -> Result<TrainingReport> {
        let folder = std::fs::canonicalize(folder).with_context(|| format!("cannot read {}", folder.display()))?;
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let report = TrainingReport { folder, name, games };
        report.json()?;
        Ok(report)
    }

    fn json(&self) -> Result<Value> {
        let updates = self.table("updates.csv", &["stage"], &UPDATES)?;
        let evaluations = self.table("evaluations.csv", &["stage", "opponent"], &EVALUATIONS)?;
        let mut episodes = self.table("episodes.csv", &["stage", "seed", "opponent", "recording"], &EPISODES)?;
        episodes.retain(|row| row["recording"].as_str().is_some_and(|file| !file.is_empty()));
        let from = episodes.len().saturating_sub(EPISODES_MAX);
        let step = updates.len().div_ceil(POINTS_MAX).max(1);
        let last = updates.len().saturating_sub(1);
        let updates = updates.into_iter().enumerate().filter(|(i, _)| i.is_multiple_of(step) || *i == last);
        Ok(json!({
            "kind": "training",
            "name": self.name,
            "updates": updates.map(|(_, row)| row).collect::<Vec<_>>(),
            "evaluations": evaluations,
            "episodes": episodes[from..],
        }))
    }

    /// The complete rows of a table: texts, and numbers (null for an empty cell).
    fn table(&self, name: &str, texts: &[&str], numbers: &[&str]) -> Result<Vec<Value>> {
        let path = self.folder.join(name);
        let bytes = read(&path)?;
        // The last line may still be in the middle of being written.
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(&bytes[..whole]);
        let heads = reader.headers().with_context(|| format!("{} is not a CSV table", path.display()))?.clone();
        let column = |name: &str| {
            let found = heads.iter().position(|head| head == name);
            found.with_context(|| format!("{} has no column {name}, expected those of a training run", path.display()))
        };
        let texts = texts.iter().map(|name| Ok((*name, column(name)?))).collect::<Result<Vec<_>>>()?;
        let numbers = ["samples"].iter().chain(numbers);
        let numbers = numbers.map(|name| Ok((*name, column(name)?))).collect::<Result<Vec<_>>>()?;
        let mut rows = vec![];
        for (line, record) in reader.records().enumerate() {
            let at = || format!("{} line {}", path.display(), line + 2);
            let record = record.with_context(at)?;
            let cell = |column: usize| record.get(column).with_context(|| format!("{} is cut off", at()));
            let mut row = serde_json::Map::new();
            for (name, column) in &texts {
                row.insert((*name).to_owned(), cell(*column)?.into());
            }
            for (name, column) in &numbers {
                row.insert((*name).to_owned(), number(cell(*column)?).with_context(|| format!("{}: {name}", at()))?);
            }
            rows.push(Value::Object(row));
        }
        Ok(rows)
    }

    /// The recording with this name in the folder of recordings; no other file is accepted.
    fn find(&self, name: &str) -> Result<Game> {
        let games = self.folder.join("games");
        let is_name = name.ends_with(".mcap") && Path::new(name).file_name().is_some_and(|own| own == name);
        let path = games.join(name);
        if !is_name || !path.is_file() {
            bail!("there is no recording {name:?} in {}", games.display());
        }
        let about = format!("an episode of the training {}, {name}", self.name);
        Ok(Game { about, source: Source::Recorded(path) })
    }
}

/// A numeric cell; null if empty.
fn number(cell: &str) -> Result<Value> {
    if cell.is_empty() {
        return Ok(Value::Null);
    }
    let number: f64 = cell.parse().ok().with_context(|| format!("found {cell:?}, expected a number"))?;
    Ok(number.into())
}

impl Report for TrainingReport {
    fn page(&self) -> &'static str {
        PAGE
    }

    fn file(&self, path: &str) -> Option<Vec<u8>> {
        // If a table can no longer be read, show the error instead of the curves.
        let problem = |why: anyhow::Error| json!({"kind": "training", "problem": command_line::explain::line(&why)});
        (path == "/report.json").then(|| self.json().unwrap_or_else(problem).to_string().into_bytes())
    }

    fn game(&self, name: &str) -> Shown {
        self.games.show(name, || self.find(name))
    }
}
