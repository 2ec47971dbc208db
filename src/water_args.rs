//! Command line arguments for the boat and its water; shared by `trial`, `identify` and `gap`.

use command_line::explain::UsageError;
use command_line::number::whole;
pub(crate) use command_line::number::within;

use crate::{scenario_files, screen};
use anyhow::{Context, Result};
use scenario::sea::Sea;
use scenario::{Boat, Drawn, Kind};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
pub(crate) struct WaterArgs {
    /// Sea: a file or a name [default: salt water at rest, without wind]
    #[arg(long, value_name = "SEA", value_parser = scenario_files::file_of(Kind::SEA))]
    sea: Option<PathBuf>,
    /// Random seed for waves, gusts and the randomised values of boat and sea
    #[arg(long, default_value_t = 1, value_parser = whole::<u64>(0, u64::MAX))]
    pub(crate) seed: u64,
    /// Mean current instead of the sea's, m/s
    #[arg(long, value_name = "M_S", value_parser = speed, default_value_if("current_toward_deg", clap::builder::ArgPredicate::IsPresent, "0"))]
    current_m_s: Option<f64>,
    /// Direction towards which this current flows, compass degrees
    #[arg(long, value_name = "DEG", value_parser = degrees, default_value_t = 0.0, allow_negative_numbers = true, requires = "current_m_s")]
    current_toward_deg: f64,
}

impl WaterArgs {
    /// The requested sea.
    pub(crate) fn sea(&self) -> Result<Sea> {
        let (sea, drawn) = self.sea_of(self.seed)?;
        tell_drawn(self.seed, &drawn);
        Ok(sea)
    }

    /// The sea of another seed, and its randomised values.
    pub(crate) fn sea_of(&self, seed: u64) -> Result<(Sea, Vec<Drawn>)> {
        let (mut sea, drawn) = match &self.sea {
            Some(path) => draw_sea(path, seed)?,
            None => (trial::still_sea(), vec![]),
        };
        if let Some(speed_m_s) = self.current_m_s {
            trial::set_mean_current(&mut sea, speed_m_s, self.current_toward_deg);
        }
        Ok((sea, drawn))
    }
}

/// Loads the sea in a file and prints its randomised values.
pub(crate) fn sea(path: &Path, seed: u64) -> Result<Sea> {
    let (sea, drawn) = draw_sea(path, seed)?;
    tell_drawn(seed, &drawn);
    Ok(sea)
}

fn draw_sea(path: &Path, seed: u64) -> Result<(Sea, Vec<Drawn>)> {
    let drawn = scenario::draw_file::<scenario::sea::Sea>(path, seed);
    drawn.with_context(|| format!("cannot load the sea {}", path.display()))
}

/// Loads a boat from a file, or by its name in `scenarios/boats`; returns it with its file and its
/// randomised values.
pub(crate) fn boat(named: &str, seed: u64) -> Result<(Boat, PathBuf, Vec<Drawn>)> {
    let path =
        scenario_files::find(named, Kind::BOAT).map_err(|error| UsageError(error.to_string()))?;
    let drawn = scenario::draw_file::<scenario::Boat>(&path, seed);
    let (boat, drawn) =
        drawn.with_context(|| format!("cannot load the boat {}", path.display()))?;
    Ok((boat, path, drawn))
}

/// Prints the randomised values.
pub(crate) fn tell_drawn(seed: u64, drawn: &[Drawn]) {
    for Drawn { parameter, value } in drawn {
        screen::print(&format!(
            "randomised by seed {seed}: {parameter} = {value}\n"
        ));
    }
}

/// Parses a speed, m/s.
pub(crate) fn speed(text: &str) -> Result<f64, String> {
    within(0.0, 60.0, "m/s")(text)
}

/// Parses an angle, degrees.
pub(crate) fn degrees(text: &str) -> Result<f64, String> {
    within(-720.0, 720.0, "degrees")(text)
}
