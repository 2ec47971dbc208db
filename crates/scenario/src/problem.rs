//! Problems of scenario files and their places.

use primitives::printable;
use std::fmt;
use std::path::PathBuf;

/// One problem at one place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// The file, relative to the requested file.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The key, the value found and the allowed values.
    pub message: String,
    /// The line's text; empty for a problem with a whole file.
    pub source: String,
}

impl Problem {
    /// A problem with a whole file.
    pub fn of_file(path: PathBuf, message: String) -> Problem {
        Problem {
            path,
            line: 1,
            column: 1,
            message,
            source: String::new(),
        }
    }

    /// The place of the problem, as in `boats/heron.toml:3:17`.
    pub fn place(&self) -> String {
        format!(
            "{}:{}:{}",
            printable::line(&self.path.display().to_string()),
            self.line,
            self.column
        )
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), printable::line(&self.message))
    }
}

/// All faults in a file and its referenced files, by file, line and column; never empty.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", one_a_line(.0))]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// These problems sorted and without duplicates, if there are any.
    ///
    /// # Errors
    /// The problems.
    pub fn of(mut problems: Vec<Problem>) -> Result<(), Problems> {
        problems.sort();
        problems.dedup();
        if problems.is_empty() {
            Ok(())
        } else {
            Err(Problems(problems))
        }
    }
}

fn one_a_line(problems: &[Problem]) -> String {
    let lines: Vec<String> = problems.iter().map(Problem::to_string).collect();
    lines.join("\n")
}
