//! A league's folder: an append-only file of game results, and the latest report.

use crate::output_file;
use anyhow::{Context, Result, bail};
use experiment::tournament::{League, Plan, Record};
use primitives::input_file::{self, TABLE_BYTES_MAX};
use scenario::strategy::{Behaviour, Task};
use scenario::{Scenario, digest_of};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The results, one line per game.
const RESULTS: &str = "results.jsonl";

/// A league in its folder, locked against other writers.
pub(crate) struct LeagueFile {
    folder: PathBuf,
    path: PathBuf,
    file: File,
    pub(crate) league: League,
    /// The first write error.
    problem: Option<std::io::Error>,
}

impl LeagueFile {
    /// Opens the league in a folder, which is created if missing. Drops a truncated last line.
    pub(crate) fn open(folder: &Path) -> Result<LeagueFile> {
        output_file::make_folder(folder)?;
        let path = folder.join(RESULTS);
        let what = || format!("cannot open the league {}", path.display());
        let file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(&path)
            .with_context(what)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                bail!("another tournament is writing to {}", path.display())
            }
            Err(TryLockError::Error(error)) => return Err(error).with_context(what),
            Ok(()) => {}
        }
        let text = input_file::read_text(&path, TABLE_BYTES_MAX).with_context(what)?;
        let league = League::parse(&text).with_context(what)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        file.set_len(whole as u64).with_context(what)?;
        Ok(LeagueFile {
            folder: folder.to_owned(),
            path,
            file,
            league,
            problem: None,
        })
    }

    /// Appends a game; `end` reports write errors.
    pub(crate) fn add(&mut self, plan: &Plan, pairings: &[String], record: &Record) {
        if self.problem.is_none() {
            self.problem = self
                .file
                .write_all(League::line(plan, pairings, record).as_bytes())
                .err();
        }
    }

    pub(crate) fn report(&self) -> PathBuf {
        self.folder.join("report.json")
    }

    /// Returns the first write error, if any.
    pub(crate) fn end(self) -> Result<()> {
        match self.problem {
            Some(error) => {
                Err(error).with_context(|| format!("cannot write to {}", self.path.display()))
            }
            None => Ok(()),
        }
    }
}

/// Identifies the games of each seed, as [`Plan::pairings`], and by the files of the competition
/// entries that play, which are not part of a scenario.
pub(crate) fn pairings(plan: &Plan) -> Result<Vec<String>> {
    let mut known = BTreeMap::new();
    let mut pairings = plan.pairings();
    for (place, pairing) in pairings.iter_mut().enumerate() {
        for host in hosts(plan.match_at(place).1) {
            if !known.contains_key(host) {
                known.insert(host.to_owned(), digest_of_entry(Path::new(host))?);
            }
            *pairing += &format!(" {}", known[host]);
        }
    }
    Ok(pairings)
}

/// The competition entries of a scenario: their folders or files.
fn hosts(scenario: &Scenario) -> BTreeSet<&str> {
    let roles = scenario.strategies.iter().flat_map(|one| &one.roles);
    let host = |behaviour| match behaviour {
        &Behaviour {
            task: Task::Policy(ref policy),
            ..
        } => policy.host.as_ref().map(|host| host.path.as_str()),
        _ => None,
    };
    roles
        .flat_map(|role| &role.behaviours)
        .filter_map(host)
        .collect()
}

/// The digest of all files of an entry, without Python's compiled ones.
fn digest_of_entry(entry: &Path) -> Result<String> {
    /// Maximum number of files.
    const FILES_MAX: usize = 10_000;
    let what = || format!("cannot read the entry {}", entry.display());
    let folder = if entry.is_file() {
        entry.parent().unwrap_or(entry)
    } else {
        entry
    };
    let mut folders = vec![folder.to_owned()];
    let mut files = BTreeMap::new();
    while let Some(folder) = folders.pop() {
        for found in std::fs::read_dir(&folder).with_context(what)? {
            let path = found.with_context(what)?.path();
            if path.is_file() {
                let bytes = input_file::read(&path, TABLE_BYTES_MAX).with_context(what)?;
                files.insert(path, Arc::from(bytes));
            } else if path.is_dir() && !path.is_symlink() && !path.ends_with("__pycache__") {
                folders.push(path);
            }
            if files.len() > FILES_MAX {
                bail!("{} has more than {FILES_MAX} files", entry.display());
            }
        }
    }
    Ok(digest_of("", &Vec::from_iter(files)))
}
