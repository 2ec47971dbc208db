//! The games and gateways running on this machine, with one small file each: `list`, `watch` and
//! `tell` find them without an address.
//!
//! This is only a convenience: a node with a given address never reads it.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::net::SocketAddr;
use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// The way to reach a game on this machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Entry {
    /// The game's name.
    pub game: String,
    /// The endpoint of its hub.
    pub endpoint: String,
    /// Process number of the sim.
    pub pid: u32,
    /// The game's token, for processes of the same user, which may read the file.
    pub token: Option<String>,
    /// Whether the game only simulates the water for emulated boats; commands select such a game
    /// only by name.
    #[serde(default)]
    pub is_water: bool,
}

/// The address at which a gateway on this machine accepts operator commands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GatewayEntry {
    /// The boat's name.
    pub vehicle: String,
    /// The game that the gateway should join; if unset, the only one running.
    pub game: Option<String>,
    /// The gateway's control port.
    pub control: SocketAddr,
    /// Process number of the gateway.
    pub pid: u32,
    /// The game's token, for processes of the same user, which may read the file.
    pub token: Option<String>,
}

/// The file extensions, one for each kind of entry.
const GAMES: &str = "json";
const GATEWAYS: &str = "gateway";

/// An entry that is removed on drop.
pub struct Registration(PathBuf);

fn folder() -> PathBuf {
    folder_in(std::env::var_os("XDG_RUNTIME_DIR"))
}

fn folder_in(runtime_dir: Option<OsString>) -> PathBuf {
    // A relative path would mean a different folder in each working directory, and is invalid under
    // the XDG Base Directory Specification.
    match runtime_dir
        .map(PathBuf::from)
        .filter(|dir| dir.is_absolute())
    {
        Some(dir) => dir.join("squall"),
        None => {
            std::env::temp_dir().join(format!("squall-{}", rustix::process::geteuid().as_raw()))
        }
    }
}

/// Whether only this user can write to the folder or read its files.
fn is_private(folder: &Path) -> bool {
    fs::symlink_metadata(folder).is_ok_and(|about| {
        // `symlink_metadata` does not follow a link that a different user put into `/tmp`. The
        // files contain tokens.
        about.is_dir()
            && about.uid() == rustix::process::geteuid().as_raw()
            && about.mode() & 0o077 == 0
    })
}

/// Registers a game.
///
/// # Errors
/// If the file cannot be written, or other users can read its folder.
pub fn register(entry: &Entry) -> std::io::Result<Registration> {
    register_in(
        &folder(),
        &format!("{}-{}.{GAMES}", entry.game, entry.pid),
        entry,
    )
}

/// Registers a gateway.
///
/// # Errors
/// As for [`register`].
pub fn register_gateway(entry: &GatewayEntry) -> std::io::Result<Registration> {
    // The boat's name may not be valid as a file name; a process has one gateway.
    register_in(&folder(), &format!("{}.{GATEWAYS}", entry.pid), entry)
}

/// The registry's folder, which only this user can access.
pub(crate) fn private_folder() -> std::io::Result<PathBuf> {
    let folder = folder();
    make_private(&folder)?;
    Ok(folder)
}

fn make_private(folder: &Path) -> std::io::Result<()> {
    fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(folder)?;
    if !is_private(folder) {
        let problem = "is a link or accessible to other users, expected a folder of mode 700 that this user owns";
        return Err(std::io::Error::other(format!(
            "{} {problem}",
            folder.display()
        )));
    }
    Ok(())
}

fn register_in<E: Serialize>(
    folder: &Path,
    name: &str,
    entry: &E,
) -> std::io::Result<Registration> {
    make_private(folder)?;
    let registration = Registration(folder.join(name));
    registration.update(entry)?;
    Ok(registration)
}

impl Registration {
    /// Replaces the entry with one of the same kind. Concurrent readers see the previous entry.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn update<E: Serialize>(&self, entry: &E) -> std::io::Result<()> {
        let unfinished = self.0.with_added_extension("new");
        let mut file = fs::OpenOptions::new()
            .write(true)
            .create(true)
            .truncate(true)
            .mode(0o600)
            .open(&unfinished)?;
        file.write_all(&serde_json::to_vec(entry)?)?;
        // Rename when complete: others may read the folder at any time, and could not parse half a
        // file.
        fs::rename(&unfinished, &self.0)
    }
}

impl Drop for Registration {
    fn drop(&mut self) {
        // A different process may have removed the file already.
        drop(fs::remove_file(&self.0));
    }
}

/// All games whose processes still run, by name; removes entries of dead processes.
pub fn list() -> Vec<Entry> {
    let mut entries: Vec<Entry> = list_in(&folder(), GAMES);
    entries.sort_by(|a, b| (&a.game, a.pid).cmp(&(&b.game, b.pid)));
    entries
}

