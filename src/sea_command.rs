//! `squall sea`: describes how a sea affects a boat, in numbers and as a plot; and estimates a sea
//! from a log.

use crate::trial_command::usual_tick_s;
use crate::{import_command, output_file, plot, recording_file, screen, water_args};
use anyhow::{Context, Result, bail};
use command_line::number::whole;
use command_line::scenario_files::existing;
use import::{Map, Quantity};
use primitives::angle::compass_deg_from_rad;
use primitives::{Ned, SimTime};
use scenario::Boat;
use scenario::boat::Drive;
use scenario::sea::Sea;
use sim::sea::{SeaModel, Summary, WaveSummary, WindSummary};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use trial::{
    Drift, Manoeuvre, Measured, ObservedSea, ObservedWaves, Plan, Sample, Start, Track, TrialBoat,
};

#[derive(clap::Args)]
#[command(group(clap::ArgGroup::new("what").required(true).args(["sea", "from"])))]
pub(crate) struct Args {
    /// Sea to describe: a file or a name
    #[arg(value_parser = crate::scenario_files::file_of(scenario::Kind::SEA))]
    sea: Option<PathBuf>,
    /// Estimates the sea from this log of a boat that is adrift, moored or keeping station, writes
    /// it to a file and describes it. Accepts the logs that `squall import` accepts, if they
    /// contain heights from a satellite receiver
    #[arg(long, value_name = "LOG", value_parser = existing)]
    from: Option<PathBuf>,
    /// Boat to read, if the log contains several
    #[arg(long, value_name = "BOAT", requires = "from")]
    vehicle: Option<String>,
    /// Column names of a CSV table, as for `squall import`
    #[arg(long, value_name = "MAP", requires = "from")]
    map: Option<Map>,
    /// Writes the estimated sea to this file [default: LOG_sea.toml in the current folder]
    #[arg(long, value_name = "FILE", requires = "from")]
    out: Option<PathBuf>,
    /// Boat to compute the effects for: a file, or the name of a boat in scenarios/boats
    #[arg(long, value_name = "BOAT", default_value = "surveyor_m1_8")]
    boat: String,
    /// Random seed for waves, gusts, eddies and the randomised values of sea and boat
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>(0, u64::MAX))]
    seed: u64,
    /// Plots spectrum, surface, wind and the boat's drift to this SVG file [default: SEA.svg in the
    /// current folder]
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let boat = water_args::boat(&args.boat, args.seed);
    let (boat, _, drawn) = boat.context("cannot load the boat; choose another with --boat")?;
    water_args::tell_drawn(args.seed, &drawn);
    let tick = SimTime::from_s(usual_tick_s(&boat));
    let (sea, spectrum) = match (&args.sea, &args.from) {
        (Some(sea), _) => (water_args::sea(sea, args.seed)?, vec![]),
        (None, Some(log)) => estimated(args, log, &boat, tick)?,
        (None, None) => bail!("expected a sea, or a log with --from"),
    };
    let field = trial::open_field();
    let summary = Summary::new(&sea, &boat, &field, args.seed);
    let drifted = drifted(&boat, &sea, tick, args.seed)?;
    screen::print(&told(&sea, &boat, &summary, &drifted));

    let file = args
        .plot
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.svg", sea.name)));
    let title = format!("{}: {}, seed {}", sea.name, boat.name, args.seed);
    let model = SeaModel::new(
        &sea,
        std::slice::from_ref(&boat),
        &field,
        tick,
        &args.seed.into(),
    );
    plot::sea::write(&file, title, (&sea, spectrum), &model, &drifted)?;
    screen::print(&format!("plot: {}\n", file.display()));
    Ok(ExitCode::SUCCESS)
}

