//! `squall run` across processes: a sim, agents, the page, and gateways for emulated boats.

use super::agent_command::boats_in_words;
use super::child_process::{self, ChildProcess, option};
use super::hardware_loop::{HardwareLoop, LoopArgs};
use super::hub_args::{free_port, token_text, unique_game_name};
use super::pace_args::PaceArgs;
use super::page_args::PageArgs;
use crate::game_args::GameArgs;
use crate::run_command::{self, InProcess, Player, Shell};
use crate::screen::{self, Screen};
use crate::stop;
use anyhow::{Result, bail};
use bus::Token;
use bus::keys::{Bundle, Identity};
use clap::{ArgGroup, Args as _, FromArgMatches};
use command_line::explain::UsageError;
use command_line::number::whole;
use recording::{LentFile, NewFile};
use scenario::{Scenario, Vehicle};
use sim::EntryFaults;
use sim::node::{Pace, ProgressMessage, Report};
use std::path::{Path, PathBuf};
use std::process::{ExitCode, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

#[derive(clap::Args)]
#[command(group(ArgGroup::new("served").args(["pace", "speed", "agents_per_process", "keys"]).multiple(true).conflicts_with("in_process")))]
pub(crate) struct Args {
    #[command(flatten)]
    run: run_command::Args,
    #[command(flatten)]
    pace: PaceArgs,
    /// Shows the game on a page, then its recording; in lockstep, limits the speed to 10x unless
    /// --speed is given
    #[arg(long, conflicts_with_all = ["in_process", "both_sides", "watch_files"])]
    view: bool,
    #[command(flatten)]
    page: PageArgs,
    /// Number of boats per agent process
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole::<u16>(1, u64::from(u16::MAX)))]
    agents_per_process: u16,
    /// Encrypts all links and authenticates every node by certificate, with the keys in this folder
    /// (see `squall keys new`)
    #[arg(long, value_name = "FOLDER")]
    keys: Option<PathBuf>,
    #[command(flatten)]
    hardware_loop: LoopArgs,
}

/// Plays a game for the user to watch.
pub(crate) fn demo(page: &PageArgs) -> Result<ExitCode> {
    let words = [
        "run",
        "surveyor_2v2",
        "--sea",
        "fresh_breeze",
        "--blue",
        "learned",
        "--red",
        "strategy_3",
        "--view",
    ];
    let matches = Args::augment_args(clap::Command::new("demo")).try_get_matches_from(words)?;
    run(&Args {
        page: page.opened(),
        ..Args::from_arg_matches(&matches)?
    })
}

/// The maximum speed that a person can follow, simulated seconds per second.
const SPEED_TO_WATCH: f64 = 10.0;

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.page.is_given() && !args.view {
        bail!(UsageError(
            "--listen, --token, --page-token-file, --host, --chart and --open require --view"
                .to_owned()
        ));
    }
    if args.pace.join_s < 1.0 && !args.run.in_process {
        bail!(UsageError(format!(
            "--join-s is {} s, expected at least 1 s: the agents are started together with the game",
            args.pace.join_s
        )));
    }
    if args.run.in_process {
        return run_command::run(
            &args.run,
            &mut InProcess {
                jobs: args.run.jobs,
            },
        );
    }
    run_command::run(&args.run, &mut Processes { args, page: None })
}

/// Plays games in a sim process and agent processes.
struct Processes<'a> {
    args: &'a Args,
    /// The process that shows the game, if requested.
    page: Option<ChildProcess>,
}

