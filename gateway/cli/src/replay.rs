//! `gateway replay`: reruns a recording through the codec and the supervisor.

use super::log_line::{full, text_of};
use anyhow::{Context, Result};
use command_line::{recording_file, terminal};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Args {
    /// Recording to replay
    file: PathBuf,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let name = || args.file.display().to_string();
    let bag = recording_file::open_any(&args.file, "replay")?;
    let replay = gateway::replay::replay(&bag).with_context(name)?;
    for (at, event) in &replay.events {
        terminal::show(&format!("{:>8.1} s  {}\n", at.as_s(), text_of(event)));
    }
    terminal::show(&full(&replay.status));
    let cut = if replay.is_cut {
        " (the file ends abruptly)"
    } else {
        ""
    };
    terminal::print(&format!(
        "{} inputs over {:.1} s, {} bytes from the boat, {} to it{cut}\n",
        replay.inputs,
        replay.lasted.as_s(),
        replay.bytes_in,
        replay.bytes_out
    ));
    let Some(difference) = replay.difference else {
        terminal::print("the replay is identical to the recording, byte for byte\n");
        return Ok(ExitCode::SUCCESS);
    };
    terminal::print(&format!(
        "at {:.3} s the replay differs\n  recorded  {}\n  replayed  {}\n",
        difference.at.as_s(),
        difference.recorded,
        difference.replayed
    ));
    Ok(ExitCode::FAILURE)
}
