//! Whether and where a game is recorded.

use crate::output_file;
use anyhow::{Context, Result};
use game::Scenario;
use game::run_state::RecordingState;
use recording::utc;
use std::path::PathBuf;

/// Whether and where `run` records.
#[derive(Clone, clap::Args)]
pub(crate) struct RecordArgs {
    /// Records the game into this folder
    #[arg(long, value_name = "DIR", default_value = "runs")]
    record: PathBuf,
    /// Does not record
    #[arg(long, conflicts_with = "record")]
    no_record: bool,
}

impl RecordArgs {
    /// A new file for a game of this scenario, in a folder that is there.
    pub(crate) fn file(&self, scenario: &Scenario, seed: u64) -> Result<Option<PathBuf>> {
        if self.no_record {
            return Ok(None);
        }
        output_file::make_folder(&self.record).context("nowhere to record")?;
        let stem = format!("{}_{}_{seed}", utc::file_stamp(utc::now_ns()), scenario.name);
        let names = std::iter::once(format!("{stem}.mcap")).chain((2..).map(|n| format!("{stem}_{n}.mcap")));
        let file = names.map(|name| self.record.join(name)).find(|path| !path.exists());
        // Made by whoever records, and not before; whether it can be is told before the game.
        file.as_deref().map_or(Ok(()), |path| output_file::check(path, "the recording"))?;
        Ok(file)
    }
}

/// What is wrong with a recording, in words, if anything is.
pub(crate) fn problem(state: &RecordingState) -> Option<String> {
    let file = &state.file;
    match &state.failed {
        Some(reason) if state.bytes == 0 => Some(format!("nothing is recorded in {file}: {reason}")),
        Some(reason) => Some(format!("the recording {file} is not complete: {reason}")),
        None if state.dropped > 0 => {
            Some(format!("the recording {file} lacks {} messages: the disk was too slow", state.dropped))
        }
        None => None,
    }
}
