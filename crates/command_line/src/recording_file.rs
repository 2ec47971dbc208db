//! Opens a recording given by the user, and reports damage in it.

use crate::terminal;
use anyhow::{Context, Error, Result};
use recording::{Bag, Recording, RecordingError};
use std::path::Path;

/// Opens the recording of a game; errors name the purpose `to`, for example "replay".
pub fn open(file: &Path, to: &str) -> Result<Recording> {
    let bag = open_any(file, to)?;
    Recording::of_bag(bag).with_context(|| format!("cannot {to} {}", file.display()))
}

/// Opens a recording of any kind.
pub fn open_any(file: &Path, to: &str) -> Result<Bag> {
    let bag = Bag::open(file).map_err(|error| match error {
        // It names the file.
        RecordingError::File { .. } => Error::new(error),
        error => Error::new(error).context(format!("cannot {to} {}", file.display())),
    })?;
    if let [first, ..] = &bag.damage[..] {
        let places = bag.damage.len();
        let of = if places == 1 { String::new() } else { format!(" (the first of {places} damaged ranges)") };
        let place = format!("bytes {} to {}{of}", first.start, first.end - 1);
        let file = file.display();
        terminal::remark(&format!(
            "{file} is damaged: {place} changed after they were written; data below may be wrong or missing"
        ));
    }
    Ok(bag)
}
