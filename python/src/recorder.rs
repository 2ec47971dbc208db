//! Records an environment's games to a folder, named by time, game and seed.

use learn::environment::{RecordingLog, RecordingNames, Recordings, Watches, check_recording_folder};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Watches that record every `every`th game to this folder.
pub(crate) fn watches(folder: PathBuf, every: u64, log: Arc<RecordingLog>) -> Watches {
    Recordings { folder, names: RecordingNames::ByTime, every, commit: "unknown".to_owned() }.watches(log)
}

/// Creates a folder if necessary, and checks that files can be written to it.
pub(crate) fn check_folder(folder: &Path) -> Result<(), String> {
    let wrong = |error: std::io::Error| format!("record is {folder:?}, expected a folder for recordings: {error}");
    check_recording_folder(folder).map_err(wrong)
}
