//! Reads logs from other programs, and combines the logs of one or more boats into one game.
//!
//! | format | recognised by | position, heading and speed from | commands from |
//! |---|---|---|---|
//! | MOOS `.alog` | first line of `%` | `NAV_GT_…`, `NAV_…`, node reports | – |
//! | ArduPilot `.bin` | `FMT` message | `POS`, `GPS`, `XKF1`, `ATT`, `IMU` | `RCOU` |
//! | MAVLink `.tlog` | time and start of a frame | `GLOBAL_POSITION_INT`, `ATTITUDE` | `SERVO_OUTPUT_RAW` |
//! | ROS 2 MCAP, ROS 1 bag | magic bytes | `Odometry`, `NavSatFix`, `Imu`, `TwistStamped` | numbers on topics with `left`, `right`, `port`, `starboard` |
//! | NMEA 0183 | sentences | `GGA`, `RMC`, `VTG`, `HDT`, `PSEAA` | `PSEAC` |
//! | Squall recording | MCAP header | frames of a game; the link of a gateway | orders; the link |
//! | CSV | everything else | columns, see [`Map`] | columns |
//!
//! All become [`Logs`], which [`Logs::recording`] turns into a recording, and [`table`] into the
//! table that `squall identify` reads. Times are in UTC if the log provides it.

mod bag1;
mod csv;
mod dataflash;
mod earth;
mod format;
mod mavlink_log;
mod mcap;
mod nmea;
mod ros;
mod servo;
mod squall;
mod table;

pub use csv::Map;
pub use format::Format;
pub use recording::logs::{Logs, Quantity};
pub use table::table;

use earth::Positions;
use primitives::LatLon;
use recording::RecordingError;
use recording::logs::name_of;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a log cannot be read.
#[derive(Debug, Error)]
pub enum ImportError {
    /// The file does not exist, cannot be read, or is not a log.
    #[error("{path}: {reason}", path = path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// A table is invalid; names the file, line and column.
    #[error(transparent)]
    Table(#[from] trial::Mistake),
    /// A recording or a MOOS log is invalid; names the file.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

/// A file to import.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Input {
    /// The file.
    pub path: PathBuf,
    /// The name of the boat; `None` to take it from the log, or else from the file's name.
    pub boat: Option<String>,
}

/// The imported logs, and notes for the user.
#[derive(Debug, Default)]
pub struct Imported {
    /// The measurements, sorted by time.
    pub logs: Logs,
    /// The format of each file.
    pub formats: Vec<Format>,
    /// What was missing, estimated or ignored.
    pub notes: Vec<String>,
}

/// The data that a reader found in a file.
#[derive(Default)]
struct Found {
    logs: Logs,
    /// Positions on the globe, placed on the plane once all files have been read.
    positions: Positions,
    /// Whether times are UTC.
    has_utc: bool,
    notes: Vec<String>,
}

/// Reads the logs of a game. `datum` is that of the game's field, if the game is known. Otherwise
/// the datum is that of the logs, or else the first position.
///
/// # Errors
/// [`ImportError`] with the file and the reason.
pub fn read(
    inputs: &[Input],
    map: Option<&Map>,
    datum: Option<LatLon>,
) -> Result<Imported, ImportError> {
    let mut imported = Imported::default();
    let mut positions = Positions::default();
    for input in inputs {
        let path = &input.path;
        let mut format = Format::of(path)?;
        let boat = input.boat.clone();
        let boat = boat
            .unwrap_or_else(|| name_of(&path.file_stem().unwrap_or_default().to_string_lossy()));
        let found = match format {
            Format::Alog => alog(path)?,
            Format::Dataflash => dataflash::read(path, &boat)?,
            Format::Tlog => mavlink_log::read(path, input.boat.as_deref())?,
            Format::Mcap | Format::Squall => {
                let (found, which) = mcap::read(path, input.boat.as_deref())?;
                format = which;
                found
            }
            Format::Bag1 => bag1::read(path, input.boat.as_deref())?,
            Format::Nmea => nmea::read(path, &boat)?,
            Format::Csv => csv::read(path, &boat, map)?,
        };
        if inputs.len() > 1 && !found.has_utc {
            let reason = "the log contains no UTC times, so it cannot be aligned with other logs; import it alone";
            return Err(file_error(path, reason));
        }
        let named = found.notes.into_iter();
        let named = named.map(|note| format!("{}: {note}", path.display()));
        imported.notes.extend(named);
        imported.logs.merge(found.logs);
        positions.merge(found.positions);
        imported.formats.push(format);
    }
    positions.place(&mut imported.logs, datum);
    imported.logs.sort();
    let notes = earth::resolve_motion(&mut imported.logs);
    imported.notes.extend(notes);
    if imported.logs.boats().is_empty() {
        let reason = "no boat positions found";
        let path = inputs.first().map_or(Path::new(""), |input| &input.path);
        return Err(file_error(path, reason));
    }
    Ok(imported)
}

fn alog(path: &Path) -> Result<Found, ImportError> {
    let mut found = Found {
        has_utc: true,
        ..Found::default()
    };
    recording::alog::add(&mut found.logs, path)?;
    Ok(found)
}

fn file_error(path: &Path, reason: impl ToString) -> ImportError {
    ImportError::File {
        path: path.to_owned(),
        reason: reason.to_string(),
    }
}

/// Reads a whole file.
fn bytes_of(path: &Path) -> Result<Vec<u8>, ImportError> {
    let bytes = primitives::input_file::read(path, primitives::input_file::TABLE_BYTES_MAX);
    bytes.map_err(|error| file_error(path, error))
}
