//! `squall identify`: fits a boat file to a recorded time series.

use crate::progress::Progress;
use crate::trial_command::{read_sheet, tick, usual_tick_s};
use crate::water_args::{self, WaterArgs, within};
use crate::{import_command, output_file, screen};
use anyhow::{Context, Result, bail};
use command_line::explain::UsageError;
use command_line::scenario_files::existing;
use import::{Format, Map};
use primitives::SimTime;
use scenario::Boat;
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use trial::Sheet;
use trial::identify::{self, Fit, Log, Setting, Step};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Boat from which the fit starts: a file, or the name of a boat in scenarios/boats
    boat: String,
    /// Recorded data: any log that `squall import` reads, or a CSV table with the columns t_s,
    /// commands as for `squall trial --orders`, heading_deg, surge_m_s, yaw_rate_deg_s and, if
    /// available, sway_m_s, x_m and y_m. May be repeated
    #[arg(long, required = true, value_name = "FILE", value_parser = existing)]
    log: Vec<PathBuf>,
    /// Boat to read, if the log contains several
    #[arg(long, value_name = "BOAT")]
    vehicle: Option<String>,
    /// Column names of a CSV table, as for `squall import`
    #[arg(long, value_name = "MAP")]
    map: Option<Map>,
    /// Parameters to fit, separated by commas [default: surge_linear, surge_quadratic, sway_linear,
    /// yaw_linear, yaw_quadratic, yaw_lift, port_gain, starboard_gain and lag, if the boat has
    /// them]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fit: Vec<String>,
    /// Also fits the mean current, which is hard to distinguish from thrust if the log has no
    /// positions
    #[arg(long, conflicts_with_all = ["current_m_s", "current_toward_deg"])]
    fit_current: bool,
    /// Also fits the mean wind, if the log determines it: the boat must drive and drift on several
    /// headings
    #[arg(long)]
    fit_wind: bool,
    /// Length of a segment, s: the simulation restarts from the recorded data at the beginning of
    /// each segment
    #[arg(long, value_name = "S", default_value_t = 20.0, value_parser = within(1.0, 3600.0, "s"))]
    segment_s: f64,
    /// Writes the fitted boat to this file [default: BOAT_identified.toml in the current folder]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Physics tick, s [default: 0.05]
    #[arg(long, value_name = "S", value_parser = tick)]
    tick_s: Option<f64>,
    #[command(flatten)]
    water: WaterArgs,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let (boat, path, drawn) = water_args::boat(&args.boat, args.water.seed)?;
    if let Some(first) = drawn.first() {
        let key = first.parameter.trim_start_matches("boat/");
        bail!(
            "{}: {key} is randomised, but a fit needs fixed values; use the boat's base",
            path.display()
        );
    }
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}_identified.toml", boat.name)));
    if out
        .canonicalize()
        .is_ok_and(|out| path.canonicalize().is_ok_and(|path| path == out))
    {
        bail!(UsageError(format!(
            "--out {} is the boat from which the fit starts; choose another file",
            out.display()
        )));
    }
    let mut parameters = identify::parameters(&args.fit, &boat)?;
    if args.fit_current {
        let names = identify::CURRENT.map(str::to_owned);
        parameters.extend(identify::parameters(&names, &boat)?);
    }
    if args.fit_wind {
        let names = identify::WIND.map(str::to_owned);
        parameters.extend(identify::parameters(&names, &boat)?);
    }
    let setting = Setting {
        sea: args.water.sea()?,
        seed: args.water.seed,
        tick: SimTime::from_s(args.tick_s.unwrap_or(usual_tick_s(&boat))),
        segment: SimTime::from_s(args.segment_s),
    };
    let log = read_log(
        &args.log,
        (args.map.as_ref(), args.vehicle.as_deref()),
        &boat,
        setting.segment,
    )?;
    let named = named(&args.log);
    let progress = RefCell::new(Progress::without_end("steps"));
    let tell = |step: Step| {
        let left = step.rms.map_or(String::new(), |rms| {
            format!(", residual {rms:.3} standard deviations")
        });
        progress
            .borrow_mut()
            .add_with(|| format!("search {} of {}{left}", step.search, step.searches));
    };
    let fit = identify::fit(&boat, &log, &setting, &parameters, &tell);
    progress.borrow().end();
    let fit = fit.with_context(|| format!("cannot fit the boat to {named}"))?;
    screen::print(&table(&boat.name, &named, &fit));
    let text = identify::written(&fit, &base_of(&out, &path), &named);
    output_file::write(&out, "the boat", text)?;
    scenario::load_file::<scenario::Boat>(&out)
        .with_context(|| format!("{} was written, but is not a valid boat", out.display()))?;
    screen::print(&format!("fitted boat: {}\n", out.display()));
    Ok(ExitCode::SUCCESS)
}

