//! Commands that need a network or show a page (feature `network`).

mod agent_command;
mod child_process;
mod gateway_command;
mod hardware_loop;
mod helm_command;
mod helm_page;
mod helm_query;
mod hub_args;
mod join_args;
mod keys_command;
mod list_command;
mod moos_command;
mod pace_args;
mod page_args;
mod replay_command;
mod replay_futures;
mod replay_helms;
mod ros_command;
mod run_command;
mod sim_command;
mod view_command;
mod watch_command;

use anyhow::Result;
use clap::Subcommand;
use command_line::leaf_args;
use std::process::ExitCode;

/// The commands.
#[derive(Subcommand)]
pub(crate) enum Command {
    /// Shows a game in strong wind in the browser.
    #[command(
        after_help = "Examples:\n  squall demo\n  SQUALL_PAGE_TOKEN=secret squall demo --listen 0.0.0.0:8088"
    )]
    Demo(page_args::PageArgs),
    /// Plays a whole game: starts the simulation and the agents, shows events, and prints the
    /// result.
    #[command(
        after_help = "Examples:\n  squall run strategy_4_vs_3\n  squall run surveyor_2v2 --sea fresh_breeze --blue learned --view\n  squall run strategy_4_vs_3 --set link.delay_s=1 --seed 7 --both-sides"
    )]
    Run(run_command::Args),
    /// Simulates and serves one game, which agents and gateways join.
    #[command(
        after_help = "Examples:\n  squall sim surveyor_2v2 --game mine --listen tcp/0.0.0.0:7447 --insecure"
    )]
    Sim(sim_command::Args),
    /// Controls one or more boats in a game served by another process.
    #[command(
        after_help = "Examples:\n  squall agent --vehicle blue_1 --game mine --connect tcp/10.0.0.5:7447"
    )]
    Agent(agent_command::Args),
    /// Shows a running game, or one boat's helm, in the terminal.
    #[command(
        after_help = "Examples:\n  squall watch\n  squall watch --game mine --connect tcp/10.0.0.5:7447"
    )]
    Watch(watch_command::Args),
    /// Shows a running game, or a report with its games, in the browser.
    #[command(
        after_help = "Examples:\n  squall view\n  squall view report.json\n  squall view runs/sweep/wind\n  squall view runs/train/first\n  SQUALL_PAGE_TOKEN=secret squall view --listen 0.0.0.0:8088"
    )]
    View(view_command::Args),
    /// Replays a recorded game, or verifies that a rerun reproduces it.
    #[command(after_help = "Examples:\n  squall replay\n  squall replay strategy_4_vs_3 --check")]
    Replay(replay_command::Args),
    /// Prints one decision of a boat's helm as a table; with --csv, also writes it to a file.
    #[command(after_help = "Examples:\n  squall helm --vehicle blue_1 --csv helm.csv")]
    Helm(helm_command::Args),
    /// Brings real boats into games, and lets real back seats drive simulated boats.
    #[command(
        after_help = "Examples:\n  squall gateway emulate --help\n  squall gateway surveyor --help"
    )]
    Gateway(gateway_command::Args),
    /// Connects MOOS applications to a game: a MOOSDB for each boat, and one for pMarineViewer.
    #[command(
        after_help = "Examples:\n  squall moos --team blue\n  squall moos --vehicle blue_one=:9001 blue_two=tcp/localhost:9002 --shore :9000"
    )]
    Moos(moos_command::Args),
    /// Exposes a running game to ROS 2 as nodes, topics and services.
    #[command(
        after_help = "Examples:\n  squall ros bridge\n  squall ros bridge --vehicle blue_1 --operator\n  squall ros messages src/squall_msgs"
    )]
    Ros(ros_command::Args),
    /// Creates keys for untrusted networks: they encrypt links and define each node's rights.
    #[command(after_help = "Examples:\n  squall keys new keys --help")]
    Keys(keys_command::Args),
    /// Lists the games on the network and their states.
    #[command(after_help = "Examples:\n  squall list\n  squall list --connect tcp/10.0.0.5:7447")]
    List(list_command::Args),
}

pub(crate) fn run(command: &Command) -> Result<ExitCode> {
    // `run` only passes keys on: its children without keys must not inherit the thread settings of
    // those with keys.
    if !matches!(command, Command::Run(_) | Command::Demo(_)) {
        leaf_args::restart_with_threads_for_keys()?;
    }
    match command {
        Command::Demo(args) => run_command::demo(args),
        Command::Run(args) => run_command::run(args),
        Command::Sim(args) => sim_command::run(args),
        Command::Agent(args) => agent_command::run(args),
        Command::Watch(args) => watch_command::run(args),
        Command::View(args) => view_command::run(args),
        Command::Replay(args) => replay_command::run(args),
        Command::Helm(args) => helm_command::run(args),
        Command::Gateway(args) => gateway_command::run(args),
        Command::Moos(args) => moos_command::run(args),
        Command::Ros(args) => ros_command::run(args),
        Command::Keys(args) => keys_command::run(args),
        Command::List(args) => list_command::run(args),
    }
}
