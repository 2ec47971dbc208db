//! The commands of the boat's program: they connect a real boat to a game, and check, stop and
//! command it.
//!
//! `squall gateway` has the same commands. Open `surveyor.rs` first: it drives a boat.

mod check;
mod console;
mod guard;
pub mod link_arg;
pub mod log_line;
mod mission_file;
mod preflight_report;
pub mod protocol_arg;
mod replay;
mod stop_boat;
mod surveyor;
mod swing_guide;
mod tell;

pub use mission_file::read_mission;

use anyhow::{Context, Result};
use clap::Subcommand;
use gateway::config::Gateway;
use scenario::Kind;
use std::path::Path;
use std::process::ExitCode;

/// The kinds of scenario files that the boat's program supports.
pub const KINDS: &[Kind] = &[
    Kind::of::<Gateway>(),
    Kind::GAME,
    Kind::FIELD,
    Kind::RULES,
    Kind::BOAT,
    Kind::SEA,
    Kind::STRATEGY,
];

/// The gateway's subcommands.
#[derive(Subcommand)]
pub enum Command {
    /// Connects a real boat to a game, where agents drive it like a simulated boat.
    Surveyor(surveyor::Args),
    /// Checks a boat without commanding it; with --vehicle, runs the pre-flight check.
    Check(check::Args),
    /// Stops a boat directly: sends zero thrust and standby over its link.
    Stop(stop_boat::Args),
    /// Sends an operator command, such as arm, disarm, estop or release, to a boat's gateway.
    Tell(tell::Args),
    /// Operates boats from a prompt, over connections that stay open so that stops are fast.
    Console(console::Args),
    /// Stops the boat when its gateway is killed or hangs; started by the gateway.
    #[command(hide = true)]
    Guard,
    /// Replays a gateway's recording through its codec and supervisor.
    Replay(replay::Args),
}

/// The gateway settings from this file, or the defaults.
fn gateway_file(path: Option<&Path>) -> Result<Gateway> {
    let load = |path: &Path| {
        scenario::load_file::<Gateway>(path)
            .with_context(|| format!("cannot use the gateway file {}", path.display()))
    };
    path.map_or_else(|| Ok(gateway::config::default_gateway()), load)
}

/// Runs the command. `commit` is the program's commit, which recordings state.
///
/// # Errors
/// The command's failure.
pub fn run(command: &Command, commit: &'static str) -> Result<ExitCode> {
    match command {
        Command::Surveyor(args) => surveyor::run(args, commit),
        Command::Check(args) => check::run(args),
        Command::Stop(args) => stop_boat::run(args),
        Command::Tell(args) => tell::run(args),
        Command::Console(args) => console::run(args),
        Command::Guard => guard::run(),
        Command::Replay(args) => replay::run(args),
    }
}
