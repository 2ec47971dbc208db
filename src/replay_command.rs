//! `squall replay`: replays a recorded game.

use crate::progress::Progress;
use crate::{recording_file, screen};
use anyhow::{Context, Result};
use recording::{FRAME, Recording};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod check;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Recording to replay: a file, or part of a name listed by `squall runs` [default: the
    /// newest in runs]
    #[arg(value_name = "RECORDING", value_parser = recording_file::named)]
    pub(crate) file: Option<PathBuf>,
    /// Reruns the game from its recorded inputs, without running the agents, and reports whether
    /// the result is identical
    #[arg(long)]
    pub(crate) check: bool,
}

/// Reruns a recorded game from its inputs, and prints whether the rerun reproduces it.
pub(crate) fn check(file: Option<&Path>) -> Result<ExitCode> {
    let file = &recording_file::or_newest(file)?;
    let recording = open(file)?;
    let frames = recording
        .bag()
        .messages()
        .filter(|message| message.topic == FRAME)
        .count();
    let mut progress = Progress::of(frames as u64, "frames");
    let verdict = check::check(&recording, || progress.add());
    progress.end();
    let verdict = verdict.with_context(|| format!("cannot rerun {}", file.display()))?;
    screen::print(&verdict.text);
    Ok(if verdict.is_same {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

pub(crate) fn open(file: &Path) -> Result<Recording> {
    recording_file::open(file, "replay")
}
