//! `squall replay` on a page: a recorded game, with helm reports from minds that are given its pictures again.

use super::page_args::PageArgs;
use super::replay_helms::ReplayHelms;
use crate::replay_command;
use crate::{recording_file, screen, stop};
use anyhow::{Result, bail};
use command_line::explain::UsageError;
use shore::page::replay::{Recorded, ReplayView};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    replay: replay_command::Args,
    #[command(flatten)]
    page: PageArgs,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let file = args.replay.file.as_deref();
    if args.replay.check {
        if args.page.is_given() {
            bail!(UsageError(
                "--check shows no page; omit --listen, --token, --page-token-file and --host"
                    .to_owned()
            ));
        }
        return replay_command::check(file);
    }
    show(&recording_file::or_newest(file)?, &args.page)
}

/// Shows a recording on a page until Ctrl-C.
pub(crate) fn show(file: &Path, page: &PageArgs) -> Result<ExitCode> {
    let view = open(file, None)?;
    page.show(file, &stop::on_ctrl_c()?, |page| page.show(Arc::new(view)))
}

/// Opens a recording for a page, with a sentence about its origin if there is one.
pub(crate) fn open(file: &Path, about: Option<String>) -> Result<ReplayView> {
    let recording = Arc::new(replay_command::open(file)?);
    let recorded = Recorded::new(Arc::clone(&recording), file.display().to_string());
    recorded
        .damaged
        .remark()
        .iter()
        .for_each(|remark| screen::remark(remark));
    Ok(ReplayView::about(
        about,
        Arc::new(recorded),
        Some(Box::new(ReplayHelms::new(recording))),
    ))
}
