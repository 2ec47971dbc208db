//! `squall view`: a running game on a page, from any machine.

use crate::net_args::LeafArgs;
use crate::page_args::PageArgs;
use crate::replay_command;
use crate::screen::{self, Screen};
use crate::stop;
use anyhow::{Context, Result};
use shore::page::live::LiveShow;
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
    /// Stops when standard input ends, and shows the game's recording once it is over
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    if args.for_parent {
        stop::with_parent(&stop);
    }
    let page = args.page.open(&stop)?;
    let leaf = args.leaf.clone();
    let place = Box::new(move || leaf.net().map_err(|e| format!("{e:#}")));
    // Who started us starts the game as well.
    let is_told = !args.for_parent;
    let tell = Box::new(move |missing: &str| {
        if is_told {
            screen::remark(&format!("no game to show: {missing}"));
        }
    });
    let live = LiveShow::open(place, args.leaf.game.clone(), tell).context("cannot look for games")?;
    let live = Arc::new(live);
    page.show(live.clone());
    Screen::new().line(&format!("look at it on {} (Ctrl-C ends it)", args.page.url(&page)));
    while !stop::is_set_soon(&stop) {
        if !args.for_parent {
            continue;
        }
        if let Some(recording) = live.recording_of_the_end() {
            match replay_command::show(Path::new(&recording.file)) {
                Ok(show) => page.show(Arc::new(show)),
                Err(error) => screen::remark(&format!("{error:#}")),
            }
            break;
        }
    }
    stop::wait(&stop);
    page.close();
    Ok(ExitCode::SUCCESS)
}