/// Estimates a sea from a log and writes its file; also returns the spectrum of the log's heights.
fn estimated(
    args: &Args,
    log: &Path,
    boat: &Boat,
    tick: SimTime,
) -> Result<(Sea, Vec<(f64, f64)>)> {
    let (logs, vehicle) = import_command::logs_of(log, args.map.as_ref(), args.vehicle.as_deref())?;
    let series = |quantity| {
        logs.series(&vehicle, quantity)
            .map_or(&[][..], Vec::as_slice)
    };
    let observed = ObservedSea::of(&Track {
        height: series(Quantity::Height),
        north: series(Quantity::North),
        east: series(Quantity::East),
        thrusts: [Quantity::Port, Quantity::Starboard].map(series),
    });
    let shown = log.display().to_string();
    let observed = observed.with_context(|| format!("cannot estimate the sea from {shown}"))?;
    screen::print(&observed_told(&shown, &observed));
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}_sea.toml", recording_file::stem(log))));
    let write = |by_waves_m_s| {
        output_file::write(&out, "the sea", observed.written(&shown, by_waves_m_s))?;
        water_args::sea(&out, args.seed)
    };
    // First without a current, to find how far the waves alone carry the boat.
    let sea = Sea {
        current: Sea::at_rest().current,
        ..write(Ned::default())?
    };
    let by_waves = Drift::of(&drifted(boat, &sea, tick, args.seed)?);
    let sea = write(by_waves.map_or(Ned::default(), |drift| drift.velocity_m_s))?;
    screen::print(&format!("estimated sea: {}\n", out.display()));
    Ok((sea, observed.spectrum))
}

/// What the log determines, and what it does not.
fn observed_told(log: &str, observed: &ObservedSea) -> String {
    let undetermined = || "not determined".to_owned();
    let [used, all] = observed.blocks;
    let mut lines = vec![(
        "stretches",
        format!("{used} of {all} used, each {:.0} s", observed.block_s),
    )];
    let total_m2 = observed
        .waves
        .iter()
        .map(|waves| waves.hs_m.value * waves.hs_m.value);
    match observed.waves.as_slice() {
        [] => lines.push((
            "waves",
            "not visible above the receiver's errors".to_owned(),
        )),
        [waves] => lines.push(("waves", waves_observed(waves))),
        [first, others @ ..] => {
            let total_m = total_m2.sum::<f64>().sqrt();
            lines.push(("significant wave height", format!("{total_m:.2} m in all")));
            lines.push(("  in the file", waves_observed(first)));
            lines.extend(
                others
                    .iter()
                    .map(|other| ("  not in it", waves_observed(other))),
            );
        }
    }
    let drift = observed.drift.map(|drift| {
        let Measured { value, plus_minus } = drift.speed_m_s;
        format!(
            "{value:.2} ± {plus_minus:.2} m/s towards {:.0}°",
            drift.toward_deg
        )
    });
    lines.push(("drift", drift.unwrap_or_else(undetermined)));
    if observed.noise_m > 0.0 {
        lines.push((
            "noise of heights, rms",
            format!("{:.3} m", observed.noise_m),
        ));
    }
    lines.push(("wind", "not determined: add it to the file".to_owned()));
    described(&format!("sea around the boat in {log}"), &lines)
}

/// The waves around a peak: height, period and direction.
fn waves_observed(waves: &ObservedWaves) -> String {
    let ObservedWaves {
        hs_m,
        tp_s,
        from_deg,
    } = waves;
    let from = from_deg.map_or("not determined".to_owned(), |from| {
        format!("{:.0} ± {:.0}°", from.value, from.plus_minus)
    });
    format!(
        "{:.2} ± {:.2} m, {:.2} ± {:.2} s, from {from}",
        hs_m.value, hs_m.plus_minus, tp_s.value, tp_s.plus_minus
    )
}

/// The track of a boat released at rest at the datum, pointing north, as in `squall trial
/// --manoeuvre drift`.
fn drifted(boat: &Boat, sea: &Sea, tick: SimTime, seed: u64) -> Result<Vec<Sample>> {
    let mut trial_boat = TrialBoat::new(boat, sea, tick, seed, &Start::default());
    let plan = Plan {
        manoeuvre: Manoeuvre::Drift,
        course_rad: 0.0,
        approach_m_s: None,
        approach_s: 0.0,
        side: 1.0,
        switch_rad: 0.0,
        differential: 0.0,
        duration_s: None,
    };
    Ok(trial::sail(boat, &mut trial_boat, &plan)?.samples)
}

