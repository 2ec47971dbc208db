//! `squall sweep`: measures how much sea, noise and failure a team tolerates.

use crate::jobs_args::JobsArgs;
use crate::progress::{Progress, tell_rounded};
use crate::{output_file, screen, stop};
use anyhow::{Context, Result};
use command_line::number::{significant, whole};
use experiment::sweep::{self, Condition, Journal, Plan, SearchError, Study, Sweep};
use scenario::{Kind, load_file};
use std::path::{Path, PathBuf};
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
    /// Resumes the sweep in the output folder; the results are the same as without interruption.
    /// With --until or --find, reuses the games of earlier searches
    #[arg(long)]
    resume: bool,
    /// Instead of playing all points, searches an axis for the value at which this condition begins
    /// to hold, for example "strategy_5.win_share < 0.5"; plays at most the games of one point at
    /// each value
    #[arg(long, value_name = "CONDITION", conflicts_with = "find")]
    until: Option<String>,
    /// With --until: key of the axis to search [default: the only numeric axis]
    #[arg(long, value_name = "KEY", requires = "until")]
    along: Option<String>,
    /// Plays games sampled evenly from the space of the axes, and lists those that meet this
    /// condition, for example "strategy_5.contacts > 0"; `collision` and `out_of_bounds` apply to
    /// the first entry
    #[arg(long, value_name = "CONDITION")]
    find: Option<String>,
    /// With --find: number of games to play
    #[arg(long, value_name = "N", requires = "find", default_value_t = 1000, value_parser = whole::<u32>(1, 10_000_000))]
    search_games: u32,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let plan = planned(args)?;
    let folder = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from("runs/sweep").join(&plan.sweep().name));
    output_file::make_folder(&folder)?;
    if let Some(condition) = &args.until {
        return until(args, &plan, condition, &folder);
    }
    if let Some(condition) = &args.find {
        return find(args, &plan, condition, &folder);
    }
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
        "\nreport with curves: {}\n",
        folder.join("report.html").display()
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

/// Searches for the breaking point on one axis.
fn until(args: &Args, plan: &Plan, text: &str, folder: &Path) -> Result<ExitCode> {
    let condition = Condition::parse(text, plan.sweep())?;
    let stop = stop::on_ctrl_c()?;
    let mut journal = journal(args, folder, plan)?;
    let jobs = args.jobs.threads(plan.games_per_point());
    let result = sweep::breaking_point(
        plan,
        &condition,
        args.along.as_deref(),
        &mut journal,
        (jobs, &stop),
        |tried| {
            let half = tried.mean.half_width().map_or("?".to_owned(), significant);
            let verdict = tried.holds.map_or("is undecided", |holds| {
                if holds { "holds" } else { "does not hold" }
            });
            let value = tried.value;
            let games = tried.games;
            let mean = significant(tried.mean.mean);
            screen::remark(&format!(
                "at {value:.4}: {mean} ± {half} in {games} games, {condition} {verdict}"
            ));
        },
    );
    let point = match result {
        Err(SearchError::Stopped) => return Ok(stopped(&journal)),
        other => other?,
    };
    let path = folder.join("until.json");
    output_file::write_json(&path, "the breaking point", &point)?;
    let entry = &point.entry;
    let axis = &point.axis;
    let condition = &point.condition;
    screen::print(&match (point.low, point.high) {
        (Some(low), Some(high)) => {
            let at = point
                .at
                .map_or(String::new(), |at| format!(", about {at:.4}"));
            format!(
                "{entry}: {condition} begins to hold between {axis} = {low:.4} and {high:.4} (95 %){at}\n"
            )
        }
        (Some(_), None) => {
            format!(
                "{entry}: {condition} fails significantly at one end of {axis}, but does not hold significantly anywhere\n"
            )
        }
        (None, Some(_)) => {
            format!(
                "{entry}: {condition} holds significantly at one end of {axis}, but does not fail significantly anywhere\n"
            )
        }
        (None, None) => {
            format!("{entry}: {condition} is undecided everywhere on {axis}; increase --games\n")
        }
    });
    screen::print(&format!(
        "all tested values, with commands: {}\n",
        path.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// Searches for rare failures.
fn find(args: &Args, plan: &Plan, text: &str, folder: &Path) -> Result<ExitCode> {
    let first = &plan.sweep().entries[0].name;
    let condition = match text {
        "collision" => {
            let distance_m = plan.scenario(0, 0, 0)?.rules.collision_distance_m;
            format!("{first}.closest_m < {distance_m}")
        }
        "out_of_bounds" => format!("{first}.out_of_bounds > 0"),
        other => other.to_owned(),
    };
    let condition = Condition::parse(&condition, plan.sweep())?;
    let stop = stop::on_ctrl_c()?;
    let mut journal = journal(args, folder, plan)?;
    let games = args.search_games as usize;
    let jobs = args.jobs.threads(games);
    let found = sweep::find(
        plan,
        &condition,
        games,
        &mut journal,
        (jobs, &stop),
        |games, failures| {
            screen::remark(&format!("{failures} of {games} games with {condition}"));
        },
    );
    let found = match found {
        Err(SearchError::Stopped) => return Ok(stopped(&journal)),
        other => other?,
    };
    let path = folder.join("find.json");
    output_file::write_json(&path, "what was found", &found)?;
    screen::print(&sweep::found_text(&found));
    screen::print(&format!(
        "\nall results, with more commands: {}\n",
        path.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// The journal of earlier searches over this sweep in its folder.
fn journal(args: &Args, folder: &Path, plan: &Plan) -> Result<Journal> {
    let journal = if args.resume {
        Journal::resume(folder, plan)?
    } else {
        Journal::begin(folder, plan)?
    };
    if journal.games() > 0 {
        screen::remark(&format!("{} games already played", journal.games()));
    }
    Ok(journal)
}

fn stopped(journal: &Journal) -> ExitCode {
    screen::remark(&format!(
        "stopped; {} games are saved; continue with --resume",
        journal.games()
    ));
    stop::interrupted()
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
