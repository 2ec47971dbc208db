//! File names of recordings: time, game and seed.

use crate::utc;
use std::path::{Path, PathBuf};

/// An unused path in this folder for a game of this name and seed.
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

#[cfg(test)]
mod tests {
    use super::free_path;

    #[test]
    fn a_name_tells_the_game_and_its_seed_and_is_taken_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut names = Vec::new();
        for _ in 0..3 {
            let path = free_path(folder.path(), "strategy_4_vs_3", 7);
            std::fs::File::create_new(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            names.push(path.file_name().expect("a name").to_string_lossy().into_owned());
        }
        assert!(names.iter().all(|name| name.contains("_strategy_4_vs_3_7") && name.ends_with(".mcap")), "{names:?}");
    }
}
