//! Built-in scenario files, used in place of files missing on disk.

use crate::source::tidied;
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// Returns the content of a built-in file by folder and name, as in `seas/gale.toml`.
pub type BuiltIn = fn(&str) -> Option<&'static [u8]>;

/// Called with the path of each file read from disk that differs from its built-in namesake.
pub type OnOverride = fn(&Path);

static BUILT_IN: OnceLock<(BuiltIn, OnOverride)> = OnceLock::new();

/// Sets the built-in files of this process. Later calls have no effect.
pub fn set_built_in(files: BuiltIn, on_override: OnOverride) {
    // Later callers pass the same files: a process runs only one program.
    let _ = BUILT_IN.set((files, on_override));
}

/// Reports a file read from disk that overrides a different built-in one.
pub(super) fn note_override(path: &Path, bytes: &[u8], built_in: &[u8]) {
    if let Some((_, on_override)) = BUILT_IN.get().filter(|_| bytes != built_in) {
        on_override(path);
    }
}

/// The built-in replacement for a missing file in a folder of `scenarios`, such as
/// `scenarios/seas/gale.toml`, however the path is written.
pub fn built_in(path: &Path) -> Option<&'static [u8]> {
    // A path typed in the folder `scenarios` lacks that folder's name, so make it absolute. If the
    // working directory is unknown, use the path as given.
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut parts = vec![];
    for component in whole.components() {
        match component {
            Component::Normal(part) => parts.push(part),
            Component::ParentDir => _ = parts.pop(),
            _ => {}
        }
    }
    match parts[..] {
        [.., root, folder, name] if root == "scenarios" => {
            (BUILT_IN.get()?.0)(&format!("{}/{}", folder.to_str()?, name.to_str()?))
        }
        _ => None,
    }
}

/// The command-line argument for a scenario file: its name if commands find it in `scenarios` in
/// the working directory or a parent, or among the built-in files; otherwise its path, quoted for a
/// shell.
pub fn argument_for(path: &Path) -> String {
    let whole = std::path::absolute(tidied(path)).unwrap_or_else(|_| path.to_owned());
    let parts: Vec<_> = whole.iter().collect();
    let (_, tail) = parts.split_at(parts.len().saturating_sub(3));
    let tail: PathBuf = tail.iter().collect();
    let here = std::env::current_dir().unwrap_or_default();
    let mut paths = here.ancestors().map(|folder| folder.join(&tail));
    let found = paths.find(|path| path.is_file());
    let is_named = tail.starts_with("scenarios")
        && found.map_or(built_in(&whole).is_some() && !whole.exists(), |found| {
            found == whole
        });
    let name = whole.file_stem().filter(|_| is_named);
    let text = name.unwrap_or(path.as_os_str()).to_string_lossy();
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if text.chars().all(is_plain) {
        text.into_owned()
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}
