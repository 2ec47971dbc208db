//! A recording that somebody names, opened; and a remark about what is damaged in it.

use crate::terminal;
use anyhow::{Context, Result};
use recording::{Bag, Recording};
use std::path::Path;

/// Opens the recording of a game `to` do something, as an error would say: "replay".
pub fn open(file: &Path, to: &str) -> Result<Recording> {
    let bag = open_any(file, to)?;
    Recording::of_bag(bag).with_context(|| format!("cannot {to} {}", file.display()))
}

/// Opens a recording, whatever it is of.
pub fn open_any(file: &Path, to: &str) -> Result<Bag> {
    let bag = Bag::open(file).with_context(|| format!("cannot {to} {}", file.display()))?;
    if let [first, ..] = bag.damage() {
        let places = bag.damage().len();
        let of = if places == 1 { String::new() } else { format!(" (the first of {places} such places)") };
        let place = format!("bytes {} to {}{of}", first.start, first.end - 1);
        let file = file.display();
        terminal::remark(&format!(
            "{file} is damaged: something in {place} is not what was written, and may be wrong or missing below"
        ));
    }
    Ok(bag)
}
