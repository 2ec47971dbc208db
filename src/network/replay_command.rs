//! `squall replay` on a page: a recorded game, with helm reports from minds that receive its
//! pictures again.

use super::page_args::PageArgs;
use super::replay_futures::ReplayFutures;
use super::replay_helms::ReplayHelms;
use crate::replay_command;
use crate::{recording_file, screen, stop};
use anyhow::{Result, bail};
use command_line::explain::UsageError;
use experiment::turning::{Point, Report};
use serde_json::{Value, json};
use shore::page::replay::{Futures, Recorded, ReplayView};
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

/// Opens a recording for a page, with a sentence about its origin, if any.
pub(crate) fn open(file: &Path, about: Option<String>) -> Result<ReplayView> {
    let recording = Arc::new(replay_command::open(file)?);
    let mut recorded = Recorded::new(Arc::clone(&recording), file.display().to_string());
    recorded
        .damaged
        .remark()
        .iter()
        .for_each(|remark| screen::remark(remark));
    recorded.chances = chances(file);
    let futures = ReplayFutures::new(&recording);
    Ok(ReplayView::new(
        about,
        Arc::new(recorded),
        Some(Box::new(ReplayHelms::new(recording))),
        futures.map(|futures| Box::new(futures) as Box<dyn Futures>),
    ))
}

/// The chance of winning, if `squall log --turning-points` has computed it.
fn chances(recording: &Path) -> Option<Value> {
    let path = recording::turning_points_of(recording);
    let text = std::fs::read_to_string(&path).ok()?;
    let report = serde_json::from_str::<Report>(&text)
        .map_err(|error| screen::remark(&format!("{} is ignored: {error}", path.display())))
        .ok()?;
    let of = |get: fn(&Point) -> Option<f64>| report.curve.iter().map(get).collect::<Vec<_>>();
    let turns = report.turning_points.iter();
    Some(json!({
        "t_s": of(|point| Some(point.at_s)),
        "chance": of(|point| Some(point.chance.mean)),
        "low": of(|point| point.chance.low),
        "high": of(|point| point.chance.high),
        "turns_s": turns.map(|turn| f64::midpoint(turn.from_s, turn.to_s)).collect::<Vec<_>>(),
    }))
}
