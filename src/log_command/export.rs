//! Exports a recording, or one of its topics, to files for other programs.

use crate::output_file;
use analysis::{alog, table};
use anyhow::{Context, Result};
use primitives::printable;
use recording::{Bag, Damaged, Recording};
use scenario::Scenario;
use std::borrow::Cow;
use std::io::{BufWriter, ErrorKind, IsTerminal, Write};
use std::path::Path;

/// A recording, and its game's scenario.
type Source<'a> = (&'a Bag, Option<&'a Scenario>);

/// Writes a topic as CSV to a file or to standard output.
pub(super) fn csv(source: Source<'_>, topic: &str, file: Option<&Path>) -> Result<Damaged> {
    // Check first, so that an unknown topic leaves no empty file behind.
    table::check(source.0, topic)?;
    let trying = |path: &Path| format!("cannot write {}", path.display());
    let sink: Box<dyn Write> = match file {
        Some(path) => {
            Box::new(primitives::output_file::create(path).with_context(|| trying(path))?)
        }
        None => Box::new(std::io::stdout().lock()),
    };
    let is_shown = file.is_none() && std::io::stdout().is_terminal();
    match (
        rows(
            source,
            topic,
            is_shown,
            &mut csv::Writer::from_writer(BufWriter::new(sink)),
        ),
        file,
    ) {
        // A reader that closes the pipe early is not an error.
        (Err(table::TableError::Sink(e)), None) if e.kind() == ErrorKind::BrokenPipe => {
            Ok(Damaged::default())
        }
        (Err(table::TableError::Sink(e)), Some(path)) => Err(e).with_context(|| trying(path)),
        (done, _) => Ok(done?),
    }
}

/// Writes the rows; escapes control characters for a terminal.
fn rows<W: Write>(
    source: Source<'_>,
    topic: &str,
    is_shown: bool,
    csv: &mut csv::Writer<W>,
) -> Result<Damaged, table::TableError> {
    let io = |e: csv::Error| match e.into_kind() {
        csv::ErrorKind::Io(e) => e,
        other => std::io::Error::other(format!("{other:?}")),
    };
    let damaged = table::write(source.0, source.1, topic, &mut |cells| {
        let cells = cells.iter().map(|cell| {
            if is_shown {
                printable::text(cell)
            } else {
                Cow::Borrowed(cell.as_str())
            }
        });
        csv.write_record(cells.map(Cow::into_owned)).map_err(io)
    })?;
    csv.flush()?;
    Ok(damaged)
}

/// Writes the MOOS logs of the shoreside and all boats to a folder, or that of the shoreside to a
/// file. Returns the number of logs and the damage in the recording.
pub(super) fn alog(recording: &Recording, path: &Path) -> Result<(usize, Damaged)> {
    let is_alone = path.extension().is_some_and(|ending| ending == "alog") && !path.is_dir();
    if !is_alone {
        output_file::make_folder(path)?;
    }
    let mut last = path.to_owned();
    let written = alog::write(recording, !is_alone, &mut |name| {
        if !is_alone {
            last = path.join(format!("{name}.alog"));
        }
        Ok(Box::new(primitives::output_file::create(&last)?))
    });
    written.with_context(|| format!("cannot write the log to {}", last.display()))
}
