//! `squall gateway guard`: the process that stops the boat when its gateway cannot; the gateway starts it by itself.

use crate::screen;
use anyhow::{Context, Result};
use std::process::ExitCode;

pub(crate) fn run() -> Result<ExitCode> {
    // Whatever ends the gateway must not end this: it ends by itself, soon after.
    ctrlc::set_handler(|| ()).context("cannot ignore signals")?;
    gateway::node::guard(std::io::stdin(), &mut screen::remark).context("the guard of a gateway")?;
    Ok(ExitCode::SUCCESS)
}
