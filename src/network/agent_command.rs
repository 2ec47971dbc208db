//! `squall agent`: makes the decisions for boats in a game.

use super::join_args::JoinArgs;
use crate::screen;
use crate::stop;
use agent::node::{MindMaker, News, Settings};
use anyhow::{Context, Result};
use command_line::number::seconds;
use scenario::strategy::Strategy;
use sim::EntryFaults;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Names of the vehicles to control
    #[arg(long, required = true, num_args = 1.., value_name = "NAME")]
    vehicle: Vec<String>,
    #[command(flatten)]
    join: JoinArgs,
    /// Strategy to follow instead of the one in the sim's scenario: a file or a name
    #[arg(long, value_name = "STRATEGY", value_parser = crate::scenario_files::file_of(scenario::Kind::STRATEGY))]
    strategy: Option<PathBuf>,
    /// Lets the sim's strategies run the competition entry PATH with the interpreter PYTHON, both
    /// written as in the strategy; may be repeated. The agent runs no other programs that the sim
    /// names
    #[arg(long, num_args = 2, value_names = ["PYTHON", "PATH"])]
    host: Vec<String>,
    /// In lockstep, if the strategy uses an external policy: how long to wait for its proposal at
    /// every decision, s; at most half of the game's patience_s
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = seconds)]
    policy_wait_s: f64,
    /// Prints only errors, and the faults of competition entries as JSON lines; exits when standard
    /// input closes
    #[arg(long, hide = true)]
    for_parent: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    stop::exit_when_late(&stop);
    let names = boats_in_words(&args.vehicle);
    let load = |path: &PathBuf| {
        scenario::load_file::<Strategy>(path)
            .with_context(|| format!("cannot use the strategy {}", path.display()))
    };
    let strategy = args.strategy.as_ref().map(load).transpose()?;
    let hosts = args.host.clone();
    let minds: Box<MindMaker> = Box::new(move |scenario, boats| {
        let mut scenario = scenario.clone();
        for host in scenario.strategies.iter_mut().flat_map(Strategy::hosts_mut) {
            let own = [&host.python, &host.path];
            host.is_allowed = hosts.chunks(2).any(|pair| pair.iter().eq(own));
        }
        agent::minds_for(&scenario, boats.iter().copied(), strategy.as_ref())
    });
    let settings = Settings {
        game: args.join.leaf.game.clone(),
        place: args.join.leaf.place()?,
        vehicles: args.vehicle.clone(),
        wait: Duration::from_secs_f64(args.join.wait_s),
        silence: Duration::from_secs_f64(args.join.silence_s),
        minds: Some(minds),
        policy_wait: Duration::from_secs_f64(args.policy_wait_s),
        stop: stop.clone(),
    };
    let mut tell = |news: News<'_>| match news {
        News::Left { refused, faults } => {
            if refused.total() > 0 {
                screen::remark(&format!("{names}: refused or missed: {refused}"));
            }
            for (boat, first, count) in faults {
                if args.for_parent {
                    // The parent adds these faults to the game's result.
                    let faults = EntryFaults { boat, first, count };
                    screen::print(&(serde_json::json!(faults).to_string() + "\n"));
                } else {
                    screen::remark(&format!(
                        "{boat}: {first}; {count} decisions without an action"
                    ));
                }
            }
        }
        News::Looking { reason } if !args.for_parent => {
            screen::remark(&format!("{names}: looking for the game: {reason}"));
        }
        News::Joined { game } if !args.for_parent => {
            screen::remark(&format!("{names}: joined {game}"))
        }
        News::Looking { .. } | News::Joined { .. } => {}
    };
    agent::node::serve(&settings, &mut tell).with_context(|| format!("the agent of {names}"))?;
    let stopped = stop.load(std::sync::atomic::Ordering::Relaxed);
    Ok(if stopped {
        stop::interrupted()
    } else {
        ExitCode::SUCCESS
    })
}

/// The boats' names for messages; of many boats, only the first and the last.
pub(super) fn boats_in_words(names: &[impl AsRef<str>]) -> String {
    const LISTED: usize = 8;
    match names {
        [first, .., last] if names.len() > LISTED => {
            let (first, last) = (first.as_ref(), last.as_ref());
            format!("{first} to {last} ({} boats)", names.len())
        }
        _ => {
            let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
            names.join(", ")
        }
    }
}
