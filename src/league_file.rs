//! The folder of a league: the results of its games, which are only ever added to, and its newest report.

use crate::output_file;
use anyhow::{Context, Result, bail};
use experiment::tournament::{League, Plan, Record};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The results, a line a game.
const RESULTS: &str = "results.jsonl";
/// The largest results that are read, bytes: some four million games.
const BYTES_MAX: u64 = 2 << 30;

/// A league in its folder, which nobody else writes to meanwhile.
pub(crate) struct LeagueFile {
    folder: PathBuf,
    path: PathBuf,
    file: File,
    pub(crate) league: League,
    /// What could not be written.
    problem: Option<std::io::Error>,
}

impl LeagueFile {
    /// The league of a folder, which is made. A last line that was torn off is dropped.
    pub(crate) fn open(folder: &Path) -> Result<LeagueFile> {
        output_file::make_folder(folder)?;
        let path = folder.join(RESULTS);
        let what = || format!("no league in {}", path.display());
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(&path).with_context(what)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => bail!("another tournament writes to {} now", path.display()),
            Err(TryLockError::Error(error)) => return Err(error).with_context(what),
            Ok(()) => {}
        }
        let metadata = file.metadata().with_context(what)?;
        if !metadata.is_file() {
            bail!("{} is not a file", path.display());
        }
        let bytes = metadata.len();
        if bytes > BYTES_MAX {
            bail!("{} has {bytes} bytes, expected at most {BYTES_MAX}", path.display());
        }
        let mut text = String::new();
        file.read_to_string(&mut text).with_context(what)?;
        let league = League::parse(&text).with_context(what)?;
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        file.set_len(whole as u64).with_context(what)?;
        file.seek(SeekFrom::End(0)).with_context(what)?;
        Ok(LeagueFile { folder: folder.to_owned(), path, file, league, problem: None })
    }

    /// Adds a game; what cannot be written is told in the end.
    pub(crate) fn add(&mut self, plan: &Plan, pairings: &[String], record: &Record) {
        if self.problem.is_none() {
            self.problem = self.file.write_all(League::line(plan, pairings, record).as_bytes()).err();
        }
    }

    /// Where its newest report goes.
    pub(crate) fn report(&self) -> PathBuf {
        self.folder.join("report.json")
    }

    /// Whether all was written.
    pub(crate) fn end(self) -> Result<()> {
        match self.problem {
            Some(error) => Err(error).with_context(|| format!("cannot write to {}", self.path.display())),
            None => Ok(()),
        }
    }
}
