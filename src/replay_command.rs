//! `squall replay`: a recorded game again.

use crate::screen;
use anyhow::{Context, Result};
use shore::recording::Recording;
use std::path::PathBuf;
use std::process::ExitCode;

mod check;

/// Which recording, and what to do with it.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The recording
    file: PathBuf,
    /// Plays the game again from what it was given, without minds, and says whether the same comes of it
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let recording = Recording::open(&args.file).with_context(|| format!("cannot replay {}", args.file.display()))?;
    let verdict = check::check(&recording)?;
    screen::print(&verdict.text());
    Ok(if verdict.is_same() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
