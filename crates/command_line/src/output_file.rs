//! Files that commands write, with errors that name them.

use anyhow::{Context, Result};
use serde::Serialize;
use std::fs::OpenOptions;
use std::path::Path;

/// Writes a file; `what` stands in the error.
pub fn write(path: &Path, what: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
    std::fs::write(path, bytes).with_context(|| format!("cannot write {what} to {}", path.display()))
}

/// Whether a file can be written, to be asked before hours of games; it is as before then.
pub fn check(path: &Path, what: &str) -> Result<()> {
    let is_new = match std::fs::metadata(path) {
        // A pipe would be waited for.
        Ok(metadata) if !metadata.is_file() && !metadata.is_dir() => return Ok(()),
        found => found.is_err(),
    };
    let file = OpenOptions::new().append(true).create(true).open(path);
    file.with_context(|| format!("cannot write {what} to {}", path.display()))?;
    if is_new {
        std::fs::remove_file(path).with_context(|| format!("cannot remove {}", path.display()))?;
    }
    Ok(())
}

/// Writes a value as JSON that people can read.
pub fn write_json(path: &Path, what: &str, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value).with_context(|| format!("{what} is not JSON"))?;
    write(path, what, text + "\n")
}

/// A folder that is there.
pub fn make_folder(dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir).with_context(|| format!("cannot make the folder {}", dir.display()))
}
