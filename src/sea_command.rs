//! `squall sea`: describes how a sea affects a boat, in numbers and as a plot.

use crate::trial_command::usual_tick_s;
use crate::{plot, screen, water_args};
use anyhow::{Context, Result};
use command_line::number::whole;
use primitives::angle::compass_deg_from_rad;
use primitives::{Ned, SimTime};
use scenario::Boat;
use scenario::boat::Drive;
use scenario::sea::Sea;
use sim::sea::{SeaModel, Summary, WaveSummary, WindSummary};
use std::path::PathBuf;
use std::process::ExitCode;
use trial::{Drift, Manoeuvre, Plan, Sample, Start, TrialBoat};

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Sea to describe: a file or a name
    #[arg(value_parser = crate::scenario_files::file_of(scenario::Kind::SEA))]
    sea: PathBuf,
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
    let sea = water_args::sea(&args.sea, args.seed)?;
    let boat = water_args::boat(&args.boat, args.seed);
    let (boat, _, drawn) = boat.context("cannot load the boat; choose another with --boat")?;
    water_args::tell_drawn(args.seed, &drawn);
    let tick = SimTime::from_s(usual_tick_s(&boat));
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
    plot::sea::write(&file, title, &sea, &model, &drifted)?;
    screen::print(&format!("plot: {}\n", file.display()));
    Ok(ExitCode::SUCCESS)
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
    let text = lines
        .iter()
        .map(|(what, value)| format!("  {what:<24}{value}\n"));
    format!(
        "{} for the boat {}\n{}",
        sea.name,
        boat.name,
        text.collect::<String>()
    )
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
