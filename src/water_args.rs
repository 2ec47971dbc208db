//! Which boat sails on which water: what `trial` and `identify` ask alike.

use crate::screen;
use anyhow::{Context, Result, anyhow, bail};
use game::Boat;
use game::scenario::Drawn;
use game::sea::Sea;
use std::path::{Path, PathBuf};

/// The water, from the command line.
#[derive(clap::Args)]
pub(crate) struct WaterArgs {
    /// The sea file [default: salt water at rest, no wind]
    #[arg(long, value_name = "FILE")]
    sea: Option<PathBuf>,
    /// Chooses the waves and gusts, and the numbers that boat and sea leave to chance
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// The mean current, in place of the sea's own, m/s
    #[arg(long, value_name = "M_S", value_parser = speed, default_value_if("current_toward_deg", clap::builder::ArgPredicate::IsPresent, "0"))]
    current_m_s: Option<f64>,
    /// Where that current goes to, compass degrees
    #[arg(long, value_name = "DEG", value_parser = degrees, default_value_t = 0.0, allow_negative_numbers = true, requires = "current_m_s")]
    current_toward_deg: f64,
}

impl WaterArgs {
    /// The sea that was asked for.
    pub(crate) fn sea(&self) -> Result<Sea> {
        let mut sea = match &self.sea {
            Some(path) => sea(path, self.seed)?,
            None => arena::trial::still_sea(),
        };
        if let Some(speed_m_s) = self.current_m_s {
            arena::trial::set_mean_current(&mut sea, speed_m_s, self.current_toward_deg);
        }
        Ok(sea)
    }
}

/// The sea in a file; what was drawn of it is told.
pub(crate) fn sea(path: &Path, seed: u64) -> Result<Sea> {
    let drawn = game::scenario::draw_sea(path, seed);
    let (sea, drawn) = drawn.with_context(|| format!("no sea in {}", path.display()))?;
    tell_drawn(seed, &drawn);
    Ok(sea)
}

/// The boat in a file, or of a name in `scenarios/boats`, the file, and what was drawn of it.
pub(crate) fn boat(named: &str, seed: u64) -> Result<(Boat, PathBuf, Vec<Drawn>)> {
    let path = boat_file(named)?;
    let drawn = game::scenario::draw_boat(&path, seed);
    let (boat, drawn) = drawn.with_context(|| format!("no boat in {}", path.display()))?;
    Ok((boat, path, drawn))
}

/// Says which numbers were drawn.
pub(crate) fn tell_drawn(seed: u64, drawn: &[Drawn]) {
    for Drawn { parameter, value } in drawn {
        screen::print(&format!("drawn by seed {seed}: {parameter} = {value}\n"));
    }
}

/// The folder `scenarios/boats` is looked for in the working folder and those above it, then in the program's.
fn boat_file(named: &str) -> Result<PathBuf> {
    named_file(named, ["file", "boat"], || {
        let starts = [std::env::current_dir().ok(), std::env::current_exe().ok()];
        let above: Vec<&Path> = starts.iter().flatten().flat_map(|start| start.ancestors()).collect();
        let folder = above.iter().map(|folder| folder.join("scenarios/boats")).find(|folder| folder.is_dir());
        folder.ok_or_else(|| {
            anyhow!(
                "there is no file {named}, and no folder scenarios/boats here or above to look for a boat of that name"
            )
        })
    })
}

/// A scenario file: a path, or the name of one in a folder. Errors call it a `file` with a `kind` of thing in it.
pub(crate) fn named_file(
    named: &str,
    [file, kind]: [&str; 2],
    folder: impl FnOnce() -> Result<PathBuf>,
) -> Result<PathBuf> {
    let given = PathBuf::from(named);
    if given.is_file() {
        return Ok(given);
    }
    if named.ends_with(".toml") || named.contains(['/', '\\']) {
        bail!("there is no {file} {named}");
    }
    let folder = folder()?;
    let path = folder.join(format!("{named}.toml"));
    if !path.is_file() {
        let names = names_in(&folder).join(", ");
        bail!("there is no {file} {named}, and no {kind} of that name in {}: {names}", folder.display());
    }
    Ok(path)
}

/// The scenario files in a folder, by name.
fn names_in(folder: &Path) -> Vec<String> {
    let files = std::fs::read_dir(folder).into_iter().flatten().filter_map(std::result::Result::ok);
    let paths = files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let mut names: Vec<String> = paths.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    names
}

/// Reads a number from the command line, within limits.
pub(crate) fn within(low: f64, high: f64, unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text: &str| {
        let number = text.parse().map_err(|_| format!("{text:?} is not a number, expected {low} to {high} {unit}"))?;
        let is_within = (low..=high).contains(&number);
        if is_within { Ok(number) } else { Err(format!("{text} is not within {low} to {high} {unit}")) }
    }
}

/// A speed, m/s.
pub(crate) fn speed(text: &str) -> Result<f64, String> {
    within(0.0, 60.0, "m/s")(text)
}

/// An angle, degrees.
pub(crate) fn degrees(text: &str) -> Result<f64, String> {
    within(-720.0, 720.0, "degrees")(text)
}
