//! Output files of commands, with errors that name them.

use anyhow::{Context, Result};
use serde::Serialize;
use std::fs::OpenOptions;
use std::path::Path;

/// Writes a file; errors call it `what`.
pub fn write(path: &Path, what: &str, bytes: impl AsRef<[u8]>) -> Result<()> {
    primitives::output_file::write(path, bytes)
        .with_context(|| format!("cannot write {what} to {}", path.display()))
}

/// Checks, before games that take hours, that a file is writable; leaves it unchanged.
pub fn check(path: &Path, what: &str) -> Result<()> {
    let is_new = match std::fs::metadata(path) {
        // Opening a pipe would block.
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

/// Writes a value as formatted JSON.
pub fn write_json(path: &Path, what: &str, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value)
        .with_context(|| format!("cannot encode {what} as JSON"))?;
    write(path, what, text + "\n")
}

/// Creates a folder if it does not exist.
pub fn make_folder(dir: &Path) -> Result<()> {
    std::fs::create_dir_all(dir)
        .with_context(|| format!("cannot create the folder {}", dir.display()))
}
