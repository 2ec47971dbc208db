//! A recording that somebody names, opened; and a word about what is wrong with it.

use crate::screen;
use anyhow::{Context, Result};
use recording::Recording;
use std::path::Path;

/// Opens it `to` do something, as an error would say: "replay".
pub(crate) fn open(file: &Path, to: &str) -> Result<Recording> {
    let recording = Recording::open(file).with_context(|| format!("cannot {to} {}", file.display()))?;
    if let [first, ..] = recording.damage() {
        let places = recording.damage().len();
        let of = if places == 1 { String::new() } else { format!(" (the first of {places} such places)") };
        let place = format!("bytes {} to {}{of}", first.start, first.end - 1);
        let file = file.display();
        screen::remark(&format!(
            "{file} is damaged: something in {place} is not what was written, and may be wrong or missing below"
        ));
    }
    Ok(recording)
}
