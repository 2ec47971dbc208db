//! Text for the user, on standard output and standard error, with colours if the terminal supports
//! them.

use crate::{explain, program, style};
use anstream::AutoStream;
use anyhow::{Result, bail};
use primitives::printable;
use std::io::{ErrorKind, Write};
use std::sync::OnceLock;

/// The first error on standard output, unless its reader has closed it.
static OUTPUT_ERROR: OnceLock<std::io::Error> = OnceLock::new();

/// Checks that everything printed so far was written. `main` calls it last, so that a full disk is
/// reported but does not stop a game.
pub fn check_output() -> Result<()> {
    match OUTPUT_ERROR.get() {
        Some(error) => bail!("cannot write to standard output: {error}"),
        None => Ok(()),
    }
}

/// Prints text. [`check_output`] reports errors, which must not stop a game.
pub fn print(text: &str) {
    is_read(text);
}

/// Prints text that may contain colours.
pub fn show(text: &str) {
    is_written("", &printable::coloured(text));
}

/// Prints text without terminal control sequences, and returns whether the output is still open.
pub fn is_read(text: &str) -> bool {
    is_written("", &printable::text(text))
}

/// Overwrites the last line that was printed without a newline.
pub fn overwrite(text: &str) {
    is_written("\r\x1b[K", &printable::coloured(text));
}

/// Replaces the terminal's content with a page, which may contain colours, and returns whether the
/// output is still open.
pub fn is_seen(page: &str) -> bool {
    is_written("\x1b[H\x1b[J", &printable::coloured(page))
}

/// Sets when output has colours; with `Auto`, if the terminal supports them and `NO_COLOR` is
/// unset.
pub fn set_colour(choice: clap::ColorChoice) {
    let choice = match choice {
        clap::ColorChoice::Auto => anstream::ColorChoice::Auto,
        clap::ColorChoice::Always => anstream::ColorChoice::Always,
        clap::ColorChoice::Never => anstream::ColorChoice::Never,
    };
    choice.write_global();
}

/// Writes control sequences and a string, without its colours if they cannot be shown. Returns
/// whether the output is still open.
fn is_written(control: &str, text: &str) -> bool {
    let mut out = std::io::stdout().lock();
    let steered = out.write_all(control.as_bytes());
    let mut out = AutoStream::auto(out);
    let written = steered
        .and_then(|()| out.write_all(text.as_bytes()))
        .and_then(|()| out.flush());
    let is_written = written.is_ok();
    // A reader that closes a pipe early has read enough.
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
    {
        drop(OUTPUT_ERROR.set(error));
    }
    is_written
}

/// Prints an error, which may contain colours.
pub fn complain(text: &str) {
    complain_as(program::name(), text);
}

/// Prints an error, prefixed with `who` instead of the program's name.
pub fn complain_as(who: &str, text: &str) {
    let text = printable::coloured_message(text);
    drop(writeln!(
        anstream::stderr(),
        "{} {text}",
        style::bad(&format!("{who}:"))
    ));
}

/// Prints a string to standard error, so that it does not mix with results.
pub fn remark(text: &str) {
    drop(writeln!(
        anstream::stderr(),
        "{}",
        printable::message(&explain::without_number(text))
    ));
}
