//! The games that run on this machine: a small file each, so that `list` and `watch` find them unasked.
//!
//! It is only a convenience: a node that is told where to connect never looks here.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
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
    /// The game's token, for whoever may read the file: the same user.
    pub token: Option<String>,
}

/// An entry that lasts as long as this is kept.
pub struct Registration(PathBuf);

fn folder() -> PathBuf {
    match std::env::var_os("XDG_RUNTIME_DIR") {
        Some(dir) => Path::new(&dir).join("squall"),
        None => std::env::temp_dir().join(format!("squall-{}", rustix::process::geteuid().as_raw())),
    }
}

/// Whether nobody but this user can have put something into the folder, or can read what is there.
fn is_private(folder: &Path) -> bool {
    fs::symlink_metadata(folder).is_ok_and(|about| {
        about.is_dir() && about.uid() == rustix::process::geteuid().as_raw() && about.mode() & 0o077 == 0
    })
}

/// Enters a game.
///
/// # Errors
/// If the file cannot be written, or others can read what is in its folder.
pub fn register(entry: &Entry) -> std::io::Result<Registration> {
    register_in(&folder(), entry)
}

fn register_in(folder: &Path, entry: &Entry) -> std::io::Result<Registration> {
    fs::DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    if !is_private(folder) {
        let problem = format!("{} is open to others, expected a folder of mode 700 of this user", folder.display());
        return Err(std::io::Error::other(problem));
    }
    let path = folder.join(format!("{}-{}.json", entry.game, entry.pid));
    let mut file = fs::OpenOptions::new().write(true).create(true).truncate(true).mode(0o600).open(&path)?;
    file.write_all(&serde_json::to_vec(entry)?)?;
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
    list_in(&folder())
}

fn list_in(folder: &Path) -> Vec<Entry> {
    // Where others can write, they could send us to a game of theirs.
    let files = is_private(folder).then(|| fs::read_dir(folder).ok()).flatten();
    let files = files.into_iter().flatten().flatten().map(|file| file.path());
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    #[test]
    fn an_entry_is_for_this_user_alone() {
        let dir = std::env::temp_dir().join(format!("squall-registry-test-{}", std::process::id()));
        let entry = Entry {
            game: "pav01".to_owned(),
            endpoint: "tcp/127.0.0.1:7447".to_owned(),
            pid: std::process::id(),
            token: Some("secret".to_owned()),
        };
        let registration = register_in(&dir, &entry).expect("a folder");
        let mode = fs::metadata(&registration.0).expect("a file").mode();
        assert_eq!(mode & 0o777, 0o600, "{mode:o}");
        assert_eq!(list_in(&dir), std::slice::from_ref(&entry));
        fs::set_permissions(&dir, fs::Permissions::from_mode(0o777)).expect("it is ours");
        assert_eq!(list_in(&dir), [], "anybody could have written it");
        assert!(register_in(&dir, &entry).is_err(), "anybody could read it");
        drop(registration);
        fs::remove_dir(&dir).expect("it is empty");
    }
}
