//! All files read, concatenated into one virtual text, so that a byte offset identifies file, line
//! and column.

use super::problem::Problem;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

#[derive(Clone, Debug, Default)]
pub(super) struct Sources {
    files: Vec<Source>,
}

/// A file in the virtual text.
#[derive(Clone, Debug)]
struct Source {
    path: PathBuf,
    text: Arc<str>,
    /// Its offset in the virtual text.
    start: usize,
    /// Lines with a syntax error, from 1.
    broken_lines: Vec<usize>,
}

impl Sources {
    /// Appends a file; returns its offset.
    pub(super) fn add(&mut self, path: PathBuf, text: Arc<str>) -> usize {
        // Leave a gap of one byte, so that the end of a file is not the start of the next.
        let last = self.files.last();
        let start = last.map_or(0, |last| last.start + last.text.len() + 1);
        self.files.push(Source {
            path,
            text,
            start,
            broken_lines: vec![],
        });
        start
    }

    pub(super) fn texts(&self) -> Vec<(PathBuf, String)> {
        let mut texts: Vec<(PathBuf, String)> = vec![];
        for file in &self.files {
            if !texts.iter().any(|(path, _)| *path == file.path) {
                texts.push((file.path.clone(), file.text.to_string()));
            }
        }
        texts
    }

    /// The index of the file that contains `offset`.
    pub(super) fn index_at(&self, offset: usize) -> usize {
        self.files.partition_point(|file| file.start <= offset) - 1
    }

    /// A problem at `offset`; at least one file must have been added.
    pub(super) fn problem(&self, offset: usize, message: String) -> Problem {
        let file = &self.files[self.index_at(offset)];
        let mut end = (offset - file.start).min(file.text.len());
        while !file.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &file.text[..end];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.matches('\n').count() + 1;
        let column = before[line_start..].chars().count() + 1;
        let source = file.text[line_start..].lines().next();
        Problem {
            path: file.path.clone(),
            line,
            column,
            message,
            source: source.unwrap_or_default().to_owned(),
        }
    }

    fn line(&self, offset: usize) -> usize {
        self.problem(offset, String::new()).line
    }

    /// The characters from `offset` to the end of the file.
    pub(super) fn text_from(&self, offset: usize) -> &str {
        let file = &self.files[self.index_at(offset)];
        file.text.get(offset - file.start..).unwrap_or_default()
    }

    /// The path of the file to which `reference`, at `offset`, refers.
    pub(super) fn resolve(&self, offset: usize, reference: impl AsRef<Path>) -> PathBuf {
        let here = &self.files[self.index_at(offset)].path;
        tidied(&here.parent().unwrap_or(Path::new("")).join(reference))
    }

    /// Records a syntax error at `offset`.
    pub(super) fn mark_broken(&mut self, offset: usize) {
        let line = self.line(offset);
        let index = self.index_at(offset);
        self.files[index].broken_lines.push(line);
    }

    /// Whether the line of `offset` has a syntax error.
    pub(super) fn is_broken_line(&self, offset: usize) -> bool {
        self.files[self.index_at(offset)]
            .broken_lines
            .contains(&self.line(offset))
    }

    /// Whether the file of `offset` has a syntax error.
    pub(super) fn is_broken_file(&self, offset: usize) -> bool {
        !self.files[self.index_at(offset)].broken_lines.is_empty()
    }
}

/// `path` without `.` and `name/..`, so that each file has only one path.
pub fn tidied(path: &Path) -> PathBuf {
    let mut tidy = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir
                if matches!(tidy.components().next_back(), Some(Component::Normal(_))) =>
            {
                tidy.pop();
            }
            _ => tidy.push(part),
        }
    }
    tidy
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_names_file_line_and_column() {
        let mut sources = Sources::default();
        let a = sources.add("games/a.toml".into(), "x = 1\nß = 2".into());
        let b = sources.add("b.toml".into(), "y".into());
        for (offset, path, line, column, source) in [
            (a, "games/a.toml", 1, 1, "x = 1"),
            (a + 4, "games/a.toml", 1, 5, "x = 1"),
            (a + 6, "games/a.toml", 2, 1, "ß = 2"),
            (a + 9, "games/a.toml", 2, 3, "ß = 2"),
            (a + 12, "games/a.toml", 2, 6, "ß = 2"),
            (b, "b.toml", 1, 1, "y"),
            (b + 70, "b.toml", 1, 2, "y"),
        ] {
            let source = source.to_owned();
            let problem = Problem {
                path: path.into(),
                line,
                column,
                message: "wrong".into(),
                source,
            };
            assert_eq!(sources.problem(offset, "wrong".into()), problem, "{offset}");
        }
        assert_eq!(
            sources.resolve(a, "../fields/f.toml"),
            Path::new("fields/f.toml")
        );
        assert_eq!(sources.resolve(b, "../c.toml"), Path::new("../c.toml"));
    }
}
