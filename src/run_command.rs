//! `squall run`: runs a whole game with one command, using any [`Player`].

use crate::both_sides::{self, BothSides};
use crate::game_args::GameArgs;
use crate::record_args::RecordArgs;
use crate::screen::{self, Screen};
use crate::style::Names;
use crate::watch_files::WatchedFiles;
use crate::{clock, explain, in_process, stop};
use anyhow::{Result, bail};
use command_line::number::whole;
use recording::NewFile;
use scenario::Scenario;
use sim::{ProgressMessage, Report, Reporter};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

#[derive(Clone, clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    play: GameArgs,
    #[command(flatten)]
    record: RecordArgs,
    /// Plays the game a second time with the strategies exchanged, and adds up the points
    #[arg(long, conflicts_with = "exchange_strategies")]
    both_sides: bool,
    /// Plays again whenever a scenario file of the game changes, until Ctrl-C
    #[arg(long)]
    watch_files: bool,
    /// Plays in this process, without a network; results are identical, byte for byte
    #[arg(long)]
    pub(crate) in_process: bool,
    /// With --in-process: number of threads that compute the boats' decisions, for large fleets;
    /// does not affect results [default: one per core]
    #[arg(long, value_name = "N", requires = "in_process", value_parser = whole::<NonZeroUsize>(1, u64::MAX))]
    pub(crate) jobs: Option<NonZeroUsize>,
}

/// The command that shows a recorded game or, in a build without the page, the command that
/// analyses it.
const LOOK: &str = if cfg!(feature = "network") {
    "squall replay"
} else {
    "squall log"
};

/// The stop flag and the screen.
pub(crate) type Shell<'a> = (&'a AtomicBool, &'a mut Screen);

/// A way of playing games.
pub(crate) trait Player {
    /// Checks, before a game begins, whether this player can play it.
    fn check(&self, scenario: &Scenario) -> Result<()>;
    /// Plays, shows and optionally records a game; returns no result if it was stopped early.
    fn play(
        &mut self,
        args: &GameArgs,
        scenario: &Scenario,
        file: Option<NewFile>,
        shell: Shell,
    ) -> Result<Option<Report>>;
    /// Cleans up after a game, which was recorded in this file and had these problems.
    fn end(&mut self, file: Option<&Path>, problems: &[String], shell: Shell);
}

/// Plays games in this process.
pub(crate) struct InProcess {
    pub(crate) jobs: Option<NonZeroUsize>,
}

/// Plays the game that the arguments describe.
pub(crate) fn run(args: &Args, player: &mut dyn Player) -> Result<ExitCode> {
    if args.watch_files {
        return play_when_saved(args, player);
    }
    let scenario = args.play.load()?;
    args.play.remark_on_rehearsal()?;
    let stop = stop::on_ctrl_c()?;
    play_once(args, player, &scenario, &stop)
}

/// Plays again whenever a file of the game changes, even if a previous version had mistakes.
fn play_when_saved(args: &Args, player: &mut dyn Player) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    loop {
        let files = Arc::default();
        let scenario = args.play.load_from(&files);
        // Take the stamps before playing, so that a change saved during the game counts.
        let read = files.list().into_iter().map(|(path, _)| path);
        let watched = WatchedFiles::new(read.chain([args.play.file().to_owned()]));
        if let Err(error) = scenario.and_then(|scenario| play_once(args, player, &scenario, &stop))
        {
            screen::complain(&explain::error(&error));
        }
        screen::remark("waiting for changes to the game's files (Ctrl-C to stop)");
        let Some(path) = watched.wait(&stop) else {
            return Ok(stop::interrupted());
        };
        screen::remark(&format!("{} has changed", path.display()));
    }
}

fn play_once(
    args: &Args,
    player: &mut dyn Player,
    scenario: &Scenario,
    stop: &AtomicBool,
) -> Result<ExitCode> {
    player.check(scenario)?;
    args.play.check_result_file()?;
    let mut screen = Screen::new(Names::of(scenario));
    if args.both_sides {
        return both_sides(args, player, scenario, (stop, &mut screen));
    }
    let (file, report) = play(args, player, scenario, (stop, &mut screen))?;
    let Some(report) = report else {
        return Ok(stop::interrupted());
    };
    let unwritten = args
        .play
        .write_result(&report)
        .err()
        .map(|error| command_line::explain::line(&error));
    let problems: Vec<String> = unwritten
        .into_iter()
        .chain(report.run.recording_problem.clone())
        .collect();
    player.end(file.as_deref(), &problems, (stop, &mut screen));
    if !problems.is_empty() {
        bail!(problems.join("; "));
    }
    Ok(if report.run.cut_short {
        stop::interrupted()
    } else {
        ExitCode::SUCCESS
    })
}

