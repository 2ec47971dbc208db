//! The files from which scenarios are read: on disk, each read once, or stored copies.

use super::built_in::{built_in, note_override};
use super::entry;
use primitives::input_file;
use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The files from which scenarios are read, with built-in files in place of missing ones. Each file
/// is read only once, for consistency.
#[derive(Debug, Default)]
pub struct Files {
    read: Mutex<Read>,
    /// Whether all files are stored, so that none is read from disk.
    is_complete: bool,
}

/// The files read so far.
#[derive(Debug, Default)]
struct Read {
    /// In order of first request.
    files: Vec<(PathBuf, Arc<[u8]>)>,
    /// Index of each file in `files`.
    places: BTreeMap<PathBuf, usize>,
}

impl Read {
    fn add(&mut self, path: PathBuf, bytes: Arc<[u8]>) {
        self.places.insert(path.clone(), self.files.len());
        self.files.push((path, bytes));
    }
}

impl Files {
    /// Uses only these files, without access to the disk.
    pub fn kept(files: Vec<(PathBuf, Vec<u8>)>) -> Files {
        let mut read = Read::default();
        files
            .into_iter()
            .for_each(|(path, bytes)| read.add(path, bytes.into()));
        Files {
            read: Mutex::new(read),
            is_complete: true,
        }
    }

    /// Whether these are stored copies, which may come from a different process.
    pub(super) fn is_stored(&self) -> bool {
        self.is_complete
    }

    /// The files read so far, in order of first request.
    pub fn list(&self) -> Vec<(PathBuf, Arc<[u8]>)> {
        let read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.files.clone()
    }

    /// Reads a file of at most `bytes_max` bytes.
    pub(super) fn read(&self, path: &Path, bytes_max: u64) -> Result<Arc<[u8]>, String> {
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(&place) = read.places.get(path) {
            return Ok(Arc::clone(&read.files[place].1));
        }
        if self.is_complete {
            return Err("it is not among the stored files".to_owned());
        }
        let bytes: Arc<[u8]> = match (input_file::read(path, bytes_max), built_in(path)) {
            (Ok(bytes), built_in) => {
                built_in
                    .into_iter()
                    .for_each(|built_in| note_override(path, &bytes, built_in));
                bytes.into()
            }
            // A file on disk always takes precedence, and built-in names work in any folder.
            // Unpacking the built-in files into a user's folder would leave outdated copies behind.
            (Err(error), Some(bytes)) if error.kind() == ErrorKind::NotFound => bytes.into(),
            (Err(error), None) => match entry::strategy(path) {
                Some(text) => text.into_bytes().into(),
                None if error.kind() == ErrorKind::NotFound => {
                    return Err("no such file".to_owned());
                }
                None => return Err(error.to_string()),
            },
            (Err(error), _) => return Err(error.to_string()),
        };
        read.add(path.to_owned(), Arc::clone(&bytes));
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_once_and_kept_files_are_all_there_are() {
        let dir = tempfile::tempdir().expect("a directory");
        let [first, second] = ["b", "a"].map(|name| dir.path().join(name));
        std::fs::write(&first, "1").expect("it is written");
        std::fs::write(&second, "2").expect("it is written");
        let files = Files::default();
        assert!(files.read(&dir.path().join("none"), 9).is_err());
        for path in [&first, &second, &first] {
            files.read(path, 9).expect("it is there");
            std::fs::write(path, "changed").expect("it is written");
        }
        let list = files.list();
        let read: Vec<(&Path, &[u8])> = list
            .iter()
            .map(|(path, bytes)| (path.as_path(), &**bytes))
            .collect();
        assert_eq!(
            read,
            [(first.as_path(), &b"1"[..]), (second.as_path(), b"2")]
        );
        let kept = Files::kept(vec![(first.clone(), b"kept".to_vec())]);
        assert_eq!(&*kept.read(&first, 9).expect("it is kept"), b"kept");
        assert_eq!(
            kept.read(&second, 9),
            Err("it is not among the stored files".to_owned())
        );
    }
}
