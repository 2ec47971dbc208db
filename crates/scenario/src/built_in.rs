//! Built-in scenario files, used in place of files missing on disk.

use std::path::{Component, Path};
use std::sync::OnceLock;

/// Returns the content of a built-in file by folder and name, as in `seas/gale.toml`.
pub type BuiltIn = fn(&str) -> Option<&'static [u8]>;

/// Called with the path of each file read from disk whose built-in namesake differs.
pub type OnOverride = fn(&Path);

static BUILT_IN: OnceLock<(BuiltIn, OnOverride)> = OnceLock::new();

/// Sets the built-in files of this process. Later calls have no effect.
pub fn set_built_in(files: BuiltIn, on_override: OnOverride) {
    // Later callers have the same files: a process has one program.
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
#[must_use]
pub fn built_in(path: &Path) -> Option<&'static [u8]> {
    // A path typed within `scenarios` lacks its name. Without a working folder, there is only what
    // was typed.
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
