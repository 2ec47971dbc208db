//! A journal of the games of a search, written as they are played. A resumed search, or another one
//! over the same sweep, does not repeat them.

use super::metric::{METRICS, Metrics};
use super::plan::{Job, Plan};
use super::play::play_jobs;
use super::study::{StudyError, io, text_if_any};
use super::table::{metrics_cells, metrics_in, record};
use crate::checksum::checksum;
use primitives::output_file;
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// The file name.
const NAME: &str = "search.csv";

/// Why a search failed.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// The axis is ambiguous.
    #[error("{0} axes are numeric; choose one with --along: {1}")]
    Axes(usize, String),
    /// A game cannot start.
    #[error("{0}")]
    Game(String),
    /// The journal cannot be written.
    #[error(transparent)]
    Journal(#[from] StudyError),
    /// The search was stopped.
    #[error("stopped before enough games were played")]
    Stopped,
}

/// The measurements of a game, or why it could not start.
type Outcome = Result<Metrics, String>;

/// The games of searches over one sweep, stored in a folder.
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Outcomes by identity of the game: see [`key`].
    known: BTreeMap<Vec<String>, Outcome>,
}

impl Journal {
    /// A new journal in a folder, which is created.
    ///
    /// # Errors
    /// [`StudyError`] if the file cannot be written or already contains games.
    pub fn begin(folder: &Path, plan: &Plan) -> Result<Journal, StudyError> {
        let path = folder.join(NAME);
        std::fs::create_dir_all(folder).map_err(io("create the folder", folder))?;
        let games = text_if_any(&path)?.lines().count().saturating_sub(1);
        if games > 0 {
            return Err(StudyError::Exists {
                folder: folder.to_owned(),
                games,
            });
        }
        output_file::write(&path, plan.digest() + "\n").map_err(io("write", &path))?;
        Journal::open(path, BTreeMap::new())
    }

    /// The journal of a folder with all its intact lines; games with torn or changed lines are
    /// played again.
    ///
    /// # Errors
    /// [`StudyError`] if the file is missing, cannot be read or written, or belongs to another
    /// sweep.
    pub fn resume(folder: &Path, plan: &Plan) -> Result<Journal, StudyError> {
        let path = folder.join(NAME);
        let text = text_if_any(&path)?;
        if text.is_empty() {
            return Err(StudyError::Missing {
                folder: folder.to_owned(),
            });
        }
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let (found, lines) = whole.split_once('\n').unwrap_or_default();
        if found != plan.digest() {
            let expected = plan.digest();
            let found = found.to_owned();
            return Err(StudyError::Other {
                folder: folder.to_owned(),
                expected,
                found,
            });
        }
        let file = OpenOptions::new()
            .write(true)
            .open(&path)
            .map_err(io("open", &path))?;
        file.set_len(whole.len() as u64).map_err(io("cut", &path))?;
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .from_reader(lines.as_bytes());
        Journal::open(
            path,
            reader
                .records()
                .filter_map(|line| game_of(&line.ok()?))
                .collect(),
        )
    }

    fn open(path: PathBuf, known: BTreeMap<Vec<String>, Outcome>) -> Result<Journal, StudyError> {
        let file = OpenOptions::new()
            .append(true)
            .open(&path)
            .map_err(io("open", &path))?;
        Ok(Journal { path, file, known })
    }

    /// The number of games in the journal.
    pub fn games(&self) -> usize {
        self.known.len()
    }

    /// The measurements of these games of a plan, in order; plays the missing ones.
    ///
    /// # Errors
    /// [`SearchError`] if a game cannot start, `stop` was set, or the file cannot be written.
    pub(crate) fn play(
        &mut self,
        plan: &Plan,
        order: &[Job],
        (threads, stop): (NonZeroUsize, &AtomicBool),
    ) -> Result<Vec<Metrics>, SearchError> {
        let keys: Vec<Vec<String>> = order.iter().map(|job| key(plan, job)).collect();
        let is_new = |(_, key): &(&Job, &Vec<String>)| !self.known.contains_key(*key);
        let new: Vec<Job> = order
            .iter()
            .zip(&keys)
            .filter(is_new)
            .map(|(job, _)| *job)
            .collect();
        play_jobs(plan, &new, threads, stop, |played| {
            let key = key(plan, &played.row.job);
            self.file
                .write_all(line_of(&key, &played.row.result).as_bytes())
                .map_err(io("write", &self.path))?;
            self.known.insert(key, played.row.result);
            Ok::<(), StudyError>(())
        })?;
        let outcome = |key: &Vec<String>| self.known.get(key).cloned().ok_or(SearchError::Stopped);
        let outcomes = keys
            .iter()
            .map(outcome)
            .collect::<Result<Vec<Outcome>, SearchError>>()?;
        outcomes
            .into_iter()
            .map(|outcome| outcome.map_err(SearchError::Game))
            .collect()
    }
}

/// The identity of a game: its entry, its seed, the entry's side and the values of the axes.
fn key(plan: &Plan, job: &Job) -> Vec<String> {
    let point = &plan.points()[job.point];
    let values = point.iter().map(super::AxisValue::toml);
    let first = [
        plan.sweep().entries[job.entry].name.clone(),
        job.seed.to_string(),
        job.side.to_string(),
    ];
    first.into_iter().chain(values).collect()
}

/// A line: its checksum, the measurements, the error if it could not start, and the game's
/// identity.
fn line_of(key: &[String], result: &Outcome) -> String {
    let why = result.as_ref().err().cloned().unwrap_or_default();
    let cells: Vec<String> = metrics_cells(result)
        .chain([why])
        .chain(key.iter().cloned())
        .collect();
    let sum = sum_of(cells.iter().map(String::as_str));
    record(std::iter::once(sum).chain(cells))
}

/// The checksum of the other cells of a line.
fn sum_of<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let cells: Vec<&str> = cells.collect();
    // The separator occurs in no cell.
    checksum(&cells.join("\u{1f}"))
}

/// The content of a line, if its checksum matches.
fn game_of(line: &csv::StringRecord) -> Option<(Vec<String>, Outcome)> {
    let mut cells = line.iter();
    let sum = cells.next()?;
    let line: csv::StringRecord = cells.collect();
    if sum != sum_of(line.iter()) {
        return None;
    }
    let why = line.get(METRICS.len())?;
    let result = if why.is_empty() {
        Ok(metrics_in(line.iter())?)
    } else {
        Err(why.to_owned())
    };
    Some((
        line.iter()
            .skip(METRICS.len() + 1)
            .map(str::to_owned)
            .collect(),
        result,
    ))
}
