//! The scenario files that a program has inside of itself: they stand in for those that are not on the disk.

use std::path::Path;
use std::sync::OnceLock;

/// What a file inside of the program says, by its folder and name, as in `seas/gale.toml`.
pub type BuiltIn = fn(&str) -> Option<&'static [u8]>;

static BUILT_IN: OnceLock<BuiltIn> = OnceLock::new();

/// Gives this process the files of a program. The first ones stay.
pub fn set_built_in(files: BuiltIn) {
    // Who came first has the same ones: there is one program in a process.
    let _ = BUILT_IN.set(files);
}

/// What the program has in the place of a file that is not on the disk: only of one in a folder of a folder `scenarios`, as in
/// `scenarios/seas/gale.toml`.
#[must_use]
pub fn built_in(path: &Path) -> Option<&'static [u8]> {
    let mut parts = path.components().rev().map(|part| part.as_os_str().to_str());
    let [name, folder, root] = [parts.next()??, parts.next()??, parts.next()??];
    if root == "scenarios" { BUILT_IN.get()?(&format!("{folder}/{name}")) } else { None }
}
