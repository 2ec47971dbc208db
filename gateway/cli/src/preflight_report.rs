//! The report of a pre-flight check on disk: JSON for the gateway, with a plain-text copy next to
//! it.

use anyhow::{Context, Result};
use gateway::preflight::Report;
use std::path::Path;

/// Size limit of a report, bytes.
const BYTES_MAX: u64 = 1 << 20;

/// Writes a report and its plain-text copy.
pub(super) fn write(path: &Path, report: &Report) -> Result<()> {
    let write = |path: &Path, text: &str| {
        primitives::output_file::write(path, text)
            .with_context(|| format!("cannot write {}", path.display()))
    };
    write(
        path,
        &(serde_json::to_string_pretty(report).context("cannot encode the report as JSON")? + "\n"),
    )?;
    write(&path.with_extension("txt"), &report.text())
}

pub(super) fn read(path: &Path) -> Result<Report> {
    let text = primitives::input_file::read_text(path, BYTES_MAX)
        .with_context(|| format!("cannot read {}", path.display()))?;
    serde_json::from_str(&text)
        .with_context(|| format!("{} is not the report of a pre-flight check", path.display()))
}