/// All gateways whose processes still run, by boat; removes entries of dead processes.
pub fn gateways() -> Vec<GatewayEntry> {
    let mut entries: Vec<GatewayEntry> = list_in(&folder(), GATEWAYS);
    entries.sort_by(|a, b| (&a.vehicle, a.pid).cmp(&(&b.vehicle, b.pid)));
    entries
}

fn list_in<E: DeserializeOwned>(folder: &Path, kind: &str) -> Vec<E> {
    // Other users with write access could redirect us to their own games.
    let files = is_private(folder)
        .then(|| fs::read_dir(folder).ok())
        .flatten();
    let files = files
        .into_iter()
        .flatten()
        .flatten()
        .map(|file| file.path());
    let files = files.filter(|path| path.extension().is_some_and(|ending| ending == kind));
    files.filter_map(|path| live_entry(&path)).collect()
}

/// The part that all entries have in common.
#[derive(Deserialize)]
struct Process {
    pid: u32,
}

/// Size limit of an entry, bytes; typical entries have a few hundred.
const ENTRY_MAX: u64 = 1 << 16;

fn live_entry<E: DeserializeOwned>(path: &Path) -> Option<E> {
    let json = primitives::input_file::read(path, ENTRY_MAX).ok()?;
    let Process { pid } = serde_json::from_slice(&json).ok()?;
    // Without /proc, assume that the process is alive.
    let dead = Path::new("/proc/self").exists() && !Path::new(&format!("/proc/{pid}")).exists();
    if dead {
        // A killed process leaves its file behind; the next reader removes it.
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
    fn only_this_user_can_read_an_entry() {
        let dir = std::env::temp_dir().join(format!("squall-registry-test-{}", std::process::id()));
        let entry = Entry {
            game: "pav01".to_owned(),
            endpoint: "tcp/127.0.0.1:7447".to_owned(),
            pid: std::process::id(),
            token: Some("secret".to_owned()),
            is_water: false,
        };
        let registration = register_in(&dir, "a.json", &entry).expect("a folder");
        let gateway = GatewayEntry {
            vehicle: "../blue_one".to_owned(),
            game: None,
            control: "127.0.0.1:7001".parse().expect("an address"),
            pid: std::process::id(),
            token: None,
        };
        let dead = GatewayEntry {
            pid: u32::MAX,
            ..gateway.clone()
        };
        let gateways = [("b.gateway", &gateway), ("c.gateway", &dead)];
        let gateways =
            gateways.map(|(name, entry)| register_in(&dir, name, entry).expect("a folder"));
        let mode = fs::metadata(&registration.0).expect("a file").mode();
        assert_eq!(mode & 0o777, 0o600, "{mode:o}");
        assert_eq!(list_in::<Entry>(&dir, GAMES), std::slice::from_ref(&entry));
        assert_eq!(
            list_in::<GatewayEntry>(&dir, GATEWAYS),
            std::slice::from_ref(&gateway),
            "one of two runs"
        );
        assert!(!gateways[1].0.exists(), "it is dead");
        let renewed = GatewayEntry {
            token: Some("another".to_owned()),
            ..gateway
        };
        gateways[0].update(&renewed).expect("it is ours");
        assert_eq!(list_in::<GatewayEntry>(&dir, GATEWAYS), [renewed]);
        fs::set_permissions(&dir, fs::Permissions::from_mode(0o777)).expect("it is ours");
        assert_eq!(
            list_in::<Entry>(&dir, GAMES),
            [],
            "anybody could have written it"
        );
        assert!(
            register_in(&dir, "a.json", &entry).is_err(),
            "anybody could read it"
        );
        drop((registration, gateways));
        fs::remove_dir(&dir).expect("it is empty");
    }

    #[test]
    fn a_link_to_a_folder_is_not_followed_and_a_relative_folder_not_used() {
        let dir = tempfile::tempdir().expect("a folder");
        let own = dir.path().join("own");
        let link = dir.path().join("squall");
        make_private(&own).expect("it is new");
        std::os::unix::fs::symlink(&own, &link).expect("a link");
        assert!(!is_private(&link));
        let refused = make_private(&link).expect_err("it is refused").to_string();
        assert!(
            refused.contains("squall is a link or accessible to other users"),
            "{refused}"
        );
        assert_eq!(
            folder_in(Some("/run/user/7".into())),
            Path::new("/run/user/7/squall")
        );
        for given in [Some("".into()), Some("run".into()), None] {
            assert!(folder_in(given).starts_with(std::env::temp_dir()));
        }
    }
}