/// The names of the logs.
pub(crate) fn named(logs: &[PathBuf]) -> String {
    let shown: Vec<String> = logs.iter().map(|log| log.display().to_string()).collect();
    shown.join(", ")
}

/// Reads the logs of a boat and joins them.
pub(crate) fn read_log(
    paths: &[PathBuf],
    columns: (Option<&Map>, Option<&str>),
    boat: &Boat,
    segment: SimTime,
) -> Result<Log> {
    let mut all: Option<Log> = None;
    for path in paths {
        let log = Log::of_sheet(&sheet(path, columns)?, boat)?;
        match &mut all {
            None => all = Some(log),
            Some(all) => all.append(&log, segment),
        }
    }
    all.context("no log given")
}

/// The log as a table: a CSV file as it is, unless `map` or `vehicle` is given; otherwise the data
/// of one boat, converted as by `squall import`.
fn sheet(log: &Path, (map, vehicle): (Option<&Map>, Option<&str>)) -> Result<Sheet> {
    if Format::of(log)? == Format::Csv && map.is_none() && vehicle.is_none() {
        return read_sheet(log);
    }
    let table = import_command::table_of(log, map, vehicle)?;
    Ok(Sheet::read(&log.display().to_string(), table.as_bytes())?)
}

/// The path of the base as written in `out`: relative if both are in one folder, so that they can
/// be moved together.
fn base_of(out: &Path, base: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let folder = match out.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let base = whole(base);
    let relative = base.strip_prefix(whole(folder)).map(Path::to_owned);
    relative.unwrap_or(base).display().to_string()
}

fn table(boat: &str, log: &str, fit: &Fit) -> String {
    let mut text = format!(
        "{boat} fitted to {log}: {} values in {} segments\n",
        fit.measured, fit.segments
    );
    text.push_str(&format!(
        "  {:<18}{:>12}{:>12}   {:<12}{}\n",
        "", "before", "after", "± 95 %", "key"
    ));
    for estimate in &fit.estimates {
        text.push_str(&format!(
            "  {:<18}{:>12.4}{:>12.4} ± {:<12.4}{}.{}\n",
            estimate.parameter.name,
            estimate.before,
            estimate.value,
            estimate.plus_minus,
            estimate.parameter.table,
            estimate.parameter.key
        ));
    }
    if let Some((speed_m_s, toward_deg)) = fit.current() {
        text.push_str(&format!(
            "  current {speed_m_s:.2} m/s towards {toward_deg:.0}°: for trials, --current-m-s {speed_m_s:.2} --current-toward-deg {toward_deg:.0}\n"
        ));
    }
    if let Some((speed_m_s, from_deg)) = fit.wind() {
        text.push_str(&format!(
            "  wind {speed_m_s:.1} m/s from {from_deg:.0}°, 10 m above the water: for trials, in a sea file\n"
        ));
    }
    for quality in &fit.qualities {
        text.push_str(&format!(
            "  {:<10} rms {:>8.4} {:<4} R² {:.4}\n",
            quality.channel, quality.rms, quality.unit, quality.r_squared
        ));
    }
    for confused in &fit.confused {
        text.push_str(&format!(
            "  warning: {} and {} are indistinguishable (correlation {:.3}); omit one of them from --fit\n",
            confused.names[0], confused.names[1], confused.correlation
        ));
    }
    text
}
