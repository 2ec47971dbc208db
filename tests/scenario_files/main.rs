//! Scenario files of every kind: shipped files, broken files, noise, and the reference pages.

#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

mod broken;
mod hostile;
#[path = "../../src/kinds.rs"]
mod kinds;
mod recognised;
mod shipped;

use scenario::Kind;
use std::path::{Path, PathBuf};

fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios")
        .join(path)
}

/// The shipped files of the given kind, in order.
fn files(kind: Kind) -> Vec<PathBuf> {
    let folder = std::fs::read_dir(shipped(kind.folder())).unwrap();
    let mut files: Vec<PathBuf> = folder.map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension == "toml")
    });
    files.sort();
    files
}

/// Writes a file below `folder`; returns its path.
fn written(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, text).unwrap();
    path
}
