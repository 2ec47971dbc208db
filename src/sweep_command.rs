//! `squall sweep`: how much sea, noise and failure a team stands.

use crate::tournament_progress::Progress;
use crate::{output_file, screen, stop};
use anyhow::{Context, Result};
use game::scenario::{Sweep, load_sweep};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use sweep::{Plan, Study};

/// Which sweep, and how.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The sweep file
    sweep: PathBuf,
    /// Games of each entry at each point, half of them on each side [default: as the file says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    games: Option<u32>,
    /// The first seed [default: as the file says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    seed: Option<u64>,
    /// Threads; what comes of it is the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// The folder for the tables and the report [default: runs/sweep/NAME]
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Goes on with the sweep that this folder holds; what comes of it is the same as if it had never stopped
    #[arg(long)]
    resume: bool,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let plan = planned(args)?;
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("runs/sweep").join(&plan.sweep().name));
    output_file::make_folder(&folder)?;
    let mut study = if args.resume { Study::resume(&folder, &plan)? } else { Study::begin(&folder, &plan)? };
    let (points, per_point) = (plan.points().len(), plan.games_per_point());
    screen::remark(&format!("{points} points with {per_point} games each; tables and report in {}", folder.display()));
    if study.done() > 0 {
        screen::remark(&format!("{} of {} games were played before", study.done(), plan.games()));
    }
    let stop = stop::on_ctrl_c()?;
    let jobs = args.jobs.or(std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let mut progress = Progress::new((plan.games() - study.done()) as u64);
    let from = study.done();
    let played = sweep::play(&plan, (from, plan.games()), jobs, &stop, |played| {
        progress.played();
        study.add(&plan, &played)
    });
    progress.done(jobs.get());
    // What was played before a disk was full is there, and can be gone on with.
    played.with_context(|| format!("{} of {} games are kept; --resume goes on", study.done(), plan.games()))?;
    let report = study.report(&plan)?;
    screen::print(&sweep::text(&report));
    screen::print(&format!("\nwith curves: {}\n", folder.join("report.html").display()));
    if study.done() < plan.games() {
        screen::remark("stopped; --resume goes on with it");
        return Ok(stop::interrupted());
    }
    Ok(if report.failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn planned(args: &Args) -> Result<Plan> {
    let context = || format!("no sweep in {}", args.sweep.display());
    let file = load_sweep(&args.sweep).with_context(context)?;
    let games = args.games.unwrap_or(file.games);
    if !games.is_multiple_of(2) {
        screen::remark(&format!("{games} games a point are {}: half of them on each side", games + 1));
    }
    Plan::new(&Sweep { games, seed: args.seed.unwrap_or(file.seed), ..file }).with_context(context)
}
