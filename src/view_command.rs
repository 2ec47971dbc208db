//! `squall view`: a running game on a page, from any machine.

use crate::net_args::LeafArgs;
use crate::page_args::PageArgs;
use crate::replay_command;
use crate::screen::{self, Screen};
use crate::stop;
use crate::style::Names;
use anyhow::{Context, Result};
use shore::page::live::LiveView;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

/// Which game, and where the page is served.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    leaf: LeafArgs,
    #[command(flatten)]
    page: PageArgs,
    /// Stops when standard input ends; shows the recordings that it names, one a line
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    let recordings = args.for_parent.then(|| stop::with_parent(&stop));
    let page = args.page.open(&stop)?;
    // Who started us starts the game as well.
    let is_told = !args.for_parent;
    let tell = Box::new(move |problem: &str| {
        if is_told {
            screen::remark(problem);
        }
    });
    let live = LiveView::open(args.leaf.place()?, args.leaf.game.clone(), tell).context("cannot look for games")?;
    page.show(Arc::new(live));
    Screen::new(Names::default()).line(&format!("look at it on {} (Ctrl-C ends it)", args.page.url(&page)));
    args.page.open_browser(&page);
    while !stop::is_set_soon(&stop) {
        let Some(file) = recordings.as_ref().and_then(|named| named.try_recv().ok()) else { continue };
        match replay_command::show(Path::new(&file)) {
            Ok(show) => page.show(Arc::new(show)),
            Err(error) => screen::remark(&format!("{error:#}")),
        }
    }
    Ok(ExitCode::SUCCESS)
}
