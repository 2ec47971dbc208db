//! `squall run`: a whole game from one command.

use crate::both_sides::BothSides;
use crate::child_process::{self, ChildProcess, option};
use crate::explain;
use crate::game_args::GameArgs;
use crate::hardware_loop::{HardwareLoop, LoopArgs};
use crate::in_process;
use crate::net_args::{token_text, unique_game_name};
use crate::page_args::PageArgs;
use crate::record_args::RecordArgs;
use crate::screen::{self, Screen};
use crate::stop;
use crate::style::Names;
use crate::watch_files::WatchedFiles;
use anyhow::{Result, anyhow, bail};
use bus::keys::{Bundle, Identity};
use bus::{Token, clock};
use clap::{Args as _, FromArgMatches};
use game::Scenario;
use game::scenario::Vehicle;
use sim::node::{Pace, ProgressMessage, Report, Reporter};
use std::path::{Path, PathBuf};
use std::process::{ExitCode, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// What to play, and how.
#[derive(Clone, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    play: GameArgs,
    #[command(flatten)]
    record: RecordArgs,
    /// Shows the game on a page, and its recording when it is over; in lockstep at 10x unless --speed says otherwise
    #[arg(long, conflicts_with = "in_process")]
    view: bool,
    #[command(flatten)]
    page: PageArgs,
    /// Plays the game twice, the second time with the strategies exchanged, and adds up the points
    #[arg(long, conflicts_with_all = ["view", "exchange_strategies"])]
    both_sides: bool,
    /// Plays again whenever a file of the game is saved, until Ctrl-C
    #[arg(long, conflicts_with = "view")]
    watch_files: bool,
    /// Plays in this process, without a network: the same game, byte for byte
    #[arg(long, conflicts_with_all = ["pace", "speed", "agents_per_process"])]
    in_process: bool,
    /// For how many boats one agent process decides
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    agents_per_process: u16,
    /// Plays with the keys in this folder, as `squall keys new` makes them: links are encrypted, and all show certificates
    #[arg(long, value_name = "FOLDER", conflicts_with = "in_process")]
    keys: Option<PathBuf>,
    #[command(flatten)]
    hardware_loop: LoopArgs,
}

/// Where the page is served.
#[derive(clap::Args)]
pub(crate) struct DemoArgs {
    #[command(flatten)]
    page: PageArgs,
}

/// Plays a game for people who want to see one.
pub(crate) fn demo(args: &DemoArgs) -> Result<ExitCode> {
    let words = ["run", "surveyor_2v2", "--sea", "fresh_breeze", "--blue", "learned", "--red", "strategy_3", "--view"];
    let words = words.into_iter().map(str::to_owned).chain(args.page.opened().words());
    let matches = Args::augment_args(clap::Command::new("demo")).try_get_matches_from(words)?;
    run(&Args::from_arg_matches(&matches)?)
}

/// As fast as a person can follow a game, simulated seconds a second.
const SPEED_TO_WATCH: f64 = 10.0;

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    if args.watch_files {
        return play_when_saved(args);
    }
    let scenario = args.play.load()?;
    let stop = stop::on_ctrl_c()?;
    play_once(args, &scenario, &stop)
}

/// Plays, and plays again when a file of the game has changed. A file with mistakes is no reason to end.
fn play_when_saved(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    loop {
        let files = Arc::default();
        let scenario = args.play.load_from(&files);
        // As they are before it is played: what is saved meanwhile counts.
        let read = files.list().into_iter().map(|(path, _)| path);
        let watched = WatchedFiles::new(read.chain([args.play.file().to_owned()]));
        if let Err(error) = scenario.and_then(|scenario| play_once(args, &scenario, &stop)) {
            screen::complain(&explain::error(&error));
        }
        screen::remark("waiting for a file of the game to be saved (Ctrl-C ends it)");
        let Some(path) = watched.wait(&stop) else { return Ok(stop::interrupted()) };
        screen::remark(&format!("{} has changed", path.display()));
    }
}

