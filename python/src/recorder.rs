//! Records the games of an environment into a folder, each under the time, its name and its seed.

use learn::environment::{RecordingLog, RecordingNames, Recordings, Watches, check_recording_folder};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Records each `every`th game into this folder.
pub(crate) fn watches(folder: PathBuf, every: u64, log: Arc<RecordingLog>) -> Watches {
    Recordings { folder, names: RecordingNames::ByTime, every, commit: "unknown".to_owned() }.watches(log)
}

/// Whether a folder takes files, which it is made for where it is not there.
pub(crate) fn check_folder(folder: &Path) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("record is {folder:?}, expected a folder for recordings: {error}");
    check_recording_folder(folder).map_err(wrong)
}
