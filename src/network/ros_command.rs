//! `squall ros`: a game as ROS 2 nodes, and the package with its messages.

use crate::screen;
use crate::stop;
use anyhow::{Context, Result, anyhow};
use clap::Subcommand;
use command_line::leaf_args::LeafArgs;
use command_line::number::{endpoint, seconds, whole};
use primitives::SimTime;
use ros::node::{News, Settings};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Publishes a running game to ROS 2 over rmw_zenoh, and drives boats from its topics.
    Bridge(Box<BridgeArgs>),
    /// Writes the package squall_msgs for a colcon workspace.
    Messages {
        /// Folder for the package, for example src/squall_msgs
        folder: PathBuf,
    },
}

#[derive(clap::Args)]
struct BridgeArgs {
    /// Names of the boats that ROS 2 drives by /NAME/cmd_vel or /NAME/order
    #[arg(long, num_args = 1.., value_name = "NAME")]
    vehicle: Vec<String>,
    /// How long an order to a boat is valid, s of game time
    #[arg(long, value_name = "S", default_value_t = 0.5, value_parser = seconds)]
    ttl_s: f64,
    /// Hides the true state from ROS 2: publishes no truth topics and no markers of boats
    #[arg(long)]
    no_truth: bool,
    /// Lets every ROS 2 node pause, resume, step, reset and end the game and release stops, using
    /// the bridge's own token or keys
    #[arg(long)]
    operator: bool,
    /// Endpoint of the ROS 2 router (rmw_zenohd); if none is running on this machine, the bridge
    /// acts as the router
    #[arg(long, value_name = "ENDPOINT", default_value = "tcp/127.0.0.1:7447", value_parser = endpoint)]
    router: String,
    /// ROS domain [default: ROS_DOMAIN_ID, or 0]
    #[arg(long, value_name = "NUMBER", value_parser = domain)]
    domain: Option<u32>,
    #[command(flatten)]
    leaf: LeafArgs,
    /// How long to look for the sim and wait for its boats to become free, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    wait_s: f64,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    match &args.command {
        Command::Bridge(args) => bridge(args),
        Command::Messages { folder } => {
            ros::package::write(folder)
                .with_context(|| format!("cannot write {}", folder.display()))?;
            screen::remark(&format!(
                "wrote the package squall_msgs to {}",
                folder.display()
            ));
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// Parses a ROS domain.
fn domain(text: &str) -> Result<u32, String> {
    whole(0, 232)(text)
}

impl BridgeArgs {
    /// The ROS domain, from the same variable as for ROS 2 nodes.
    fn domain(&self) -> Result<u32> {
        let variable = std::env::var("ROS_DOMAIN_ID")
            .ok()
            .filter(|text| !text.is_empty());
        let of_variable = || {
            variable.map_or(Ok(0), |text| {
                domain(&text).map_err(|e| anyhow!("ROS_DOMAIN_ID: {e}"))
            })
        };
        self.domain.map_or_else(of_variable, Ok)
    }
}

fn bridge(args: &BridgeArgs) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    stop::exit_when_late(&stop);
    let settings = Settings {
        game: args.leaf.game.clone(),
        place: args.leaf.place()?,
        router: args.router.clone(),
        domain: args.domain()?,
        vehicles: args.vehicle.clone(),
        ttl: SimTime::from_s(args.ttl_s),
        shows_truth: !args.no_truth,
        is_operator: args.operator,
        wait: Duration::from_secs_f64(args.wait_s),
        stop: stop.clone(),
    };
    let mut tell = |news: News<'_>| match news {
        News::OnRos { is_router: true } => screen::remark(&format!(
            "no router at {}: the bridge is acting as the router",
            args.router
        )),
        News::OnRos { is_router: false } => {
            screen::remark(&format!("connected to the router at {}", args.router))
        }
        News::Looking { reason } => screen::remark(&format!("looking for the game: {reason}")),
        News::Showing { game } => screen::remark(&format!("publishing game {game} to ROS 2")),
        News::Refused { refused } => screen::remark(&format!("refused: {refused}")),
    };
    ros::node::serve(&settings, &mut tell).context("the ROS 2 bridge")?;
    let stopped = stop.load(std::sync::atomic::Ordering::Relaxed);
    Ok(if stopped {
        stop::interrupted()
    } else {
        ExitCode::SUCCESS
    })
}
