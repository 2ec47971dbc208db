//! Command line arguments that define whether and where a game is recorded.

use crate::{output_file, recording_file};
use anyhow::{Context, Result};
use recording::NewFile;
use scenario::Scenario;
use std::path::PathBuf;

#[derive(Clone, clap::Args)]
pub(crate) struct RecordArgs {
    /// Folder for the recording
    #[arg(long, value_name = "DIR", default_value = recording_file::FOLDER)]
    record: PathBuf,
    /// Does not record the game
    #[arg(long, conflicts_with = "record")]
    no_record: bool,
}

impl RecordArgs {
    /// A new file for a game of this scenario, in a folder that exists.
    pub(crate) fn file(&self, scenario: &Scenario, seed: u64) -> Result<Option<NewFile>> {
        if self.no_record {
            return Ok(None);
        }
        output_file::make_folder(&self.record).context("cannot record")?;
        let file = NewFile::create_numbered(&self.record, &recording::stem(&scenario.name, seed));
        Ok(Some(file.with_context(|| {
            format!("cannot record to {}", self.record.display())
        })?))
    }
}
