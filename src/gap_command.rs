//! `squall gap`: where a real boat lies among simulated ones with the same commands.

use crate::identify_command::{named, read_log};
use crate::jobs_args::JobsArgs;
use crate::progress::Progress;
use crate::trial_command::{tick, usual_tick_s};
use crate::water_args::{self, WaterArgs, within};
use crate::{plot, recording_file, screen};
use anyhow::{Context, Result, ensure};
use command_line::number::whole;
use command_line::scenario_files::existing;
use import::Map;
use primitives::SimTime;
use scenario::sea::{Gusts, Sea};
use std::path::PathBuf;
use std::process::ExitCode;
use trial::identify::{Change, Frames, Gap, Place, Setting, changes};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Logs of the real boat, as for `squall identify`
    #[arg(required = true, value_name = "LOG", value_parser = existing)]
    logs: Vec<PathBuf>,
    /// Boat to simulate: a file, or the name of a boat in scenarios/boats
    #[arg(long, value_name = "BOAT")]
    boat: String,
    #[command(flatten)]
    water: WaterArgs,
    /// Boat to read, if the log contains several
    #[arg(long, value_name = "BOAT")]
    vehicle: Option<String>,
    /// Column names of a CSV table, as for `squall import`
    #[arg(long, value_name = "MAP")]
    map: Option<Map>,
    /// Number of simulated runs, each with its own waves, gusts, sensor errors and randomised
    /// values
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = whole::<usize>(20, 10_000))]
    runs: usize,
    /// Length of a segment, s: every run restarts from the logged state at the beginning of each
    /// segment
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = within(2.0, 3600.0, "s"))]
    segment_s: f64,
    /// Physics tick, s [default: 0.05]
    #[arg(long, value_name = "S", value_parser = tick)]
    tick_s: Option<f64>,
    /// Plots the boat against the spread of the runs to this SVG file [default: LOG_gap.svg in the
    /// current folder]
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    jobs: JobsArgs,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let (boat, path, _) = water_args::boat(&args.boat, args.water.seed)?;
    let setting = |seed| -> Result<Setting> {
        Ok(Setting {
            sea: args.water.sea_of(seed)?.0,
            seed,
            tick: SimTime::from_s(args.tick_s.unwrap_or(usual_tick_s(&boat))),
            segment: SimTime::from_s(args.segment_s),
        })
    };
    let first = setting(args.water.seed)?;
    let columns = (args.map.as_ref(), args.vehicle.as_deref());
    let log = read_log(&args.logs, columns, &boat, first.segment)?;
    let named = named(&args.logs);
    let frames = Frames::new(&log, &first).with_context(|| format!("cannot compare {named}"))?;

    let mut progress = Progress::of(args.runs as u64, "runs");
    let mut runs = vec![];
    let simulate = |i: usize| -> Result<_> {
        let seed = args.water.seed.wrapping_add(i as u64);
        let (boat, _) = scenario::draw_file::<scenario::Boat>(&path, seed)?;
        Ok(frames.run(&boat, &setting(seed)?))
    };
    experiment::run_in_order(args.runs, args.jobs.threads(args.runs), simulate, |run| {
        progress.add();
        runs.push(run);
    });
    progress.end();
    let runs: Vec<_> = runs.into_iter().collect::<Result<Vec<_>>>()?;
    let sound: Vec<_> = runs.into_iter().flatten().collect();
    ensure!(
        !sound.is_empty(),
        "the state of {} becomes non-finite in all {} runs",
        boat.name,
        args.runs
    );
    if sound.len() < args.runs {
        let lost = args.runs - sound.len();
        screen::remark(&format!(
            "{lost} runs omitted: their state became non-finite"
        ));
    }
    let gap = frames.compare(&sound);
    let segments = match gap.segments {
        1 => "1 segment".to_owned(),
        count => format!("{count} segments"),
    };
    let title = format!(
        "{named} among {} runs of {} in {}: {} of {} s",
        sound.len(),
        boat.name,
        first.sea.name,
        segments,
        args.segment_s
    );
    screen::print(&table(&title, &gap));

    // Changing the boat file cannot remove differences caused by random waves and gusts.
    let mean = Setting {
        sea: without_chance(first.sea.clone()),
        ..first
    };
    let changes =
        changes(&boat, &log, &mean).with_context(|| format!("cannot fit {}", boat.name))?;
    screen::print(&advice(&changes));
    let file = args.plot.clone().unwrap_or_else(|| {
        PathBuf::from(format!("{}_gap.svg", recording_file::stem(&args.logs[0])))
    });
    plot::gap::write(&file, title, &gap)?;
    screen::print(&format!("plot: {}\n", file.display()));
    Ok(ExitCode::SUCCESS)
}

/// The sea without waves and gusts.
fn without_chance(mut sea: Sea) -> Sea {
    sea.waves = None;
    if let Some(wind) = &mut sea.wind {
        wind.gusts = Gusts::None;
    }
    sea
}

fn table(title: &str, gap: &Gap) -> String {
    let mut text = format!(
        "{title}\n  {:<24}{:>22}  {:>10}  {:>6}  {:>4}\n",
        "", "boat - runs, mean", "spread", "inside", "rank"
    );
    for Place {
        name,
        unit,
        off,
        plus_minus,
        spread,
        inside,
        rank,
    } in &gap.places
    {
        let differs = if off.abs() > *plus_minus { " *" } else { "" };
        let off = if plus_minus.is_finite() {
            format!("{off:+.3} ± {plus_minus:.3} {unit}")
        } else {
            format!("{off:+.3} {unit}")
        };
        text.push_str(&format!(
            "  {name:<24}{off:>22}  {:>10}  {:>4.0} %  {:>2.0} %{differs}\n",
            format!("± {spread:.3}"),
            100.0 * inside,
            100.0 * rank
        ));
    }
    text.push_str(
        "  spread: central 95 % of the runs; inside: part of the log within it; rank: runs below the\n  \
         boat, 50 % on average if the boat file is right; * the boat differs from the runs' median\n",
    );
    text
}

/// Suggests which numbers in the boat file to change.
fn advice(changes: &[Change]) -> String {
    if changes.is_empty() {
        return "no change to a single number in the boat file brings the runs closer to the boat\n".to_owned();
    }
    let mut text = "single changes that bring the runs closer to the boat, best first\n".to_owned();
    for Change { estimate, explains } in changes {
        let key = format!("{}.{}", estimate.parameter.table, estimate.parameter.key);
        text.push_str(&format!(
            "  {key:<28}{:>9.4} -> {:.4} ± {:.4}  removes {:.0} % of the squared error\n",
            estimate.before,
            estimate.value,
            estimate.plus_minus,
            100.0 * explains
        ));
    }
    text
}
