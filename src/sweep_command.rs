//! `squall sweep`: measures how much sea, noise and failure a team tolerates.

use crate::jobs_args::JobsArgs;
use crate::progress::{Progress, tell_rounded};
use crate::{output_file, screen, stop};
use anyhow::{Context, Result};
use command_line::number::whole;
use experiment::sweep::{self, Plan, Study, Sweep};
use scenario::{Kind, argument_for, load_file};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Sweep to run: a file or a name
    #[arg(value_parser = crate::scenario_files::file_of(Kind::of::<Sweep>()))]
    sweep: PathBuf,
    /// Games per entry and point, half of them on each side [default: the number in the file]
    #[arg(long, value_name = "N", value_parser = whole::<u32>(2, 1_000_000))]
    games: Option<u32>,
    /// First seed [default: the seed in the file]
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0, i64::MAX as u64))]
    seed: Option<u64>,
    #[command(flatten)]
    jobs: JobsArgs,
    /// Folder for the tables and the report [default: runs/sweep/NAME]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Resumes the sweep in the output folder; the results are the same as without interruption
    #[arg(long)]
    resume: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let plan = planned(args)?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs/sweep").join(&plan.sweep().name));
    output_file::make_folder(&folder)?;
    let mut study = if args.resume {
        Study::resume(&folder, &plan)?
    } else {
        Study::begin(&folder, &plan)?
    };
    let points = plan.points().len();
    let per_point = plan.games_per_point();
    screen::remark(&format!(
        "{points} points with {per_point} games each; tables and report in {}",
        folder.display()
    ));
    if study.done() > 0 {
        screen::remark(&format!(
            "{} of {} games already played",
            study.done(),
            plan.games()
        ));
    }
    let stop = stop::on_ctrl_c()?;
    let mut progress = Progress::of_games((plan.games() - study.done()) as u64);
    let from = study.done();
    let jobs = args.jobs.threads(plan.games() - from);
    let played = sweep::play(&plan, (from, plan.games()), jobs, &stop, |played| {
        progress.add();
        study.add(&plan, &played)
    });
    progress.end_of_games(jobs.get());
    // Games played before the disk was full are kept, and the sweep can be resumed.
    played.with_context(|| {
        format!(
            "{} of {} games are saved; continue with --resume",
            study.done(),
            plan.games()
        )
    })?;
    let report = study.report(&plan)?;
    screen::print(&sweep::text(&report));
    screen::print(&format!(
        "\nreport with curves: squall view {}\n",
        argument_for(&folder)
    ));
    if study.done() < plan.games() {
        screen::remark("stopped; continue with --resume");
        return Ok(stop::interrupted());
    }
    Ok(if report.failures.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

fn planned(args: &Args) -> Result<Plan> {
    let context = || format!("cannot run the sweep {}", args.sweep.display());
    let file = load_file::<Sweep>(&args.sweep).with_context(context)?;
    let games = args.games.unwrap_or(file.games);
    tell_rounded(games, "point");
    Plan::new(&Sweep {
        games,
        seed: args.seed.unwrap_or(file.seed),
        ..file
    })
    .with_context(context)
}
