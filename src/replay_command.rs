//! `squall replay`: a recorded game again.

use crate::page_args::PageArgs;
use crate::progress::Progress;
use crate::recording_file;
use crate::screen::{self, Screen};
use crate::stop;
use crate::style::Names;
use anyhow::{Context, Result, bail};
use minds::Minds;
use recording::{FRAME, Recording};
use shore::page::replay::{Recorded, ReplayView};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

mod check;
pub(crate) mod minds;

/// Which recording, and what to do with it.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The recording
    file: PathBuf,
    /// Plays the game again from what it was given, without minds, and says whether the same comes of it
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    page: PageArgs,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.check {
        if args.page.is_given() {
            bail!("--check shows no page: --listen, --token and --host are of no use with it");
        }
        let recording = open(&args.file)?;
        let frames = recording.bag().messages().filter(|message| message.topic == FRAME).count();
        let mut progress = Progress::of(frames as u64, "frames");
        let verdict = check::check(&recording, || progress.add());
        progress.end();
        let verdict = verdict.with_context(|| format!("cannot play {} again", args.file.display()))?;
        screen::print(&verdict.text);
        return Ok(if verdict.is_same { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    let show = show(&args.file)?;
    let stop = stop::on_ctrl_c()?;
    let page = args.page.open(&stop)?;
    page.show(Arc::new(show));
    Screen::new(Names::default()).line(&format!(
        "{} at {} (Ctrl-C ends it)",
        args.file.display(),
        args.page.url(&page)
    ));
    args.page.open_browser(&page);
    stop::wait(&stop);
    Ok(ExitCode::SUCCESS)
}

/// A recording as a page shows it.
pub(crate) fn show(file: &Path) -> Result<ReplayView> {
    show_about(file, None)
}

/// The same with a sentence about where it comes from.
pub(crate) fn show_about(file: &Path, about: Option<String>) -> Result<ReplayView> {
    let recording = Arc::new(open(file)?);
    let recorded = Recorded::new(Arc::clone(&recording), file.display().to_string());
    recorded.damaged().remark().iter().for_each(|remark| screen::remark(remark));
    Ok(ReplayView::about(about, Arc::new(recorded), Some(Box::new(Minds::new(recording)))))
}

fn open(file: &Path) -> Result<Recording> {
    recording_file::open(file, "replay")
}
