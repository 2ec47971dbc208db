//! `squall view`: shows a running game from any machine, or a report with its games, on a page.

use super::page_args::{self, PageArgs};
use super::replay_command;
use crate::screen::{self, Screen};
use crate::style::Names;
use crate::{recording_file, stop};
use anyhow::{Context, Result, bail};
use command_line::leaf_args::LeafArgs;
use shore::page::View;
use shore::page::live::LiveView;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

mod games;
mod report;
mod training;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// What to show: the JSON report of a tournament, the folder of a league, sweep or training, or
    /// a recording or part of its name [default: a running game; if there is none, the newest
    /// recording in runs]
    #[arg(value_name = "REPORT", conflicts_with_all = ["game", "connect"], value_parser = recording_file::named)]
    report: Option<PathBuf>,
    #[command(flatten)]
    leaf: LeafArgs,
    #[command(flatten)]
    page: PageArgs,
    /// Exits when standard input closes; shows the recordings named there, one per line
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if let Some(path) = &args.report {
        return show_report(args, path);
    }
    let has_run = !recording_file::runs(Path::new(recording_file::FOLDER)).is_empty();
    if has_run && !args.for_parent && args.leaf.finds_no_game() {
        screen::remark("no game is running on this machine; to wait for one, name it with --game");
        return replay_command::show(&recording_file::or_newest(None)?, &args.page);
    }
    let stop = stop::on_ctrl_c()?;
    let recordings = args.for_parent.then(|| stop::with_parent(&stop));
    let page = args.page.open(&stop)?;
    // A parent process that started the game needs none of these remarks.
    let is_told = !args.for_parent;
    let tell = Box::new(move |problem: &str| {
        if is_told {
            screen::remark(problem);
        }
    });
    let place = args.leaf.place()?;
    let game = args.leaf.game.clone();
    let live = LiveView::open(place, game, tell, gateway_cli::read_mission)
        .context("cannot search for games")?;
    let live = Arc::new(live);
    page.show(Arc::clone(&live) as Arc<dyn View>);
    Screen::new(Names::default()).line(&format!(
        "the page is at {} (Ctrl-C to stop)",
        args.page.url(&page)
    ));
    args.page.open_browser(&page);
    let mut operators_know = args.page.has_token();
    while !stop::is_set_soon(&stop) {
        if !operators_know && live.has_real_boats() {
            operators_know = true;
            screen::remark(&format!(
                "to operate real boats, open {}",
                page_args::operator_url(&page)
            ));
        }
        let Some(file) = recordings.as_ref().and_then(|named| named.try_recv().ok()) else {
            continue;
        };
        match replay_command::open(Path::new(&file), None) {
            Ok(show) => page.show(Arc::new(show)),
            Err(error) => screen::remark(&command_line::explain::line(&error)),
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Shows a report or a recording until Ctrl-C.
fn show_report(args: &Args, path: &Path) -> Result<ExitCode> {
    if args.for_parent {
        bail!("a parent process can show only games, not reports");
    }
    if path.extension().is_some_and(|end| end == "mcap") {
        return replay_command::show(path, &args.page);
    }
    let stop = stop::on_ctrl_c()?;
    let report = report::open(path, &stop)?;
    args.page.show(path, &stop, |page| page.publish(report))
}
