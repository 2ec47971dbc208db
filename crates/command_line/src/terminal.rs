//! Text for people: to standard output and standard error, with colours where a terminal shows them.

use crate::program;
use crate::style;
use anstream::AutoStream;
use primitives::printable;
use std::io::Write;

/// Prints text. A reader that went away is no reason to stop a game.
pub fn print(text: &str) {
    is_read(text);
}

/// Prints text that may have colours.
pub fn show(text: &str) {
    is_written("", &printable::coloured(text));
}

/// Prints text, and says whether anybody still reads. Nothing in it steers the terminal.
pub fn is_read(text: &str) -> bool {
    is_written("", &printable::text(text))
}

/// Prints over the line that was printed last without an end.
pub fn overwrite(text: &str) {
    is_written("\r\x1b[K", &printable::coloured(text));
}

/// Shows a page, which may have colours, instead of all that was on the terminal, and says whether anybody still looks.
pub fn is_seen(page: &str) -> bool {
    is_written("\x1b[H\x1b[J", &printable::coloured(page))
}

/// When texts have colours; left to itself where a terminal shows them and `NO_COLOR` does not forbid it.
pub fn set_colour(choice: clap::ColorChoice) {
    let choice = match choice {
        clap::ColorChoice::Auto => anstream::ColorChoice::Auto,
        clap::ColorChoice::Always => anstream::ColorChoice::Always,
        clap::ColorChoice::Never => anstream::ColorChoice::Never,
    };
    choice.write_global();
}

/// Writes what steers the terminal, and a text whose colours are left out where nobody can see them.
fn is_written(control: &str, text: &str) -> bool {
    let mut out = std::io::stdout().lock();
    let is_steered = out.write_all(control.as_bytes()).is_ok();
    let mut out = AutoStream::auto(out);
    is_steered && out.write_all(text.as_bytes()).and_then(|()| out.flush()).is_ok()
}

/// Prints what went wrong, a text that may have colours.
pub fn complain(text: &str) {
    let text = printable::coloured_message(text);
    drop(writeln!(anstream::stderr(), "{} {text}", style::bad(&format!("{}:", program::name()))));
}

/// Prints something to standard error, where it does not mix with results.
pub fn remark(text: &str) {
    drop(writeln!(anstream::stderr(), "{}", printable::message(text)));
}