impl Player for Processes<'_> {
    fn check(&self, scenario: &Scenario) -> Result<()> {
        if self.args.pace.pace == Pace::Lockstep {
            scenario.has_no_real_boats()?;
        }
        check_keys(self.args, scenario)?;
        child_process::check_token()?;
        if self.args.view {
            self.args.page.check()
        } else {
            Ok(())
        }
    }

    fn play(
        &mut self,
        play: &GameArgs,
        scenario: &Scenario,
        file: Option<NewFile>,
        (stop, screen): Shell,
    ) -> Result<Option<Report>> {
        let args = self.args;
        let port = free_port(false)?;
        let game = unique_game_name(&scenario.name)?.as_str().to_owned();
        let endpoint = format!("tcp/127.0.0.1:{port}");
        let place = (game.as_str(), endpoint.as_str());
        // The sim writes the file; this process removes it if it remains empty.
        let file = file.map(NewFile::lend);
        let mut sim = start_sim((args, play), place, file.as_ref().map(LentFile::path))?;
        let messages = sim.lines(|line| serde_json::from_str(line).ok())?;
        self.page = if args.view {
            Some(start_page(args, &game, &endpoint)?)
        } else {
            None
        };
        let mut agents = start_agents(args, scenario, &game, &endpoint)?;
        let faults = agents.iter_mut().map(|agent| agent.lines(faults_of));
        let faults = faults.collect::<Result<Vec<_>>>()?;
        let hardware_loop =
            args.hardware_loop
                .start((play, &args.pace), scenario, place, args.keys.as_deref())?;
        let token = args.keys.is_none().then(child_process::token);
        let mut report = follow(
            &messages,
            (&mut sim, self.page.as_mut(), token),
            stop,
            screen,
        )?;
        let mut problems = hardware_loop.map(HardwareLoop::end).unwrap_or_default();
        let mut everybody = agents;
        everybody.push(sim);
        problems.extend(child_process::wait_for_all(&mut everybody));
        for problem in problems {
            if !stop.load(Ordering::Relaxed) {
                screen::remark(&problem);
            }
        }
        // Kill the agents that are still searching for the game: their output would never end.
        drop(everybody);
        if let Some(report) = &mut report {
            report.run.entry_faults = faults.iter().flatten().collect();
        }
        if report.is_none() && !stop.load(Ordering::Relaxed) {
            bail!("the sim ended without a result");
        }
        Ok(report)
    }

    fn end(&mut self, file: Option<&Path>, problems: &[String], (stop, screen): Shell) {
        let Some(mut page) = self.page.take() else {
            return;
        };
        problems.iter().for_each(|problem| screen::remark(problem));
        screen.line("the game is over; the page stays open until Ctrl-C");
        // The sim has ended, so the recording is complete.
        if let (Some(file), false) = (file, stop::is_set_soon(stop))
            && let Err(error) = page.send(&file.display().to_string())
        {
            screen::remark(&command_line::explain::line(&error));
        }
        while page.ended().is_none() && !stop::is_set_soon(stop) {}
        page.stop();
    }
}

/// Checks that the keys of all parts of the game exist.
fn check_keys(args: &Args, scenario: &Scenario) -> Result<()> {
    let Some(folder) = &args.keys else {
        return Ok(());
    };
    let mut parts = vec![Identity::Sim];
    parts.extend(
        scenario
            .teams
            .iter()
            .map(|team| Identity::Team(team.name.clone())),
    );
    parts.extend(args.view.then_some(Identity::Operator));
    parts.extend(scenario.externals().next().map(|_| Identity::Gateway(None)));
    parts
        .iter()
        .try_for_each(|part| Bundle::load(&folder.join(part.to_string())).map(drop))?;
    Ok(())
}

fn start_page(args: &Args, game: &str, endpoint: &str) -> Result<ChildProcess> {
    let mut command = child_process::squall(&["view", "--game", game, "--connect", endpoint])?;
    // The page has the operator's keys; what its viewers may do depends on the page's token.
    child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Operator);
    args.page.give_to(&mut command);
    ChildProcess::start("the page", command, Stdio::inherit())
}

fn start_sim(
    (args, play): (&Args, &GameArgs),
    (game, endpoint): (&str, &str),
    file: Option<&Path>,
) -> Result<ChildProcess> {
    let mut command = args.pace.sim(play, game, endpoint)?;
    let speed = args
        .pace
        .speed
        .or((args.view && args.pace.pace == Pace::Lockstep).then_some(SPEED_TO_WATCH));
    option(&mut command, "--join-s", Some(args.pace.join_s));
    option(&mut command, "--speed", speed);
    child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Sim);
    option(&mut command, "--record", file.map(Path::display));
    ChildProcess::start("the sim", command, Stdio::piped())
}

