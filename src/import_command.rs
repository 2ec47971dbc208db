//! `squall import`: turns logs of other programs into a recording.

use crate::{recording_file, screen};
use anyhow::{Context, Result, bail, ensure};
use command_line::explain::UsageError;
use command_line::scenario_files::existing;
use import::{Imported, Input, Logs, Map, Quantity};
use recording::NewFile;
use recording::logs::name_of;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub(crate) struct Args {
    /// Logs of one game or run: MOOS .alog, ArduPilot .bin, MAVLink .tlog, ROS 2 bags in MCAP,
    /// ROS 1 bags, NMEA 0183, CSV, or Squall's recordings. BOAT=FILE names the boat of a log
    #[arg(required = true, value_name = "FILE", value_parser = input)]
    files: Vec<Input>,
    /// Writes the recording to this new file [default: runs/NAME.mcap]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Game that was played, which defines field, teams and rules: a file or the name of a game.
    /// Without this option, the field encloses the tracks
    #[arg(long, value_name = "GAME", value_parser = existing)]
    game: Option<PathBuf>,
    /// Columns of a CSV table, as MEANING=COLUMN or MEANING=COLUMN:UNIT, separated by commas.
    /// Meanings: t, boat, lat, lon, x, y, height, heading, course, speed, surge, sway, yaw_rate,
    /// port, starboard. Units: s, ms, us, ns, deg, rad, m, km, m_s, kn, km_h, deg_s, deg_min,
    /// rad_s, pct, fraction
    #[arg(long, value_name = "MAP")]
    map: Option<Map>,
}

fn input(text: &str) -> Result<Input, String> {
    let (boat, path) = match text.split_once('=') {
        // A file may have an equals sign in its name.
        Some((boat, path)) if !Path::new(text).exists() => (Some(name_of(boat)), path),
        _ => (None, text),
    };
    let path = PathBuf::from(path);
    if !path.is_file() {
        return Err(format!("there is no file {}", path.display()));
    }
    Ok(Input { path, boat })
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let game = args
        .game
        .as_deref()
        .unwrap_or(Path::new(recording_file::UNKNOWN_GAME));
    let game = scenario::load(game)?;
    let datum = args.game.is_some().then_some(game.field.plan.datum);
    let imported = import::read(&args.files, args.map.as_ref(), datum)?;
    screen::print(&summary(&args.files, &imported));
    for note in &imported.notes {
        screen::remark(note);
    }
    let bytes = imported.logs.recording(game, args.game.is_some());
    let bytes = bytes.map_err(anyhow::Error::msg)?;
    let stem = recording_file::stem(&args.files[0].path);
    let file = match &args.out {
        Some(path) => NewFile::create(path),
        None => {
            let folder = Path::new(recording_file::FOLDER);
            command_line::output_file::make_folder(folder)?;
            NewFile::create_numbered(folder, &stem)
        }
    };
    let place = || match &args.out {
        Some(path) => format!("cannot write the recording to {}", path.display()),
        None => format!("cannot record in {}/", recording_file::FOLDER),
    };
    let path = file
        .and_then(|file| file.fill(&bytes))
        .with_context(place)?;
    let shown = path.display();
    screen::print(&format!(
        "recorded to {shown}; watch it with: squall replay {shown}\n"
    ));
    Ok(ExitCode::SUCCESS)
}

/// A summary of the logs: one line for each file and each boat.
fn summary(files: &[Input], imported: &Imported) -> String {
    let mut text = String::new();
    for (file, format) in files.iter().zip(&imported.formats) {
        text.push_str(&format!("{}: {}\n", file.path.display(), format.name()));
    }
    let logs = &imported.logs;
    for boat in logs.boats() {
        let track = logs
            .series(&boat, Quantity::X)
            .map_or(&[][..], Vec::as_slice);
        let span_s = match (track.first(), track.last()) {
            (Some(first), Some(last)) => last.0 - first.0,
            _ => 0.0,
        };
        let measured: Vec<&str> = [
            ("heading", Quantity::Heading),
            ("speed", Quantity::Surge),
            ("speed", Quantity::Speed),
            ("yaw rate", Quantity::YawRate),
            ("thrust", Quantity::Port),
        ]
        .into_iter()
        .filter(|(_, quantity)| logs.series(&boat, *quantity).is_some())
        .map(|(name, _)| name)
        .collect();
        text.push_str(&format!(
            "  {boat}: {span_s:.0} s, {} positions{}{}\n",
            track.len(),
            if measured.is_empty() { "" } else { ", " },
            measured.join(", ")
        ));
    }
    text
}

/// The table for fitting one boat: the named boat, or the only boat in the log.
pub(crate) fn table_of(path: &Path, map: Option<&Map>, boat: Option<&str>) -> Result<String> {
    let (logs, boat) = logs_of(path, map, boat)?;
    Ok(import::table(&logs, &boat))
}

/// Reads a log; also returns the name of the selected boat or, if none is selected, of the only
/// one.
pub(crate) fn logs_of(
    path: &Path,
    map: Option<&Map>,
    boat: Option<&str>,
) -> Result<(Logs, String)> {
    let input = Input {
        path: path.to_owned(),
        boat: None,
    };
    let imported = import::read(&[input], map, None)?;
    for note in &imported.notes {
        screen::remark(note);
    }
    let boat = boat_in(&imported.logs, path, boat)?;
    Ok((imported.logs, boat))
}

fn boat_in(logs: &Logs, path: &Path, wanted: Option<&str>) -> Result<String> {
    let boats = logs.boats();
    let listed = boats.join(", ");
    match (wanted, boats.as_slice()) {
        (None, [only]) => Ok(only.clone()),
        (Some(wanted), _) => {
            ensure!(
                boats.iter().any(|boat| boat == wanted),
                "{} has no boat {wanted}; boats found: {listed}",
                path.display()
            );
            Ok(wanted.to_owned())
        }
        (None, _) => bail!(UsageError(format!(
            "{} has several boats; select one with --vehicle: {listed}",
            path.display()
        ))),
    }
}
