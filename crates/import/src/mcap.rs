//! Bags of ROS 2 in MCAP files.

use crate::ros::{Bag, Encoding};
use crate::{Found, ImportError, file_error};
use recording::logs::name_of;
use std::path::Path;

pub(crate) fn read(path: &Path, boat: Option<&str>) -> Result<Found, ImportError> {
    let mut bag = Bag::default();
    let read = recording::Bag::for_each_foreign_message(path, |topic, schema, log_ns, bytes| {
        bag.add(topic, schema, Encoding::Cdr, 1e-9 * log_ns as f64, &bytes);
    });
    read.map_err(|error| file_error(path, error))?;
    let stem = name_of(&path.file_stem().unwrap_or_default().to_string_lossy());
    Ok(bag.found(boat, &stem))
}