/// Parses the line with which an agent reports faults of a boat's competition entry.
fn faults_of(line: &str) -> Option<EntryFaults> {
    serde_json::from_str(line).ok()
}

/// The number of boats for one agent process: the requested number, or more if that would start
/// more than 64 processes. It does not affect the game.
fn crew_size(asked: u16, vehicles: usize) -> usize {
    const PROCESSES_MAX: usize = 64;
    usize::from(asked).max(vehicles.div_ceil(PROCESSES_MAX))
}

/// Starts the agent processes. With keys, each process serves a single team. A team with a
/// competition entry, which is a program for the whole team, has one process.
fn start_agents(
    args: &Args,
    scenario: &Scenario,
    game: &str,
    endpoint: &str,
) -> Result<Vec<ChildProcess>> {
    let mut vehicles: Vec<&Vehicle> = scenario.vehicles.iter().collect();
    let hosts = |vehicle: &Vehicle| scenario.strategies[vehicle.strategy].hosts();
    let is_by_team = args.keys.is_some() || vehicles.iter().any(|v| hosts(v).next().is_some());
    let is_together = |one: &&Vehicle, other: &&Vehicle| !is_by_team || one.team == other.team;
    if is_by_team {
        vehicles.sort_by_key(|vehicle| vehicle.team);
    }
    let size = crew_size(args.agents_per_process, vehicles.len());
    let size_of = |crew: &[&Vehicle]| match crew.iter().any(|v| hosts(v).next().is_some()) {
        true => crew.len(),
        false => size,
    };
    let crews = vehicles
        .chunk_by(is_together)
        .flat_map(|crew| crew.chunks(size_of(crew)));
    let start = |crew: &[&Vehicle]| {
        let names: Vec<&str> = crew.iter().map(|vehicle| vehicle.name.as_str()).collect();
        let mut command = child_process::squall(&["agent", "--game", game, "--connect", endpoint])?;
        let team = scenario.teams[crew[0].team.index()].name.clone();
        child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Team(team));
        command.arg("--vehicle").args(&names);
        for host in crew.iter().flat_map(|vehicle| hosts(vehicle)) {
            command.args(["--host", &host.python, &host.path]);
        }
        ChildProcess::start(
            &format!("the agent of {}", boats_in_words(&names)),
            command,
            Stdio::piped(),
        )
    };
    crews.map(start).collect()
}

/// Shows the sim's progress until it reports the result or exits. If the page fails before the game
/// has started, no game is played.
fn follow(
    messages: &Receiver<ProgressMessage>,
    (sim, mut page, token): (&mut ChildProcess, Option<&mut ChildProcess>, Option<&Token>),
    stop: &AtomicBool,
    screen: &mut Screen,
) -> Result<Option<Report>> {
    let mut asked = 0;
    loop {
        match messages.recv_timeout(Duration::from_millis(100)) {
            Ok(message) => {
                screen.show(&message);
                match message {
                    ProgressMessage::Open { .. } => token
                        .into_iter()
                        .for_each(|token| screen.line(&token_text(token))),
                    ProgressMessage::Started => page = None,
                    ProgressMessage::Done(report) => return Ok(Some(*report)),
                    _ => {}
                }
            }
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
        }
        // The page's last output has been printed above.
        if let Some(problem) = page.as_mut().and_then(|page| page.ended()).flatten() {
            bail!(problem);
        }
        if stop.load(Ordering::Relaxed) {
            sim.ask_to_stop();
            asked += 1;
            // After more than three seconds, at ten polls a second, stop waiting, which kills the
            // sim.
            if asked > 30 {
                return Ok(None);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::crew_size;

    #[test]
    fn thousands_of_boats_do_not_start_thousands_of_agents() {
        for (asked, vehicles, want) in [
            (1, 4, 1),
            (1, 64, 1),
            (1, 65, 2),
            (1, 10_000, 157),
            (500, 10_000, 500),
        ] {
            assert_eq!(crew_size(asked, vehicles), want, "{vehicles} boats");
        }
    }
}
