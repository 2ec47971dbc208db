//! A training run's folder on the page: learning curves, evaluation results and recorded episodes.

use super::games::{Game, Games, Source};
use super::report::read;
use anyhow::{Context, Result, bail};
use scenario::argument_for;
use serde_json::{Value, json};
use shore::page::{Report, Shown};
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Maximum number of points of a curve; more would not be visible.
const POINTS_MAX: usize = 1000;
/// Maximum number of listed episodes; only the newest are listed.
const EPISODES_MAX: usize = 1000;
/// Columns of an update besides its samples and stage.
const UPDATES: [&str; 8] = [
    "reward",
    "policy_loss",
    "value_loss",
    "entropy",
    "divergence",
    "clipped",
    "epochs",
    "explained_variance",
];
/// Columns of an evaluation against an opponent.
const EVALUATIONS: [&str; 6] = [
    "won",
    "drawn",
    "lost",
    "points",
    "points_against",
    "left_field",
];
/// Columns that are missing in runs of earlier versions.
const NEWER: [&str; 2] = ["explained_variance", "best"];
const EPISODES: [&str; 3] = ["points", "points_against", "steps"];

/// The request path for a different run in the same folder, followed by its name in hexadecimal
/// digits.
const OTHER_RUN: &str = "/training_run/";
/// Maximum number of other runs listed.
const RUNS_MAX: usize = 500;

/// The page of a training run, which may still be running.
pub(super) struct TrainingReport {
    run: Run,
    games: Games,
}

/// The folder of a training run.
struct Run {
    folder: PathBuf,
    name: String,
    /// The strategy of the best policy, for a command line.
    strategy: String,
}

impl TrainingReport {
    /// Whether a folder contains a training run.
    pub(super) fn is_in(folder: &Path) -> bool {
        folder.join("updates.csv").exists()
    }

    /// Opens the training in a folder; its tables must be readable.
    pub(super) fn open(folder: &Path, games: Games) -> Result<TrainingReport> {
        let whole = std::fs::canonicalize(folder)
            .with_context(|| format!("cannot read {}", folder.display()))?;
        let run = Run::of(whole, folder);
        run.json()?;
        Ok(TrainingReport { run, games })
    }

    /// The other runs in the same folder.
    fn others(&self) -> Vec<Run> {
        let beside = self
            .run
            .folder
            .parent()
            .and_then(|parent| std::fs::read_dir(parent).ok());
        let folders = beside
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path());
        let is_other =
            |folder: &PathBuf| *folder != self.run.folder && TrainingReport::is_in(folder);
        let mut runs: Vec<Run> = folders
            .filter(is_other)
            .take(RUNS_MAX)
            .map(|folder| Run::of(folder.clone(), &folder))
            .collect();
        runs.sort_by(|a, b| a.name.cmp(&b.name));
        runs
    }

    /// The recording with this name in the folder of recordings; no other file is accepted.
    fn find(&self, name: &str) -> Result<Game> {
        let games = self.run.folder.join("games");
        let is_name =
            name.ends_with(".mcap") && Path::new(name).file_name().is_some_and(|own| own == name);
        let path = games.join(name);
        if !is_name || !path.is_file() {
            bail!("there is no recording {name:?} in {}", games.display());
        }
        let about = format!("an episode of the training {}, {name}", self.run.name);
        Ok(Game {
            about,
            source: Source::Recorded(path),
        })
    }
}

impl Run {
    /// The run in a folder. Printed commands refer to the folder as `shown`.
    fn of(folder: PathBuf, shown: &Path) -> Run {
        let name = folder
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        Run {
            folder,
            name,
            strategy: argument_for(&shown.join("best.toml")),
        }
    }

    fn id(&self) -> String {
        self.name
            .bytes()
            .map(|byte| format!("{byte:02x}"))
            .collect()
    }

    /// Whether the training is running; `None` if unknown.
    fn is_running(&self) -> Option<bool> {
        match File::open(self.folder.join("times.csv")).ok()?.try_lock() {
            Ok(()) => Some(false),
            Err(TryLockError::WouldBlock) => Some(true),
            Err(TryLockError::Error(_)) => None,
        }
    }

    /// The run's plan from `run.json`, with the command that plays its best policy; null for runs
    /// of earlier versions.
    fn plan(&self) -> Value {
        let read = || serde_json::from_slice(&read(&self.folder.join("run.json")).ok()?).ok();
        let mut plan: Value = read().unwrap_or_default();
        let sea = plan["sea"]
            .as_str()
            .map_or(String::new(), |sea| format!(" --sea {sea}"));
        if let Some(game) = plan["game"]
            .as_str()
            .filter(|_| self.folder.join("best.toml").exists())
        {
            plan["play"] = format!("squall run {game}{sea} --blue {}", self.strategy).into();
        }
        plan
    }

