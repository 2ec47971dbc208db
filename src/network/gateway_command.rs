//! `squall gateway`: the commands of the boat's program, and emulated boats for real back seats.

mod emulate;
mod sitl;

use anyhow::Result;
use clap::Subcommand;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    #[command(flatten)]
    Boat(gateway_cli::Command),
    /// Emulates a boat for a real back seat, using the real boat's sentences.
    Emulate(emulate::Args),
    /// Simulates a boat driven by ArduPilot's real firmware, as the JSON physics back end of SITL.
    Sitl(sitl::Args),
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Boat(command) => gateway_cli::run(command, env!("SQUALL_COMMIT")),
        Command::Emulate(args) => emulate::run(args),
        Command::Sitl(args) => sitl::run(args),
    }
}
