//! Where the recording of a game goes: files are named by the time, the game and its seed.

use crate::utc;
use std::path::{Path, PathBuf};

/// A file in this folder that is not there yet, for a game of this name and seed.
#[must_use]
pub fn free_path(folder: &Path, game: &str, seed: u64) -> PathBuf {
    let stem = format!("{}_{game}_{seed}", utc::file_stamp(utc::now_ns()));
    let mut path = folder.join(format!("{stem}.mcap"));
    let mut number = 2;
    while path.exists() {
        path = folder.join(format!("{stem}_{number}.mcap"));
        number += 1;
    }
    path
}