fn play_once(args: &Args, scenario: &Scenario, stop: &AtomicBool) -> Result<ExitCode> {
    if args.in_process || args.play.pace == Pace::Lockstep {
        scenario.has_no_real_boats()?;
    }
    if args.page.is_given() && !args.view {
        bail!("--listen, --token, --host and --open say how the page is served: they need --view");
    }
    args.play.check_result_file()?;
    check_keys(args, scenario)?;
    if args.view {
        args.page.check()?;
    }
    let mut screen = Screen::new(Names::of(scenario));
    if args.both_sides {
        return both_sides(args, scenario, (stop, &mut screen));
    }
    let (file, report, page) = play(args, scenario, (stop, &mut screen))?;
    let Some(report) = report else { return Ok(stop::interrupted()) };
    let unwritten = args.play.write_result(&report).err().map(|error| format!("{error:#}"));
    let problems: Vec<String> = unwritten.into_iter().chain(report.run.recording_problem.clone()).collect();
    if let Some(mut page) = page {
        problems.iter().for_each(|problem| screen::remark(problem));
        screen.line("the game is over; the page stays until Ctrl-C");
        // The sim has ended, so that the recording is whole.
        if let (Some(file), false) = (&file, stop::is_set_soon(stop))
            && let Err(error) = page.send(&file.display().to_string())
        {
            screen::remark(&format!("{error:#}"));
        }
        while page.ended().is_none() && !stop::is_set_soon(stop) {}
        page.stop();
    }
    if !problems.is_empty() {
        bail!(problems.join("; "));
    }
    Ok(if report.run.cut_short { stop::interrupted() } else { ExitCode::SUCCESS })
}

/// The game, and where it is recorded.
fn play(
    args: &Args,
    scenario: &Scenario,
    (stop, screen): (&AtomicBool, &mut Screen),
) -> Result<(Option<PathBuf>, Option<Report>, Option<ChildProcess>)> {
    let file = args.record.file(scenario, args.play.seed(scenario))?;
    let (report, page) = if args.in_process {
        (Some(play_here(args, scenario, file.as_deref(), (stop, &mut *screen))?), None)
    } else {
        play_across_processes(args, scenario, file.as_deref(), (stop, &mut *screen))?
    };
    let file = file.filter(|file| file.exists());
    if let Some(file) = &file {
        let is_whole = report.as_ref().is_some_and(|report| report.run.recording_problem.is_none());
        let recorded = if is_whole { "recorded" } else { "recorded in part" };
        screen.line(&format!("{recorded}; look at it with: squall replay {}", file.display()));
    }
    Ok((file, report, page))
}

/// The game as it is, and with the strategies exchanged.
fn both_sides(args: &Args, scenario: &Scenario, (stop, screen): (&AtomicBool, &mut Screen)) -> Result<ExitCode> {
    let mut exchanged_args = args.clone();
    exchanged_args.play.exchange_strategies = true;
    let exchanged = exchanged_args.play.load()?;
    let sides = BothSides::new(scenario, &exchanged)?;
    let mut reports = vec![];
    for (args, scenario) in [(args, scenario), (&exchanged_args, &exchanged)] {
        let (_, report, _) = play(args, scenario, (stop, &mut *screen))?;
        let Some(report) = report.filter(|report| !report.run.cut_short) else { return Ok(stop::interrupted()) };
        reports.push(report);
    }
    screen.line(&sides.text(&reports));
    args.play.write_results(&reports, &sides.sum(&reports))?;
    let problems: Vec<String> = reports.into_iter().filter_map(|report| report.run.recording_problem).collect();
    if problems.is_empty() { Ok(ExitCode::SUCCESS) } else { bail!(problems.join("; ")) }
}

/// Whether the keys of all parts of the game are there.
fn check_keys(args: &Args, scenario: &Scenario) -> Result<()> {
    let Some(folder) = &args.keys else { return Ok(()) };
    let mut parts = vec![Identity::Sim];
    parts.extend(scenario.teams.iter().map(|team| Identity::Team(team.name.clone())));
    parts.extend(args.view.then_some(Identity::Operator));
    parts.extend(scenario.externals().next().map(|_| Identity::Gateway(None)));
    parts.iter().try_for_each(|part| Bundle::load(&folder.join(part.to_string())).map(drop))?;
    Ok(())
}

/// The game in this process.
fn play_here(
    args: &Args,
    scenario: &Scenario,
    file: Option<&Path>,
    (stop, screen): (&AtomicBool, &mut Screen),
) -> Result<Report> {
    const SHOW_EVERY: Duration = Duration::from_millis(100);
    let mut reporter = Reporter::default();
    let mut shown = (clock::now(), 0.0);
    let report = in_process::play(scenario, args.play.seed(scenario), file, stop, |contest| {
        // The clock is slower than a decision: look at it now and then.
        if contest.decision().is_multiple_of(64) && clock::since(shown.0) >= SHOW_EVERY {
            let now_s = contest.now().as_s();
            let rate = (now_s - shown.1) / clock::since(shown.0).as_secs_f64();
            shown = (clock::now(), now_s);
            reporter.progress(contest, (rate, 0), &mut |message| screen.show(&message));
        }
    })?;
    reporter.rest(&report.outcome, &mut |message| screen.show(&message));
    screen.show(&ProgressMessage::Done(Box::new(report.clone())));
    Ok(report)
}

