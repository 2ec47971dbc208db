//! `squall tournament`: plays every strategy against every other, in this process.

use crate::jobs_args::JobsArgs;
use crate::league_file::{self, LeagueFile};
use crate::progress::{Progress, tell_rounded};
use crate::{output_file, recording_file, scenario_files, screen, stop};
use agent::MindRunner;
use analysis::Step;
use analysis::quality::{GameQuality, MindState, Quality};
use anyhow::{Context, Result, ensure};
use command_line::explain::UsageError;
use command_line::number::whole;
use experiment::tournament::{
    self, Entrant, Observer, Plan, Record, Report, Tournament, play, play_observed,
};
use rules::event::EventCursor;
use scenario::{Kind, Scenario, load_file};
use serde::Serialize;
use sim::Contest;
use std::collections::BTreeSet;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// The games of every pairing.
#[derive(clap::Args)]
pub(crate) struct GamesArgs {
    /// Games per pairing and sea, half of them on each side [default: the number in the file]
    #[arg(long, value_name = "N", value_parser = whole::<u32>(2, 1_000_000))]
    games: Option<u32>,
    /// First seed [default: the seed in the file]
    #[arg(long, value_name = "N", value_parser = whole::<u64>(0, i64::MAX as u64))]
    seed: Option<u64>,
    /// Sea to use instead of the file's or the game's: a file or a name; may be repeated to play
    /// all games in several seas
    #[arg(long, value_name = "SEA", value_parser = scenario_files::file_of(Kind::SEA))]
    sea: Vec<PathBuf>,
    #[command(flatten)]
    jobs: JobsArgs,
}

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Tournament to play, or two or more strategies: files or names
    #[arg(required = true, value_name = "TOURNAMENT")]
    pub(crate) entries: Vec<String>,
    /// Game for the strategies to play: a file or a name [default: surveyor_2v2]
    #[arg(long, value_name = "GAME", value_parser = scenario_files::file_of(Kind::GAME))]
    pub(crate) game: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) games: GamesArgs,
    /// Writes the full report to this file as JSON, with all settings for replaying its games;
    /// `squall view FILE` shows it
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Writes one line per entry to this file as CSV
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Stores the results in this folder and plays only the missing games, so that you can add
    /// entries or resume a stopped tournament; `squall view FOLDER` shows the results
    #[arg(long, value_name = "FOLDER", conflicts_with = "quality")]
    pub(crate) league: Option<PathBuf>,
    /// Also reports the quality of play: order chatter, idle time, time near the edges, contacts
    /// and circling
    #[arg(long)]
    pub(crate) quality: bool,
}

/// The content of the `--json` file.
#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    report: &'a Report,
    #[serde(skip_serializing_if = "Option::is_none")]
    quality: Option<&'a Quality>,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    run_file(file_of(args)?, args)
}

/// Plays a tournament; `args` name no other.
pub(crate) fn run_file(file: Tournament, args: &Args) -> Result<ExitCode> {
    let plan = planned(file, &args.games)?;
    // Check now rather than after hours of games.
    for path in args.json.iter().chain(&args.csv) {
        output_file::check(path, "the report")?;
    }
    let stop = stop::on_ctrl_c()?;
    let mut league = args.league.as_deref().map(LeagueFile::open).transpose()?;
    let Played {
        records,
        quality,
        rate,
    } = play_all(args, &plan, &stop, league.as_mut())?;

    let mut report = Report::new(&plan, &records);
    report.commit = env!("SQUALL_COMMIT").to_owned();
    // A league's report must be byte-identical whether or not it was interrupted, so omit the rate.
    report.rate = league.is_none().then_some(rate);
    let of_league = league.as_ref().map(LeagueFile::report);
    for path in args.json.iter().chain(&of_league) {
        output_file::write_json(
            path,
            "the report",
            &Whole {
                report: &report,
                quality: quality.as_ref(),
            },
        )?;
    }
    if let Some(path) = &args.csv {
        output_file::write(path, "the report", tournament::csv(&report))?;
    }
    screen::print(&tournament::text(&report, screen::columns()));
    if let Some(quality) = quality {
        screen::print(&format!("\n{quality}"));
    }
    // Print the results even if the disk is full.
    league.map_or(Ok(()), LeagueFile::end)?;
    Ok(
        match (report.games_unplayed > 0, report.failures.is_empty()) {
            (true, _) => stop::interrupted(),
            (false, true) => ExitCode::SUCCESS,
            (false, false) => ExitCode::FAILURE,
        },
    )
}

/// The games played, and the rate at which they were played.
struct Played {
    records: Vec<Record>,
    quality: Option<Quality>,
    /// Games per second.
    rate: f64,
}

