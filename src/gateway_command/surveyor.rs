//! `squall gateway surveyor`: a real boat in a game.

use super::log_line::{Log, full};
use crate::net_args::LeafArgs;
use crate::screen;
use crate::sim_command::seconds;
use crate::stop;
use anyhow::{Context, Result, anyhow};
use gateway::link::LinkAddress;
use gateway::node::{NodeEvent, Settings};
use recording::utc;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Which boat, and where.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The vehicle in the game, by name; there it has source = "external"
    #[arg(long, value_name = "NAME")]
    vehicle: String,
    /// Where the boat is: tcp://HOST:PORT, udp://HOST:PORT, serial:///dev/ttyUSB0?baud=38400
    #[arg(long, value_name = "URL")]
    link: String,
    /// How it is driven and stopped: a gateway file [default: a Surveyor with careful limits]
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Arms by itself, once, as soon as it is ready; after a failsafe it has to be armed by command
    #[arg(long)]
    arm: bool,
    /// Records to this file [default: runs/gateway-NAME-UTC.mcap]
    #[arg(long, value_name = "FILE", conflicts_with = "no_record")]
    record: Option<PathBuf>,
    /// Records nothing
    #[arg(long)]
    no_record: bool,
    /// The boat is an emulated one, whose time runs as fast as the game's
    #[arg(long)]
    at_game_pace: bool,
    /// After this long without a byte the boat counts as gone, s
    #[arg(long, value_name = "S", default_value_t = 3.0, value_parser = seconds)]
    silence_s: f64,
    /// How long to look for the game, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    wait_s: f64,
    #[command(flatten)]
    leaf: LeafArgs,
    /// Prints errors only, and stops when standard input ends
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let link = LinkAddress::to_connect(&args.link).map_err(|e| anyhow!("--link: {e}"))?;
    let gateway = match &args.config {
        Some(path) => {
            game::scenario::load_gateway(path).with_context(|| format!("cannot drive by {}", path.display()))?
        }
        None => game::scenario::default_gateway(),
    };
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    let record = recording(args)?;
    if let (Some(path), false) = (&record, args.for_parent) {
        screen::remark(&format!("recording to {}", path.display()));
    }
    let settings = Settings {
        game: args.leaf.game.clone(),
        net: args.leaf.net()?,
        vehicle: args.vehicle.clone(),
        link,
        silence: Duration::from_secs_f64(args.silence_s),
        gateway,
        arms_itself: args.arm,
        at_game_pace: args.at_game_pace,
        record,
        commit: env!("SQUALL_COMMIT"),
        wait: Duration::from_secs_f64(args.wait_s),
        stop: stop.clone(),
    };
    let mut log = Log::new(args.for_parent);
    let mut notify = |event: NodeEvent<'_>| match event {
        NodeEvent::Looking { reason } if !args.for_parent => {
            screen::remark(&format!("{}: looking for the game: {reason}", args.vehicle));
        }
        NodeEvent::Looking { .. } | NodeEvent::Listening { .. } => {}
        NodeEvent::Event { at_s, event } => log.event(at_s, event),
        NodeEvent::Status(status) => log.status(status),
        NodeEvent::Ended(status) => screen::print(&format!("\n{}", full(status))),
    };
    gateway::node::serve(&settings, &mut notify).with_context(|| format!("the gateway of {}", args.vehicle))?;
    Ok(ExitCode::SUCCESS)
}

/// Where to record.
fn recording(args: &Args) -> Result<Option<PathBuf>> {
    if args.no_record {
        return Ok(None);
    }
    if let Some(path) = &args.record {
        return Ok(Some(path.clone()));
    }
    let folder = Path::new("runs");
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make the folder {}", folder.display()))?;
    Ok(Some(folder.join(format!("gateway-{}-{}.mcap", args.vehicle, utc::file_stamp(utc::now_ns())))))
}
