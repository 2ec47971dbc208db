//! The commands whose form depends on the network, in a build without it: games are played in this process, and there is no page.

use crate::run_command::{self, InProcess};
use crate::{cli, replay_command};
use anyhow::{Result, bail};
use clap::Subcommand;
use std::process::ExitCode;

/// What tells of a recorded game.
pub(crate) const LOOK: &str = "squall log";

/// The commands.
#[derive(Subcommand)]
pub(crate) enum Command {
    /// Plays a whole game, shows what happens, prints the result.
    #[command(
        after_help = "Examples:\n  squall run strategy_4_vs_3\n  squall run surveyor_2v2 --sea gale --blue learned --red strategy_3\n  squall run surveyor_2v2 --set link.delay_s=1 --seed 7 --both-sides"
    )]
    Run(Box<run_command::Args>),
    /// Plays a recorded game again, and checks that the same comes of it.
    #[command(after_help = "Examples:\n  squall replay runs/game.mcap --check")]
    Replay(replay_command::Args),
}

pub(crate) fn run(command: &Command) -> Result<ExitCode> {
    match command {
        Command::Run(args) => run_command::run(args, &mut InProcess),
        Command::Replay(args) if args.check => replay_command::check(&args.file),
        Command::Replay(_) => bail!("{}; --check plays it again", cli::not_built("the page that shows recordings")),
    }
}
