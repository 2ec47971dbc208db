//! The games that run on this machine: a small file each, so that `list` and `watch` find them unasked.
//!
//! It is only a convenience: a node that is told where to connect never looks here.

use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

/// Where a game on this machine can be reached.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// The game.
    pub game: String,
    /// Where its hub listens.
    pub endpoint: String,
    /// The sim's process.
    pub pid: u32,
}

/// An entry that lasts as long as this is kept.
pub struct Registration(PathBuf);

fn folder() -> PathBuf {
    let user = std::env::var("USER").unwrap_or_else(|_| "anyone".to_owned());
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(dir) => Path::new(&dir).join("squall"),
        None => std::env::temp_dir().join(format!("squall-{user}")),
    }
}

/// Enters a game.
///
/// # Errors
/// If the file cannot be written.
pub fn register(entry: &Entry) -> std::io::Result<Registration> {
    let folder = folder();
    fs::create_dir_all(&folder)?;
    let path = folder.join(format!("{}-{}.json", entry.game, entry.pid));
    fs::write(&path, serde_json::to_vec(entry)?)?;
    Ok(Registration(path))
}

impl Drop for Registration {
    fn drop(&mut self) {
        // Somebody may have tidied up before us.
        drop(fs::remove_file(&self.0));
    }
}

/// All entries whose process still runs, by game; entries of dead processes are removed.
#[must_use]
pub fn list() -> Vec<Entry> {
    let files = fs::read_dir(folder()).into_iter().flatten().flatten().map(|file| file.path());
    let mut entries: Vec<Entry> = files.filter_map(|path| live_entry(&path)).collect();
    entries.sort_by(|a, b| (&a.game, a.pid).cmp(&(&b.game, b.pid)));
    entries
}

fn live_entry(path: &Path) -> Option<Entry> {
    let entry: Entry = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    // Where there is no /proc we cannot tell, and believe the file.
    let dead = Path::new("/proc/self").exists() && !Path::new(&format!("/proc/{}", entry.pid)).exists();
    if dead {
        drop(fs::remove_file(path));
        return None;
    }
    Some(entry)
}
