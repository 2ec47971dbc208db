//! `gateway guard`: the process that stops the boat if its gateway cannot. The gateway starts it.

use anyhow::{Context, Result};
use command_line::{program, terminal};
use std::process::{Command, ExitCode};

pub(crate) fn run() -> Result<ExitCode> {
    // A signal that ends the gateway must not end its guard; the guard exits by itself soon after.
    ctrlc::set_handler(|| ()).context("cannot ignore signals")?;
    gateway::node::guard(std::io::stdin(), &mut terminal::remark)
        .context("the guard of a gateway")?;
    Ok(ExitCode::SUCCESS)
}

/// The command line that starts the guard: this program with its `guard` subcommand.
pub(crate) fn own_command() -> Result<Command> {
    let mut command =
        Command::new(std::env::current_exe().context("cannot find this program's executable")?);
    // The first word is the program itself.
    command
        .args(program::gateway().split_whitespace().skip(1))
        .arg("guard");
    Ok(command)
}
