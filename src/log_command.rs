//! `squall log`: analyses a recorded game.

use crate::jobs_args::JobsArgs;
use crate::style::Names;
use crate::water_args::within;
use crate::{output_file, recording_file, screen};
use analysis::{Comparison, GameSeries, Summary};
use anyhow::{Context, Result};
use command_line::explain::UsageError;
use command_line::number::whole;
use recording::{Bag, Damaged, Kind, Recording};
use scenario::Scenario;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

mod difference;
mod export;
mod page;
mod quality;
mod turning;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Recording to analyse: a file, or part of a name listed by `squall runs` [default: the newest
    /// in runs]. Two with --compare, any number with --quality
    #[arg(value_name = "RECORDING", value_parser = recording_file::named)]
    files: Vec<PathBuf>,
    /// Prints only the events
    #[arg(long)]
    events: bool,
    /// Writes the summary, comparison or quality report to this file as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Prints this topic as CSV: a topic from the summary, or `events`. A table has one row per
    /// message, with these exceptions: one per boat seen (pictures), per input (inputs), per word
    /// (say) and per sentence (link)
    #[arg(long, value_name = "TOPIC", conflicts_with = "compare")]
    csv: Option<String>,
    /// Writes the CSV to this file instead of standard output
    #[arg(long, value_name = "FILE", requires = "csv")]
    out: Option<PathBuf>,
    /// Writes MOOS logs for the shoreside and every boat to this folder; if the name ends in .alog,
    /// writes only the shoreside log, to this file
    #[arg(long, value_name = "DIR", conflicts_with = "compare")]
    alog: Option<PathBuf>,
    /// Compares two recordings, for example a game on the water and its simulation
    #[arg(long, conflicts_with = "events")]
    compare: bool,
    /// Reports the quality of play in these recordings: order chatter, idle time, time near the
    /// edges, contacts and circling
    #[arg(long, conflicts_with_all = ["events", "csv", "alog", "compare"])]
    quality: bool,
    /// Finds the moments that most changed the chance of winning, and how much each boat
    /// contributed, by simulating many futures of the game. Takes about a minute on two cores
    #[arg(long, conflicts_with_all = ["events", "csv", "alog", "compare", "quality"])]
    turning_points: bool,
    /// With --turning-points: total number of simulated futures
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = whole::<u32>(50, 100_000), requires = "turning_points")]
    futures: u32,
    /// With --turning-points: strategy that each boat is compared with
    #[arg(
        long,
        value_name = "STRATEGY",
        default_value = "idle",
        requires = "turning_points"
    )]
    baseline: String,
    #[command(flatten)]
    jobs: JobsArgs,
    /// With --compare: maximum time between matching events, s
    #[arg(long, value_name = "S", default_value_t = 5.0, value_parser = within(0.0, 3600.0, "s"), requires = "compare")]
    tolerance_s: f64,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let mut files = args.files.clone();
    if files.is_empty() && !args.compare {
        files.push(recording_file::or_newest(None)?);
    }
    match files.as_slice() {
        files if args.quality => quality::print(files, args.json.as_deref())?,
        [file] if args.turning_points => return turning::print(args, file),
        [a, b] if args.compare => compare(args, [a, b])?,
        [file] if !args.compare => look_at(args, file)?,
        files => {
            let wanted = if args.compare {
                "--compare needs two recordings"
            } else {
                "log needs one recording, or several with --quality"
            };
            anyhow::bail!(UsageError(format!("{wanted}, but got {}", files.len())))
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn look_at(args: &Args, file: &Path) -> Result<()> {
    let bag = recording_file::open_any(file, "read")?;
    let wants_page = args.alog.is_none() && args.csv.is_none();
    if bag.kind == Kind::Gateway {
        if let Some(topic) = &args.csv {
            return csv(args, file, (&bag, None), topic);
        }
        let asks_for_more = args.events || args.json.is_some() || !wants_page;
        anyhow::ensure!(
            !asks_for_more,
            "{} is the recording of a gateway, which supports only --csv",
            file.display()
        );
        screen::print(&page::gateway(&bag));
        return Ok(());
    }
    let recording =
        Recording::of_bag(bag).with_context(|| format!("cannot read {}", file.display()))?;
    if let Some(topic) = &args.csv {
        csv(
            args,
            file,
            (recording.bag(), Some(recording.scenario())),
            topic,
        )?;
    }
    let mut remarks = vec![];
    if wants_page || args.events || args.json.is_some() {
        let damaged = summary(args, &recording, wants_page)?;
        let is_shown = wants_page && !args.events;
        remarks.extend(damaged.remark().filter(|_| !is_shown));
    }
    if let Some(path) = &args.alog {
        let (files, damaged) = export::alog(&recording, path)?;
        screen::remark(&format!(
            "wrote {files} MOOS log{} to {}",
            if files == 1 { "" } else { "s" },
            path.display()
        ));
        remarks.extend(damaged.remark());
    }
    // Every pass over the file finds the same damage: report it once.
    let mut told = BTreeSet::new();
    remarks
        .iter()
        .filter(|remark| told.insert(*remark))
        .for_each(|remark| screen::remark(remark));
    Ok(())
}

/// Prints the summary or the events, and writes the whole summary as JSON if requested.
fn summary(args: &Args, recording: &Recording, wants_page: bool) -> Result<Damaged> {
    let summary = Summary::of(recording);
    let names = Names::of(recording.scenario());
    if args.events {
        screen::show(&names.paint(&page::events(&summary)));
    } else if wants_page {
        screen::show(&names.paint(&page::text(&summary)));
    }
    if let Some(path) = &args.json {
        output_file::write_json(path, "the summary", &summary)?;
    }
    Ok(summary.damaged)
}

fn csv(args: &Args, file: &Path, source: (&Bag, Option<&Scenario>), topic: &str) -> Result<()> {
    let damaged = export::csv(source, topic, args.out.as_deref())
        .with_context(|| format!("cannot export {} as CSV", file.display()))?;
    damaged
        .remark()
        .iter()
        .for_each(|remark| screen::remark(remark));
    Ok(())
}

fn compare(args: &Args, [a, b]: [&Path; 2]) -> Result<()> {
    let recordings = [
        recording_file::open(a, "read")?,
        recording_file::open(b, "read")?,
    ];
    let series = recordings.each_ref().map(GameSeries::of);
    for (file, series) in [a, b].iter().zip(&series) {
        if let Some(remark) = series.damaged.remark() {
            screen::remark(&format!("{}: {remark}", file.display()));
        }
    }
    let headers = recordings.each_ref().map(Recording::header);
    let comparison = Comparison::of(headers, series.each_ref(), args.tolerance_s)
        .with_context(|| format!("cannot compare {} with {}", a.display(), b.display()))?;
    screen::print(&difference::text([a, b], &comparison));
    if let Some(path) = &args.json {
        output_file::write_json(path, "the comparison", &comparison)?;
    }
    Ok(())
}
