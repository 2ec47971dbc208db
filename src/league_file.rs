//! A league's folder: an append-only file of game results, and the latest report.

use crate::output_file;
use anyhow::{Context, Result, bail};
use experiment::tournament::{League, Plan, Record};
use primitives::input_file::{self, TABLE_BYTES_MAX};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

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