/// Plays the games of a plan; with a league, only those that it does not contain.
fn play_all(
    args: &Args,
    plan: &Plan,
    stop: &AtomicBool,
    mut league: Option<&mut LeagueFile>,
) -> Result<Played> {
    let all = || (0..plan.games()).collect::<Vec<usize>>();
    let pairings = league.as_ref().map(|_| league_file::pairings(plan));
    let pairings = pairings.transpose()?.unwrap_or_default();
    let (mut records, games) = league.as_ref().map_or_else(
        || (vec![], all()),
        |file| file.league.split(plan, &pairings),
    );
    if league.is_some() {
        screen::remark(&format!(
            "{} of {} games already played",
            records.len(),
            plan.games()
        ));
    }
    let jobs = args.games.jobs.threads(games.len());
    let mut progress = Progress::of_games(games.len() as u64);
    let take = |record: Record| {
        league
            .iter_mut()
            .for_each(|file| file.add(plan, &pairings, &record));
        progress.add();
        records.push(record);
    };
    let quality = if args.quality {
        Some(play_judged(plan, &games, (jobs, stop), take))
    } else {
        play(plan, &games, jobs, stop, take);
        None
    };
    Ok(Played {
        records,
        quality,
        rate: progress.end_of_games(jobs.get()),
    })
}

/// Plays games of a plan, and judges how sensibly the boats behave.
fn play_judged(
    plan: &Plan,
    games: &[usize],
    threads: (NonZeroUsize, &AtomicBool),
    mut take: impl FnMut(Record),
) -> Quality {
    let observer = Observer {
        begin: |scenario: &Scenario| (GameQuality::new(scenario), EventCursor::default()),
        see: |(quality, cursor): &mut (GameQuality, EventCursor),
              contest: &Contest,
              runner: &MindRunner| {
            let minds: Vec<_> = runner
                .minds()
                .map(|(_, mind)| mind.report().map(MindState::from))
                .collect();
            let orders = runner.orders().map(|(_, order)| order);
            quality.add(
                &Step::of_frame(contest.scenario(), &contest.frame(cursor), orders),
                &minds,
            );
        },
    };
    let mut sum = Quality::default();
    play_observed(plan, games, threads, &observer, |record, seen| {
        seen.into_iter()
            .for_each(|(quality, _)| sum.merge(&quality.end()));
        take(record);
    });
    sum
}

fn file_of(args: &Args) -> Result<Tournament> {
    match &args.entries[..] {
        [name] => {
            ensure!(
                args.game.is_none(),
                "--game requires strategies; a tournament file names its game"
            );
            read(name)
        }
        strategies => between(strategies, args.game.as_deref()),
    }
}

/// Reads a tournament file, given by its path or name.
pub(crate) fn read(name: &str) -> Result<Tournament> {
    let path = scenario_files::find(name, Kind::of::<Tournament>()).map_err(UsageError::of)?;
    load_file::<Tournament>(&path)
        .with_context(|| format!("cannot play the tournament {}", path.display()))
}

fn planned(mut file: Tournament, args: &GamesArgs) -> Result<Plan> {
    file.games = args.games.unwrap_or(file.games);
    file.seed = args.seed.unwrap_or(file.seed);
    if !args.sea.is_empty() {
        file.seas = args.sea.clone();
    }
    let names: BTreeSet<_> = file.seas.iter().map(|sea| sea.file_stem()).collect();
    ensure!(
        names.len() == file.seas.len(),
        "a sea is given twice, expected different seas"
    );
    tell_rounded(file.games, "pairing");
    let name = file.name.clone();
    let plan = Plan::new(&file);
    plan.with_context(|| format!("cannot play the tournament {name}"))
}

/// A tournament between these strategies, with the defaults of a tournament file.
fn between(strategies: &[String], game: Option<&Path>) -> Result<Tournament> {
    let entries = entrants(strategies)?;
    let names = names_of(&entries)?;
    let name = Vec::from_iter(names).join("_");
    let game = game.map_or_else(
        || scenario_files::find("surveyor_2v2", Kind::GAME),
        |path| Ok(path.to_owned()),
    )?;
    Ok(Tournament {
        name,
        game,
        sea: None,
        seas: vec![],
        games: 200,
        seed: 1,
        self_play: false,
        challenger: None,
        entries,
    })
}

/// Entries for strategies, given by path or name, with the strategies' names.
pub(crate) fn entrants(strategies: &[String]) -> Result<Vec<Entrant>> {
    let entrant = |word: &String| {
        let strategy = scenario_files::find(word, Kind::STRATEGY).map_err(UsageError::of)?;
        Ok(Entrant {
            name: recording_file::stem(&strategy),
            strategy,
            kind: None,
        })
    };
    strategies.iter().map(entrant).collect()
}

/// The names of entries, which must differ.
pub(crate) fn names_of(entries: &[Entrant]) -> Result<BTreeSet<&str>> {
    let names: BTreeSet<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    ensure!(
        names.len() == entries.len(),
        "a strategy is given twice, expected strategies with different names"
    );
    Ok(names)
}