/// The game in a sim process and agent processes, and the page that shows it; no result if it was stopped before.
fn play_across_processes(
    args: &Args,
    scenario: &Scenario,
    file: Option<&Path>,
    (stop, screen): (&AtomicBool, &mut Screen),
) -> Result<(Option<Report>, Option<ChildProcess>)> {
    let port = bus::free_port(false).map_err(|e| anyhow!("no free port on this machine: {e}"))?;
    let game = unique_game_name(&scenario.name)?.as_str().to_owned();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let mut sim = start_sim(args, &game, &endpoint, file)?;
    let messages = sim.lines(|line| serde_json::from_str(line).ok())?;
    let mut page = if args.view { Some(start_page(args, &game, &endpoint)?) } else { None };
    let agents = start_agents(args, scenario, &game, &endpoint)?;
    let hardware_loop = args.hardware_loop.start(&args.play, scenario, (&game, &endpoint), args.keys.as_deref())?;
    let token = args.keys.is_none().then(child_process::token);
    let report = follow(&messages, (&mut sim, page.as_mut(), token), stop, screen)?;
    let mut problems = hardware_loop.map(HardwareLoop::end).unwrap_or_default();
    let mut everybody = agents;
    everybody.push(sim);
    problems.extend(child_process::wait_for_all(&mut everybody));
    for problem in problems {
        if !stop.load(Ordering::Relaxed) {
            screen::remark(&problem);
        }
    }
    if report.is_none() && !stop.load(Ordering::Relaxed) {
        bail!("the sim ended without a result");
    }
    Ok((report, page))
}

fn start_page(args: &Args, game: &str, endpoint: &str) -> Result<ChildProcess> {
    let mut command = child_process::squall(&["view", "--game", game, "--connect", endpoint])?;
    // Whoever looks at it may do what the page's own token allows.
    child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Operator);
    command.args(args.page.words());
    ChildProcess::start("the page", command, Stdio::inherit())
}

fn start_sim(args: &Args, game: &str, endpoint: &str, file: Option<&Path>) -> Result<ChildProcess> {
    let mut command = args.play.sim(game, endpoint)?;
    let speed = args.play.speed.or((args.view && args.play.pace == Pace::Lockstep).then_some(SPEED_TO_WATCH));
    option(&mut command, "--join-s", Some(args.play.join_s));
    option(&mut command, "--speed", speed);
    child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Sim);
    option(&mut command, "--record", file.map(Path::display));
    ChildProcess::start("the sim", command, Stdio::piped())
}

/// Starts the agent processes. With keys, each is of one team.
fn start_agents(args: &Args, scenario: &Scenario, game: &str, endpoint: &str) -> Result<Vec<ChildProcess>> {
    let mut vehicles: Vec<&Vehicle> = scenario.vehicles.iter().collect();
    let is_together = |one: &&Vehicle, other: &&Vehicle| args.keys.is_none() || one.team == other.team;
    if args.keys.is_some() {
        vehicles.sort_by_key(|vehicle| vehicle.team);
    }
    let crews = vehicles.chunk_by(is_together).flat_map(|crew| crew.chunks(usize::from(args.agents_per_process)));
    let start = |crew: &[&Vehicle]| {
        let names: Vec<&str> = crew.iter().map(|vehicle| vehicle.name.as_str()).collect();
        let mut command = child_process::squall(&["agent", "--game", game, "--connect", endpoint])?;
        let team = scenario.teams[crew[0].team.index()].name.clone();
        child_process::give_keys(&mut command, args.keys.as_deref(), &Identity::Team(team));
        command.arg("--vehicle").args(&names);
        ChildProcess::start(&format!("the agent of {}", names.join(", ")), command, Stdio::null())
    };
    crews.map(start).collect()
}

/// Shows what the sim reports until it has reported the result, or has ended. Without the page that was asked for no game
/// begins.
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
                    ProgressMessage::Open { .. } => token.into_iter().for_each(|token| screen.line(&token_text(token))),
                    ProgressMessage::Started => page = None,
                    ProgressMessage::Done(report) => return Ok(Some(*report)),
                    _ => {}
                }
            }
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
            Err(RecvTimeoutError::Timeout) => {}
        }
        // Its last words stand above.
        if let Some(problem) = page.as_mut().and_then(|page| page.ended()).flatten() {
            bail!(problem);
        }
        if stop.load(Ordering::Relaxed) {
            sim.ask_to_stop();
            asked += 1;
            // Three seconds and more at ten looks a second: then it is killed.
            if asked > 30 {
                return Ok(None);
            }
        }
    }
}