/// Plays the game and records it if requested.
fn play(
    args: &Args,
    player: &mut dyn Player,
    scenario: &Scenario,
    (stop, screen): Shell,
) -> Result<(Option<PathBuf>, Option<Report>)> {
    let file = args.record.file(scenario, args.play.seed(scenario))?;
    let path = file.as_ref().map(|file| file.path().to_owned());
    let report = player.play(&args.play, scenario, file, (stop, &mut *screen))?;
    let mut faults = BTreeMap::<&str, u64>::new();
    for boat in report.iter().flat_map(|report| &report.run.entry_faults) {
        *faults.entry(&boat.first).or_default() += boat.count;
    }
    for (first, count) in faults {
        screen::remark(&format!("{first}; {count} decisions without an action"));
    }
    let has_advantage = report
        .as_ref()
        .is_some_and(|report| report.outcome.ends_differ);
    if has_advantage && !args.both_sides && !both_sides::are_equal(scenario) {
        screen.line("to play both strategies from both ends, add --both-sides");
    }
    let file = path.filter(|path| path.exists());
    if let Some(file) = &file {
        let is_whole = report
            .as_ref()
            .is_some_and(|report| report.run.recording_problem.is_none());
        let recorded = if is_whole {
            "recorded"
        } else {
            "partly recorded"
        };
        screen.line(&format!(
            "{recorded}; show it with: {} {}",
            LOOK,
            file.display()
        ));
    }
    Ok((file, report))
}

/// Plays the game as it is and with exchanged strategies.
fn both_sides(
    args: &Args,
    player: &mut dyn Player,
    scenario: &Scenario,
    (stop, screen): Shell,
) -> Result<ExitCode> {
    let mut exchanged_args = args.clone();
    exchanged_args.play.exchange_strategies = true;
    let exchanged = exchanged_args.play.load()?;
    let sides = BothSides::new(scenario)?;
    let mut reports = vec![];
    for (args, scenario) in [(args, scenario), (&exchanged_args, &exchanged)] {
        let (_, report) = play(args, player, scenario, (stop, &mut *screen))?;
        let Some(report) = report.filter(|report| !report.run.cut_short) else {
            return Ok(stop::interrupted());
        };
        reports.push(report);
    }
    screen.line(&sides.text(&reports));
    args.play.write_results(&reports, &sides.sum(&reports))?;
    let problems: Vec<String> = reports
        .into_iter()
        .filter_map(|report| report.run.recording_problem)
        .collect();
    if problems.is_empty() {
        Ok(ExitCode::SUCCESS)
    } else {
        bail!(problems.join("; "))
    }
}

impl Player for InProcess {
    fn check(&self, scenario: &Scenario) -> Result<()> {
        Ok(scenario.has_no_real_boats()?)
    }

    fn play(
        &mut self,
        args: &GameArgs,
        scenario: &Scenario,
        file: Option<NewFile>,
        (stop, screen): Shell,
    ) -> Result<Option<Report>> {
        const SHOW_EVERY: Duration = Duration::from_millis(100);
        let mut reporter = Reporter::default();
        let mut shown = (clock::now(), 0.0);
        let threads = experiment::threads(self.jobs, scenario.vehicles.len());
        let seed = args.seed(scenario);
        let report = in_process::play(scenario, seed, file, (threads, stop), |contest| {
            // Reading the clock takes longer than a decision, so read it only occasionally.
            if contest.decision().is_multiple_of(64) && shown.0.elapsed() >= SHOW_EVERY {
                let now_s = contest.now().as_s();
                let rate = (now_s - shown.1) / shown.0.elapsed().as_secs_f64();
                shown = (clock::now(), now_s);
                reporter.progress(contest, (rate, 0), &mut |message| screen.show(&message));
            }
        })?;
        reporter.rest(&report.outcome, &mut |message| screen.show(&message));
        screen.show(&ProgressMessage::Done(Box::new(report.clone())));
        Ok(Some(report))
    }

    fn end(&mut self, _: Option<&Path>, _: &[String], _: Shell) {}
}
