//! Watches files for changes, so that users see the effect of saving a file.

use crate::stop;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

/// A file's modification time and size; `None` if it does not exist.
type Stamp = Option<(SystemTime, u64)>;

/// The stamps of files at one moment.
pub(crate) struct WatchedFiles(Vec<(PathBuf, Stamp)>);

impl WatchedFiles {
    /// Records the current stamps of these files.
    pub(crate) fn new(paths: impl IntoIterator<Item = PathBuf>) -> WatchedFiles {
        WatchedFiles(
            paths
                .into_iter()
                .map(|path| (path.clone(), stamp(&path)))
                .collect(),
        )
    }

    /// Waits until one of the files changes; returns `None` if `stop` is set first.
    pub(crate) fn wait(&self, stop: &AtomicBool) -> Option<&Path> {
        while !stop::is_set_soon(stop) {
            if let Some((path, _)) = self.0.iter().find(|(path, before)| stamp(path) != *before) {
                return Some(path);
            }
        }
        None
    }
}

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}
