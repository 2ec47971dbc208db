//! MCAP files: Squall's recordings and ROS 2 bags.

use crate::ros::{Bag, Encoding};
use crate::{Format, Found, ImportError, file_error, squall};
use recording::RecordingError;
use recording::logs::name_of;
use std::path::Path;

/// Reads a file. Returns its data, and whether it is a recording or a bag.
pub(crate) fn read(path: &Path, boat: Option<&str>) -> Result<(Found, Format), ImportError> {
    match recording::Bag::open(path) {
        Ok(bag) => {
            let found = squall::read(bag).map_err(|error| file_error(path, error))?;
            return Ok((found, Format::Squall));
        }
        Err(RecordingError::Foreign(_)) => {}
        Err(error) => return Err(file_error(path, error)),
    }
    let mut bag = Bag::default();
    let read = recording::Bag::for_each_foreign_message(path, |topic, schema, log_ns, bytes| {
        bag.add(topic, schema, Encoding::Cdr, 1e-9 * log_ns as f64, &bytes);
    });
    read.map_err(|error| file_error(path, error))?;
    let stem = name_of(&path.file_stem().unwrap_or_default().to_string_lossy());
    Ok((bag.found(boat, &stem), Format::Mcap))
}
