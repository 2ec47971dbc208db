//! The file of a recording: created exclusively, so that no two programs record to the same one.

use crate::{RecordError, utc};
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

/// Maximum number of recordings with the same name.
const NAMES_MAX: u32 = 1000;
/// Minimum free space on disk, bytes.
const SPACE_MIN: usize = 1 << 16;

/// A new file for a recording. Dropping it unused removes the file.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    /// `None` after use.
    pub(crate) file: Option<File>,
    /// Whether a different process created the file and will remove it if it stays empty.
    is_lent: bool,
}

/// A new file to which a child process records. Dropping it removes the file if it is empty.
#[derive(Debug)]
pub struct LentFile(PathBuf);

/// The name of a game's recording without extension: time, game and seed.
pub fn stem(game: &str, seed: u64) -> String {
    format!("{}_{game}_{seed}", utc::file_stamp(utc::now_ns()))
}

impl NewFile {
    /// Creates the file; never overwrites an existing one.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be created, or the disk is full.
    pub fn create(path: &Path) -> Result<NewFile, RecordError> {
        let mut file = File::create_new(path)?;
        // If a later step fails, dropping `new` removes the file.
        let new = NewFile {
            path: path.to_owned(),
            file: Some(file.try_clone()?),
            is_lent: false,
        };
        file.write_all(&[0; SPACE_MIN])?;
        file.rewind()?;
        file.set_len(0)?;
        Ok(new)
    }

    /// Writes a complete recording, and returns its path.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be written.
    pub fn fill(mut self, bytes: &[u8]) -> Result<PathBuf, RecordError> {
        if let Some(file) = &mut self.file {
            file.write_all(bytes)?;
        }
        self.file = None;
        Ok(self.path.clone())
    }

    /// Creates a file with this name in a folder; adds a number if the name is taken.
    ///
    /// # Errors
    /// As for [`NewFile::create`].
    pub fn create_numbered(folder: &Path, stem: &str) -> Result<NewFile, RecordError> {
        // Creating the file reserves its name. If the name were only checked, another program could
        // create it in the meantime.
        let mut created = NewFile::create(&folder.join(format!("{stem}.mcap")));
        for number in 2..=NAMES_MAX {
            match created {
                Err(RecordError::File(e)) if e.kind() == ErrorKind::AlreadyExists => {}
                other => return other,
            }
            created = NewFile::create(&folder.join(format!("{stem}_{number}.mcap")));
        }
        created
    }

    /// The file for a child process: an empty one lent by its parent, or else a new one.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be opened or created, or is not empty.
    pub fn of_child(path: &Path) -> Result<NewFile, RecordError> {
        let file = match OpenOptions::new().write(true).open(path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return NewFile::create(path),
            opened => opened?,
        };
        if file.metadata()?.len() > 0 {
            return Err(Error::from(ErrorKind::AlreadyExists).into());
        }
        Ok(NewFile {
            path: path.to_owned(),
            file: Some(file),
            is_lent: true,
        })
    }

    /// Lends the file to a child process.
    pub fn lend(mut self) -> LentFile {
        self.file = None;
        LentFile(std::mem::take(&mut self.path))
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        // If this fails, an unfinished file remains.
        match &self.file {
            // Only the lender removes the file: by now the name may belong to a different program.
            Some(file) if self.is_lent => drop(file.set_len(0)),
            Some(_) => drop(std::fs::remove_file(&self.path)),
            None => {}
        }
    }
}

impl LentFile {
    /// Its path.
    pub fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for LentFile {
    fn drop(&mut self) {
        if std::fs::metadata(&self.0).is_ok_and(|about| about.len() == 0) {
            // If removal fails, an empty file remains.
            drop(std::fs::remove_file(&self.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_recording_has_a_file_of_its_own_and_an_unused_one_is_removed() {
        let folder = tempfile::tempdir().expect("a folder");
        let stem = stem("strategy_4_vs_3", 7);
        assert!(stem.ends_with("_strategy_4_vs_3_7"), "{stem}");
        let create =
            |_| NewFile::create_numbered(folder.path(), &stem).unwrap_or_else(|e| panic!("{e}"));
        let files: Vec<NewFile> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..8).map(|i| scope.spawn(move || create(i))).collect();
            threads
                .into_iter()
                .map(|thread| thread.join().expect("no panic"))
                .collect()
        });
        let mut paths: Vec<PathBuf> = files.iter().map(|file| file.path().to_owned()).collect();
        paths.sort();
        paths.dedup();
        assert_eq!(paths.len(), 8, "{paths:?}");
        drop(files);
        assert!(paths.iter().all(|path| !path.exists()), "{paths:?}");
    }

    #[test]
    fn a_child_records_into_the_file_of_its_parent_and_nowhere_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("game.mcap");
        let lent = NewFile::create(&path)
            .unwrap_or_else(|e| panic!("{e}"))
            .lend();
        drop(NewFile::of_child(lent.path()).unwrap_or_else(|e| panic!("{e}")));
        assert!(path.exists(), "the parent removes it");
        drop(lent);
        assert!(!path.exists(), "nothing was recorded");
        std::fs::write(&path, "a recording").expect("it is written");
        assert!(NewFile::of_child(&path).is_err(), "nothing is overwritten");
        drop(LentFile(path.clone()));
        assert!(path.exists(), "something was recorded");
    }
}
