//! `squall agent`: minds boats.

use crate::net_args::LeafArgs;
use crate::screen;
use crate::sim_command::seconds;
use crate::stop;
use agent::node::{News, Settings};
use anyhow::{Context, Result};
use std::process::ExitCode;
use std::time::Duration;

/// Which boats, and where.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicles to mind, by name
    #[arg(long, required = true, num_args = 1.., value_name = "NAME")]
    vehicle: Vec<String>,
    #[command(flatten)]
    leaf: LeafArgs,
    /// How long to look for the sim and to wait for a free seat, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    wait_s: f64,
    /// After this long without a picture the sim counts as dead, s (3 s once its sign of life is gone)
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = seconds)]
    silence_s: f64,
    /// Says nothing, and stops when standard input ends
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    if args.for_parent {
        stop::with_parent(&stop);
    }
    let names = args.vehicle.join(", ");
    let settings = Settings {
        policy_wait: std::time::Duration::ZERO,
        strategy: None,
        game: args.leaf.game.clone(),
        net: args.leaf.net()?,
        vehicles: args.vehicle.clone(),
        wait: Duration::from_secs_f64(args.wait_s),
        silence: Duration::from_secs_f64(args.silence_s),
        stop: stop.clone(),
    };
    let mut tell = |news: News<'_>| {
        if args.for_parent {
            return;
        }
        match news {
            News::Left { .. } => {}
            News::Looking { reason } => screen::remark(&format!("{names}: looking for the game: {reason}")),
            News::Joined { game } => screen::remark(&format!("{names}: joined {game}")),
        }
    };
    agent::node::serve(&settings, &mut tell).with_context(|| format!("the agent of {names}"))?;
    let stopped = stop.load(std::sync::atomic::Ordering::Relaxed);
    Ok(if stopped { stop::interrupted() } else { ExitCode::SUCCESS })
}
