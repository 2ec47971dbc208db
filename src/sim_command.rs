//! `squall sim`: serves one game.

use crate::net_args::{HubArgs, unique_game_name};
use crate::override_args::OverrideArgs;
use crate::record_args;
use crate::screen::{self, Screen};
use crate::stop;
use anyhow::{Context, Result};
use game::Scenario;
use game::scenario::Overrides;
use game::topic::GameName;
use sim::node::{GameRecorder, Pace, ProgressMessage, Report, Settings};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// What to serve, and how.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The game file
    scenario: PathBuf,
    /// Chooses the game [default: as the file says]
    #[arg(long)]
    seed: Option<u64>,
    #[command(flatten)]
    instead: OverrideArgs,
    /// lockstep, realtime, or a factor such as 4x
    #[arg(long, default_value = "lockstep")]
    pace: Pace,
    /// In lockstep: plays no faster than this many times real time, until somebody asks for another speed
    #[arg(long, value_name = "FACTOR", value_parser = speed)]
    speed: Option<f64>,
    /// Records the game into this new file
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// The game's name on the network [default: the file's name and a random number]
    #[arg(long, value_name = "NAME", value_parser = GameName::new)]
    game: Option<GameName>,
    /// How long to wait for agents, and for gateways of real boats, before starting without the missing ones, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = seconds)]
    join_s: f64,
    /// Serves only the water of the game, with these of its boats in it and nobody who judges: for gateway emulate
    #[arg(long, value_name = "NAME", num_args = 1..)]
    afloat: Vec<String>,
    #[command(flatten)]
    hub: HubArgs,
    /// Writes the result to this file
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Reports everything as JSON lines on standard output, and stops when standard input ends
    #[arg(long, hide = true)]
    for_parent: bool,
}

/// A number of seconds from the command line.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("{text:?} is not a number of seconds"))?;
    if (0.0..=1e6).contains(&seconds) { Ok(seconds) } else { Err(format!("{text} is not within 0 to 1000000 s")) }
}

/// A speed from the command line, as in `10x` or `0.5`.
pub(crate) fn speed(text: &str) -> Result<f64, String> {
    let factor = text.strip_suffix('x').unwrap_or(text).parse().ok();
    let factor = factor.filter(|factor| (0.01..=1000.0).contains(factor));
    factor.ok_or_else(|| format!("speed {text:?} is not a factor from 0.01x to 1000x such as 10x"))
}

/// The scenario in a file, some files of its own replaced, with every problem in the error.
pub(crate) fn load(path: &Path, overrides: &Overrides) -> Result<Scenario> {
    game::scenario::load_with(path, overrides).with_context(|| format!("cannot play {}", path.display()))
}

/// Writes the result of a game to a file.
pub(crate) fn write_json(path: &Path, report: &Report) -> Result<()> {
    let mut value = serde_json::to_value(&report.outcome).context("the result is not JSON")?;
    value["run"] = serde_json::to_value(&report.run).context("the result is not JSON")?;
    let text = serde_json::to_string_pretty(&value).context("the result is not JSON")?;
    std::fs::write(path, text + "\n").with_context(|| format!("cannot write the result to {}", path.display()))
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let scenario = load(&args.scenario, &args.instead.overrides(&args.scenario)?)?;
    let seed = args.seed.unwrap_or(scenario.seed);
    let scenario = if args.afloat.is_empty() { scenario } else { sim::afloat(&scenario, seed, &args.afloat)? };
    let stop = stop::on_ctrl_c_or_parent(args.for_parent)?;
    let game = match &args.game {
        Some(game) => game.clone(),
        None => unique_game_name(&scenario.name)?,
    };
    let mut screen = Screen::new();
    let mut show = |message: &ProgressMessage| {
        if args.for_parent {
            screen::print(&(serde_json::to_string(message).expect("a message is JSON") + "\n"));
        } else {
            screen.show(message);
        }
    };
    let mut registration = None;
    let record = |path: &PathBuf| {
        GameRecorder::on_network(path.clone(), game.as_str(), &args.pace.to_string(), env!("SQUALL_COMMIT"))
            .with_context(|| format!("cannot record into {}", path.display()))
    };
    let mut recorder = args.record.as_ref().map(record).transpose()?;
    let settings = Settings {
        game,
        net: args.hub.net()?,
        pace: args.pace,
        join_limit: Duration::from_secs_f64(args.join_s),
        speed: args.speed,
        stop: stop.clone(),
    };
    let report = sim::node::serve(&scenario, seed, &settings, recorder.as_mut(), &mut |message| {
        if let ProgressMessage::Open { game, endpoint } = &message {
            let entry = bus::Entry { game: game.clone(), endpoint: endpoint.clone(), pid: std::process::id() };
            // Where it cannot be registered, others must be told where the game is; nothing else is lost.
            registration = bus::register(&entry).ok();
        }
        show(&message);
    })?;
    drop(registration);
    if let Some(problem) = recorder.and_then(|recorder| record_args::problem(&recorder.end(&report))) {
        screen::remark(&problem);
    }
    if let Some(path) = &args.json {
        write_json(path, &report)?;
    }
    let cut_short = report.run.cut_short;
    show(&ProgressMessage::Done(Box::new(report)));
    Ok(if cut_short { stop::interrupted() } else { ExitCode::SUCCESS })
}
