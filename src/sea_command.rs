//! `squall sea`: what a sea means.

use crate::screen;
use anyhow::{Context, Result};
use game::scenario::{load_boat, load_sea};
use game::sea::Sea;
use sim::sea::{Summary, WaveSummary, WindSummary};
use std::fmt::Write;
use std::path::PathBuf;
use std::process::ExitCode;

/// Which sea, and for which boat.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The sea file
    sea: PathBuf,
    /// The boat file that it is told for
    #[arg(long, value_name = "FILE", default_value = "scenarios/boats/surveyor_m1_8.toml")]
    boat: PathBuf,
    /// The game file whose field it lies over
    #[arg(long, value_name = "FILE", default_value = "scenarios/games/pav01_vs_pav01.toml")]
    game: PathBuf,
    /// Chooses the waves, gusts and eddies
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let sea = load_sea(&args.sea).with_context(|| format!("cannot read {}", args.sea.display()))?;
    let boat = load_boat(&args.boat).with_context(|| format!("cannot read {}", args.boat.display()))?;
    let game = crate::sim_command::load(&args.game, None)?;
    let summary = Summary::new(&sea, &boat, &game.field, args.seed);
    screen::print(&told(&sea, &boat.name, &summary));
    Ok(ExitCode::SUCCESS)
}

/// The summary as text.
fn told(sea: &Sea, boat: &str, summary: &Summary) -> String {
    let mut text = format!("{} for a boat of kind {boat}\n", sea.name);
    let depth = sea.depth_m.map_or("deep".to_owned(), |depth_m| format!("{depth_m} m deep"));
    line(&mut text, "water", &format!("{} kg/m³, {depth}", sea.water_density_kg_m3));
    match &summary.waves {
        None => line(&mut text, "waves", "none"),
        Some(waves) => tell_waves(&mut text, waves),
    }
    match &summary.wind {
        None => line(&mut text, "wind", "none"),
        Some(wind) => tell_wind(&mut text, wind),
    }
    let current = summary.current_m_s;
    let bearing_deg = game::angle::compass_deg_from_rad(game::math::atan2(current.east, current.north));
    match current.length() {
        0.0 => line(&mut text, "current in the middle", "none at the start"),
        speed_m_s => line(
            &mut text,
            "current in the middle",
            &format!("{speed_m_s:.2} m/s towards {bearing_deg:.0}° at the start"),
        ),
    }
    text
}

fn tell_waves(text: &mut String, waves: &WaveSummary) {
    let [head, beam] = waves.orbital_on_hull_m_s;
    let [from_ahead, from_abeam] = waves.drift_newton;
    for (what, value) in [
        ("significant wave height", format!("{:.2} m", waves.hs_m)),
        ("peak period", format!("{:.2} s", waves.tp_s)),
        ("wavelength at the peak", format!("{:.1} m", waves.wavelength_m)),
        ("slope, rms", format!("{:.1}°", waves.slope_rms_rad.to_degrees())),
        ("orbital velocity, rms", format!("{:.2} m/s at the surface", waves.orbital_rms_m_s)),
        ("  on the hull", format!("{head:.2} m/s from ahead, {beam:.2} m/s from abeam")),
        ("Stokes drift", format!("{:.3} m/s over the draught", waves.stokes_m_s)),
        ("mean drift force", format!("{from_ahead:.1} N from ahead, {from_abeam:.1} N from abeam")),
    ] {
        line(text, what, &value);
    }
}

fn tell_wind(text: &mut String, wind: &WindSummary) {
    let [high, low] = wind.mean_m_s;
    let [from_ahead, from_abeam] = wind.force_newton;
    let share_pct = if low > 0.0 { 100.0 * wind.drift_m_s / low } else { 0.0 };
    for (what, value) in [
        ("mean wind", format!("{high:.1} m/s at 10 m, {low:.1} m/s at the boat")),
        ("gusts, rms", format!("{:.1} m/s", wind.gust_m_s)),
        ("force of the mean wind", format!("{from_ahead:.1} N from ahead, {from_abeam:.1} N from abeam")),
        ("wind drift, beam on", format!("{:.2} m/s, {share_pct:.1} % of the wind", wind.drift_m_s)),
    ] {
        line(text, what, &value);
    }
}

fn line(text: &mut String, what: &str, value: &str) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "  {what:<24}{value}");
}