    fn json(&self) -> Result<Value> {
        let updates = self.table("updates.csv", &["stage"], &UPDATES)?;
        let evaluations = self.table(
            "evaluations.csv",
            &["stage", "opponent", "best"],
            &EVALUATIONS,
        )?;
        let mut episodes = self.table(
            "episodes.csv",
            &["stage", "seed", "opponent", "recording"],
            &EPISODES,
        )?;
        episodes.retain(|row| {
            row["recording"]
                .as_str()
                .is_some_and(|file| !file.is_empty())
        });
        let from = episodes.len().saturating_sub(EPISODES_MAX);
        let times = if self.folder.join("times.csv").exists() {
            self.table("times.csv", &[], &["elapsed_s"])?
        } else {
            vec![]
        };
        Ok(json!({
            "kind": "training",
            "name": self.name,
            "running": self.is_running(),
            "plan": self.plan(),
            "updates": thinned(updates),
            "times": thinned(times),
            "evaluations": evaluations,
            "episodes": episodes[from..],
        }))
    }

    /// The complete rows of a table, with strings and numbers (null for an empty cell).
    fn table(&self, name: &str, texts: &[&str], numbers: &[&str]) -> Result<Vec<Value>> {
        let path = self.folder.join(name);
        let bytes = read(&path)?;
        // The last line may be incomplete while being written.
        let whole = bytes
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |end| end + 1);
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .from_reader(&bytes[..whole]);
        let heads = reader
            .headers()
            .with_context(|| format!("{} is not a CSV table", path.display()))?
            .clone();
        let column = |name: &str| {
            let found = heads.iter().position(|head| head == name);
            if found.is_none() && NEWER.contains(&name) {
                return Ok(None);
            }
            found.map(Some).with_context(|| {
                format!(
                    "{} has no column {name}, expected the columns of a training run",
                    path.display()
                )
            })
        };
        let texts = texts
            .iter()
            .map(|name| Ok((*name, column(name)?)))
            .collect::<Result<Vec<_>>>()?;
        let numbers = ["samples"].iter().chain(numbers);
        let numbers = numbers
            .map(|name| Ok((*name, column(name)?)))
            .collect::<Result<Vec<_>>>()?;
        let mut rows = vec![];
        for (line, record) in reader.records().enumerate() {
            let at = || format!("{} line {}", path.display(), line + 2);
            let record = record.with_context(at)?;
            let cell = |column: usize| {
                record
                    .get(column)
                    .with_context(|| format!("{} is truncated", at()))
            };
            let mut row = serde_json::Map::new();
            for (name, column) in &texts {
                row.insert((*name).to_owned(), column.map(cell).transpose()?.into());
            }
            for (name, column) in &numbers {
                let cell = column.map_or(Ok(""), cell)?;
                row.insert(
                    (*name).to_owned(),
                    number(cell).with_context(|| format!("{}: {name}", at()))?,
                );
            }
            rows.push(Value::Object(row));
        }
        Ok(rows)
    }
}

/// At most about [`POINTS_MAX`] rows, including the last one.
fn thinned(rows: Vec<Value>) -> Vec<Value> {
    let step = rows.len().div_ceil(POINTS_MAX).max(1);
    let last = rows.len().saturating_sub(1);
    rows.into_iter()
        .enumerate()
        .filter(|(i, _)| i.is_multiple_of(step) || *i == last)
        .map(|(_, row)| row)
        .collect()
}

/// A numeric cell; null if empty.
fn number(cell: &str) -> Result<Value> {
    if cell.is_empty() {
        return Ok(Value::Null);
    }
    let number: f64 = cell
        .parse()
        .ok()
        .with_context(|| format!("found {cell:?}, expected a number"))?;
    Ok(number.into())
}

impl Report for TrainingReport {
    fn file(&self, path: &str) -> Option<Vec<u8>> {
        // If a table can no longer be read, show the error instead of the curves.
        let problem = |why: anyhow::Error| json!({"kind": "training", "problem": command_line::explain::line(&why)});
        let json = |run: &Run| run.json().unwrap_or_else(problem);
        let wanted = path
            .strip_prefix(OTHER_RUN)
            .and_then(|rest| rest.strip_suffix(".json"));
        let shown = match wanted {
            Some(id) => json(self.others().iter().find(|run| run.id() == id)?),
            None if path == "/report.json" => {
                let name = |run: &Run| json!({"id": run.id(), "name": run.name});
                let mut own = json(&self.run);
                own["runs"] = self.others().iter().map(name).collect();
                own
            }
            None => return None,
        };
        Some(shown.to_string().into_bytes())
    }

    fn game(&self, name: &str) -> Shown {
        self.games.show(name, || self.find(name))
    }
}
