//! Files of which a person saves one, and then sees what comes of it.

use crate::stop;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

/// When a file was written, and its size; none where it is not there.
type Stamp = Option<(SystemTime, u64)>;

/// Files as they were at one moment.
pub(crate) struct WatchedFiles(Vec<(PathBuf, Stamp)>);

impl WatchedFiles {
    /// These files as they are now.
    pub(crate) fn new(paths: impl IntoIterator<Item = PathBuf>) -> WatchedFiles {
        WatchedFiles(paths.into_iter().map(|path| (path.clone(), stamp(&path))).collect())
    }

    /// Waits for one of them to be another than it was; none if the flag is set before.
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
