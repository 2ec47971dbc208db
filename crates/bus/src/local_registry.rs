//! The games and gateways that run on this machine: a small file each, so that `list`, `watch` and `tell` find them unasked.
//!
//! It is only a convenience: a node that is told where to connect never looks here.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::Write;
use std::net::SocketAddr;
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

/// Where a gateway on this machine takes operator commands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GatewayEntry {
    /// The boat.
    pub vehicle: String,
    /// The game that it was told to join; without a name, the only one there is.
    pub game: Option<String>,
    /// Its control port.
    pub control: SocketAddr,
    /// The gateway's process.
    pub pid: u32,
    /// The game's token, for whoever may read the file: the same user.
    pub token: Option<String>,
}

/// The endings of the files: one for each kind of entry.
const GAMES: &str = "json";
const GATEWAYS: &str = "gateway";

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
        // `symlink_metadata`, so that a link that somebody else put into `/tmp` is not
        // followed. The files hold tokens.
        about.is_dir() && about.uid() == rustix::process::geteuid().as_raw() && about.mode() & 0o077 == 0
    })
}

/// Enters a game.
///
/// # Errors
/// If the file cannot be written, or others can read what is in its folder.
pub fn register(entry: &Entry) -> std::io::Result<Registration> {
    register_in(&folder(), &format!("{}-{}.{GAMES}", entry.game, entry.pid), entry)
}

/// Enters a gateway.
///
/// # Errors
/// As [`register`].
pub fn register_gateway(entry: &GatewayEntry) -> std::io::Result<Registration> {
    // The boat's name is not known to be fit for a file's; a process has one gateway.
    register_in(&folder(), &format!("{}.{GATEWAYS}", entry.pid), entry)
}

/// The folder of what runs on this machine, which nobody but this user can look into.
pub(crate) fn private_folder() -> std::io::Result<PathBuf> {
    let folder = folder();
    make_private(&folder)?;
    Ok(folder)
}

fn make_private(folder: &Path) -> std::io::Result<()> {
    fs::DirBuilder::new().recursive(true).mode(0o700).create(folder)?;
    if !is_private(folder) {
        let problem = format!("{} is open to others, expected a folder of mode 700 of this user", folder.display());
        return Err(std::io::Error::other(problem));
    }
    Ok(())
}

fn register_in<E: Serialize>(folder: &Path, name: &str, entry: &E) -> std::io::Result<Registration> {
    make_private(folder)?;
    let registration = Registration(folder.join(name));
    registration.write(entry)?;
    Ok(registration)
}

impl Registration {
    /// From now on the gateway is entered like this.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn update(&self, entry: &GatewayEntry) -> std::io::Result<()> {
        self.write(entry)
    }

    /// Whoever reads meanwhile finds the entry of before.
    fn write<E: Serialize>(&self, entry: &E) -> std::io::Result<()> {
        let unfinished = self.0.with_added_extension("new");
        let mut file = fs::OpenOptions::new().write(true).create(true).truncate(true).mode(0o600).open(&unfinished)?;
        file.write_all(&serde_json::to_vec(entry)?)?;
        // Renamed when it is complete: others read the folder at any time, and half a file
        // would be no game.
        fs::rename(&unfinished, &self.0)
    }
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
    let mut entries: Vec<Entry> = list_in(&folder(), GAMES);
    entries.sort_by(|a, b| (&a.game, a.pid).cmp(&(&b.game, b.pid)));
    entries
}

/// All gateways whose process still runs, by boat; entries of dead processes are removed.
#[must_use]
pub fn gateways() -> Vec<GatewayEntry> {
    let mut entries: Vec<GatewayEntry> = list_in(&folder(), GATEWAYS);
    entries.sort_by(|a, b| (&a.vehicle, a.pid).cmp(&(&b.vehicle, b.pid)));
    entries
}

fn list_in<E: DeserializeOwned>(folder: &Path, kind: &str) -> Vec<E> {
    // Where others can write, they could send us to a game of theirs.
    let files = is_private(folder).then(|| fs::read_dir(folder).ok()).flatten();
    let files = files.into_iter().flatten().flatten().map(|file| file.path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == kind));
    files.filter_map(|path| live_entry(&path)).collect()
}

/// What every entry has.
#[derive(Deserialize)]
struct Process {
    pid: u32,
}

/// An entry is some hundred bytes.
const ENTRY_MAX: u64 = 1 << 16;

fn live_entry<E: DeserializeOwned>(path: &Path) -> Option<E> {
    let json = primitives::input_file::read(path, ENTRY_MAX).ok()?;
    let Process { pid } = serde_json::from_slice(&json).ok()?;
    // Where there is no /proc we cannot tell, and believe the file.
    let dead = Path::new("/proc/self").exists() && !Path::new(&format!("/proc/{pid}")).exists();
    if dead {
        // A process that was killed leaves its file behind; whoever finds it tidies up.
        drop(fs::remove_file(path));
        return None;
    }
    serde_json::from_slice(&json).ok()
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
        let registration = register_in(&dir, "a.json", &entry).expect("a folder");
        let gateway = GatewayEntry {
            vehicle: "../blue_one".to_owned(),
            game: None,
            control: "127.0.0.1:7001".parse().expect("an address"),
            pid: std::process::id(),
            token: None,
        };
        let dead = GatewayEntry { pid: u32::MAX, ..gateway.clone() };
        let gateways = [("b.gateway", &gateway), ("c.gateway", &dead)];
        let gateways = gateways.map(|(name, entry)| register_in(&dir, name, entry).expect("a folder"));
        let mode = fs::metadata(&registration.0).expect("a file").mode();
        assert_eq!(mode & 0o777, 0o600, "{mode:o}");
        assert_eq!(list_in::<Entry>(&dir, GAMES), std::slice::from_ref(&entry));
        assert_eq!(list_in::<GatewayEntry>(&dir, GATEWAYS), std::slice::from_ref(&gateway), "one of two runs");
        assert!(!gateways[1].0.exists(), "it is dead");
        let renewed = GatewayEntry { token: Some("another".to_owned()), ..gateway };
        gateways[0].update(&renewed).expect("it is ours");
        assert_eq!(list_in::<GatewayEntry>(&dir, GATEWAYS), [renewed]);
        fs::set_permissions(&dir, fs::Permissions::from_mode(0o777)).expect("it is ours");
        assert_eq!(list_in::<Entry>(&dir, GAMES), [], "anybody could have written it");
        assert!(register_in(&dir, "a.json", &entry).is_err(), "anybody could read it");
        drop((registration, gateways));
        fs::remove_dir(&dir).expect("it is empty");
    }
}
