//! What is wrong with a scenario file, and where.

use primitives::printable;
use std::fmt;
use std::path::PathBuf;

/// One thing that is wrong, at one place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Problem {
    /// The file, as reached from the file that was asked for.
    pub path: PathBuf,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Which key, what was found, and what is allowed.
    pub message: String,
    /// The line as it stands there; empty where a whole file is meant.
    pub source: String,
}

impl Problem {
    /// What is wrong with a whole file.
    #[must_use]
    pub fn of_file(path: PathBuf, message: String) -> Problem {
        Problem { path, line: 1, column: 1, message, source: String::new() }
    }

    /// Where it is, as in `boats/heron.toml:3:17`.
    #[must_use]
    pub fn place(&self) -> String {
        format!("{}:{}:{}", printable::line(&self.path.display().to_string()), self.line, self.column)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), printable::line(&self.message))
    }
}

/// Everything that is wrong with a file and the files it names, by file, line and column; never empty.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", one_a_line(.0))]
pub struct Problems(pub Vec<Problem>);

fn one_a_line(problems: &[Problem]) -> String {
    problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n")
}
