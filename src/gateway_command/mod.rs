//! `squall gateway`: real boats in games, simulated boats for real back seats, and a look at what goes between.

mod check;
mod emulate;
mod log_line;
mod replay;
mod surveyor;
mod tell;

use anyhow::Result;
use clap::Subcommand;
use std::process::ExitCode;

/// What a gateway is to do.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Brings a real boat into a game: agents drive it without knowing.
    Surveyor(surveyor::Args),
    /// Lets a real back seat drive a simulated boat by the real one's sentences.
    Emulate(emulate::Args),
    /// Listens to a boat, without a word, and says what it tells and what is missing.
    Check(check::Args),
    /// Asks something of a boat's gateway: arm, disarm, estop, release, ...
    Tell(tell::Args),
    /// Plays a recording of a gateway through its codec and supervisor again.
    Replay(replay::Args),
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Surveyor(args) => surveyor::run(args),
        Command::Emulate(args) => emulate::run(args),
        Command::Check(args) => check::run(args),
        Command::Tell(args) => tell::run(args),
        Command::Replay(args) => replay::run(args),
    }
}
