//! Built-in scenario files, used in place of files missing on disk.

use std::path::Path;
use std::sync::OnceLock;

/// Returns the content of a built-in file by folder and name, as in `seas/gale.toml`.
pub type BuiltIn = fn(&str) -> Option<&'static [u8]>;

static BUILT_IN: OnceLock<BuiltIn> = OnceLock::new();

/// Sets the built-in files of this process. Later calls have no effect.
pub fn set_built_in(files: BuiltIn) {
    // Later callers have the same files: a process has one program.
    let _ = BUILT_IN.set(files);
}

/// The built-in replacement for a missing file in a folder of `scenarios`, such as
/// `scenarios/seas/gale.toml`.
#[must_use]
pub fn built_in(path: &Path) -> Option<&'static [u8]> {
    let mut parts = path.components().rev().map(|part| part.as_os_str().to_str());
    let [name, folder, root] = [parts.next()??, parts.next()??, parts.next()??];
    if root == "scenarios" { BUILT_IN.get()?(&format!("{folder}/{name}")) } else { None }
}
