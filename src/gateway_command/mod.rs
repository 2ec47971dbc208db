//! `squall gateway`: real boats in games, emulated boats for real back seats, and tools for the link between.

mod check;
mod console;
mod emulate;
mod guard;
mod log_line;
mod mission_file;
mod preflight_report;
mod replay;
mod stop_boat;
mod surveyor;
mod swing_guide;
mod tell;

use anyhow::{Context, Result};
use clap::Subcommand;
use messages::external::Mission;
use std::path::Path;
use std::process::ExitCode;

/// What a gateway is to do.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Connects a real boat with a game: agents drive it as any other.
    Surveyor(surveyor::Args),
    /// Emulates a boat for a real back seat, with the real one's sentences.
    Emulate(emulate::Args),
    /// Checks a boat before arming, without sending anything; with --vehicle, the pre-flight check.
    Check(check::Args),
    /// Stops a boat with nothing else running: thrust zero and standby, straight over its link.
    Stop(stop_boat::Args),
    /// Sends an operator command to a boat's gateway: arm, disarm, estop, release, ...
    Tell(tell::Args),
    /// Operates boats line by line over connections that stay open: for quick stops.
    Console(console::Args),
    /// What a gateway starts to stop its boat when it is killed or hangs.
    #[command(hide = true)]
    Guard,
    /// Plays a recording of a gateway through its codec and supervisor again.
    Replay(replay::Args),
}

/// How a boat is driven and stopped, by this file, or by the defaults.
fn gateway_file(path: Option<&Path>) -> Result<gateway::config::Gateway> {
    let load = |path: &Path| {
        scenario::load_file::<gateway::config::Gateway>(path)
            .with_context(|| format!("cannot drive by {}", path.display()))
    };
    path.map_or_else(|| Ok(gateway::config::default_gateway()), load)
}

/// The mission in the text of a mission file, or what is wrong with it.
pub(crate) fn read_mission(text: &str) -> Result<Mission, String> {
    mission_file::parse(text)
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Surveyor(args) => surveyor::run(args),
        Command::Emulate(args) => emulate::run(args),
        Command::Check(args) => check::run(args),
        Command::Stop(args) => stop_boat::run(args),
        Command::Tell(args) => tell::run(args),
        Command::Console(args) => console::run(args),
        Command::Guard => guard::run(),
        Command::Replay(args) => replay::run(args),
    }
}
