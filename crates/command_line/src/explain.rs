//! Explains errors in scenario files, each with the line it refers to.

use crate::{style, terminal};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use anyhow::Error;
use primitives::printable;
use scenario::{Problem, Problems};
use std::fmt;
use std::process::ExitCode;

/// Maximum width of a quoted line, columns.
const COLUMNS: usize = 100;

/// A mistake in the command line that the argument parser cannot detect.
#[derive(Debug)]
pub struct UsageError(pub String);

impl UsageError {
    /// Reports an error that is found only after the options are parsed as a mistake in the command
    /// line.
    pub fn of(error: Error) -> Error {
        UsageError(line(&error)).into()
    }
}

impl fmt::Display for UsageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for UsageError {}

/// Prints an error and returns the exit code: 2 for a mistake in the command line, as for errors of
/// the argument parser, otherwise 1.
pub fn report(error: &Error) -> ExitCode {
    let is_option = |problem: &Problem| problem.place().starts_with("--");
    let is_usage = |cause: &(dyn std::error::Error + 'static)| {
        let problems = cause.downcast_ref::<Problems>();
        cause.is::<UsageError>()
            || problems.is_some_and(|Problems(problems)| problems.iter().all(is_option))
    };
    let text = self::error(error);
    if error.chain().any(is_usage) {
        terminal::complain_as(
            "error",
            &format!("{text}\n\nFor more information, try '--help'."),
        );
        return ExitCode::from(2);
    }
    terminal::complain(&text);
    ExitCode::FAILURE
}

/// An error with all its causes; for scenario files, with all problems.
pub fn error(error: &Error) -> String {
    let Some(problems) = error.chain().find_map(|cause| cause.downcast_ref()) else {
        return printable::message(&line(error));
    };
    let before = error
        .chain()
        .take_while(|cause| !cause.is::<Problems>())
        .map(|cause| printable::message(&format!("{cause}:\n")));
    before.collect::<String>() + &self::problems(problems)
}

/// The messages of an error and its causes on one line, without causes that a message already
/// includes.
pub fn line(error: &Error) -> String {
    let causes = error
        .chain()
        .map(|cause| without_number(&cause.to_string()));
    causes.fold(String::new(), |text, cause| {
        if text.ends_with(&cause) {
            text
        } else if text.is_empty() {
            cause
        } else {
            format!("{text}: {cause}")
        }
    })
}

/// A message without the system's error numbers, such as ` (os error 2)`.
pub(crate) fn without_number(message: &str) -> String {
    let mut parts = message.split(" (os error ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        text + part.split_once(')').map_or("", |(_, rest)| rest)
    })
}

/// All problems, with their lines.
pub fn problems(Problems(problems): &Problems) -> String {
    problems.iter().map(problem).collect::<Vec<_>>().join("\n")
}

fn problem(problem: &Problem) -> String {
    let Problem {
        line,
        column,
        source,
        message,
        ..
    } = problem;
    let told = format!(
        "{} {}",
        style::bad(&format!("{}:", problem.place())),
        printable::line(&without_number(message))
    );
    let Some(span) = span(source, *column) else {
        return told;
    };
    let shown = Snippet::source(source.as_str())
        .line_start(*line)
        .annotation(AnnotationKind::Primary.span(span));
    let shown = Renderer::styled()
        .term_width(COLUMNS)
        .render(&[Group::with_level(Level::ERROR).element(shown)]);
    format!("{told}\n{shown}")
}

/// The byte range to underline in a line: a word, or a string with its quotes.
fn span(source: &str, column: usize) -> Option<std::ops::Range<usize>> {
    let start = source
        .char_indices()
        .nth(column.saturating_sub(1))
        .map(|(at, _)| at)?;
    let rest = &source[start..];
    let quote = rest.chars().next().filter(|first| "\"'".contains(*first));
    let length = match quote {
        Some(quote) => rest[1..].find(quote).map(|end| end + 2),
        None => rest
            .find([' ', '=', ',', ']', '}', '#', '\t'])
            .filter(|end| *end > 0),
    };
    Some(
        start
            ..start
                + length.unwrap_or(if quote.is_some() {
                    rest.len()
                } else {
                    rest.trim_end().len()
                }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::{Context, anyhow};

    #[test]
    fn a_cause_is_stated_once_and_without_the_system_error_number() {
        let cause = || std::io::Error::from_raw_os_error(2);
        let once = "cannot read a: No such file or directory";
        assert_eq!(
            self::error(&Error::new(cause()).context("cannot read a")),
            once
        );
        let repeated: Result<(), _> =
            Err(cause()).with_context(|| format!("cannot read a: {}", cause()));
        assert_eq!(self::error(&repeated.expect_err("it is an error")), once);
        assert_eq!(
            self::error(&anyhow!("{}; {}", cause(), cause())),
            "No such file or directory; No such file or directory"
        );
    }
}