/// A line of the summary: name and value.
type Line = (&'static str, String);

/// The summary in text form.
fn told(sea: &Sea, boat: &Boat, summary: &Summary, drifted: &[Sample]) -> String {
    let depth = sea
        .depth_m
        .map_or("deep".to_owned(), |depth_m| format!("{depth_m} m deep"));
    let mut lines = vec![(
        "water",
        format!("{} kg/m³, {depth}", sea.water_density_kg_m3),
    )];
    match &summary.waves {
        None => lines.push(("waves", "none".to_owned())),
        Some(waves) => lines.extend(waves_told(waves)),
    }
    lines.push((
        "current at the datum",
        flow(summary.current_m_s, "none at the start", " at the start"),
    ));
    match &summary.wind {
        None => lines.push(("wind", "none".to_owned())),
        Some(wind) => lines.extend(wind_told(wind)),
    }
    lines.extend(drift_told(drifted, boat));
    described(&format!("{} for the boat {}", sea.name, boat.name), &lines)
}

/// A heading, and lines below it.
fn described(heading: &str, lines: &[Line]) -> String {
    let text = lines
        .iter()
        .map(|(what, value)| format!("  {what:<24}{value}\n"));
    format!("{heading}\n{}", text.collect::<String>())
}

fn waves_told(waves: &WaveSummary) -> [Line; 8] {
    let [head, beam] = waves.orbital_on_hull_m_s;
    let [from_ahead, from_abeam] = waves.drift_newton;
    [
        ("significant wave height", format!("{:.2} m", waves.hs_m)),
        ("peak period", format!("{:.2} s", waves.tp_s)),
        (
            "wavelength at the peak",
            format!("{:.1} m", waves.wavelength_m),
        ),
        (
            "slope, rms",
            format!("{:.1}°", waves.slope_rms_rad.to_degrees()),
        ),
        (
            "orbital velocity, rms",
            format!("{:.2} m/s at the surface", waves.orbital_rms_m_s),
        ),
        (
            "  on the hull",
            format!("{head:.2} m/s from ahead, {beam:.2} m/s from abeam"),
        ),
        (
            "Stokes drift",
            format!("{:.3} m/s over the draught", waves.stokes_m_s),
        ),
        (
            "mean drift force",
            format!("{from_ahead:.1} N from ahead, {from_abeam:.1} N from abeam"),
        ),
    ]
}

fn wind_told(wind: &WindSummary) -> [Line; 4] {
    let [high, low] = wind.mean_m_s;
    let [from_ahead, from_abeam] = wind.force_newton;
    let share_pct = if low > 0.0 {
        100.0 * wind.drift_m_s / low
    } else {
        0.0
    };
    [
        (
            "mean wind",
            format!("{high:.1} m/s at 10 m, {low:.1} m/s at the boat"),
        ),
        ("gusts, rms", format!("{:.1} m/s", wind.gust_m_s)),
        (
            "force of the mean wind",
            format!("{from_ahead:.1} N from ahead, {from_abeam:.1} N from abeam"),
        ),
        (
            "wind drift, beam on",
            format!("{:.2} m/s, {share_pct:.1} % of the wind", wind.drift_m_s),
        ),
    ]
}

/// The drift of the boat: its speed over the second half, its distance over the whole time.
fn drift_told(drifted: &[Sample], boat: &Boat) -> Vec<Line> {
    let (Some(drift), Some(last)) = (Drift::of(drifted), drifted.last()) else {
        return vec![];
    };
    let heading_deg = whole_deg(drift.heading_rad);
    let mut lines = vec![
        (
            "free boat, simulated",
            flow(
                drift.velocity_m_s,
                "stays",
                &format!(", heading {heading_deg}°"),
            ),
        ),
        (
            "  from its start",
            format!("{:.1} m in {:.0} s", last.at.length(), last.t_s),
        ),
    ];
    if matches!(boat.drive, Drive::Kinematic(_)) {
        lines.push(("", "only the current moves a kinematic boat".to_owned()));
    }
    lines
}

/// A velocity as speed and bearing, followed by `more`; `none` if it is zero.
fn flow(velocity_m_s: Ned, none: &str, more: &str) -> String {
    let speed_m_s = velocity_m_s.length();
    if speed_m_s < 0.005 {
        return none.to_owned();
    }
    format!(
        "{speed_m_s:.2} m/s towards {}°{more}",
        whole_deg(Ned::default().bearing_rad(velocity_m_s))
    )
}

/// A bearing in whole degrees, 0 to 359.
fn whole_deg(bearing_rad: f64) -> u32 {
    compass_deg_from_rad(bearing_rad).round() as u32 % 360
}
