//! Checks tables that name a test in each row: the tests must exist.

use crate::rule::Breaches;
use crate::text::quoted;
use crate::tree::Tree;

/// The heading of the column that names tests, as `file::name`.
const HEAD: &str = "shown by";
/// The entry of a row without a test.
const UNTESTED: &str = "not tested";
/// The document with such a table.
const FAULTS: &str = "docs/faults.md";

/// Finds rows that name no test or a missing one.
pub(crate) fn shown_by(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.files.iter().filter(|(path, _)| path.ends_with(".md")) {
        let rows = rows(text);
        if rows.is_empty() && path == FAULTS {
            breaches.push(format!(
                "{path}:1: has no table with a last column {HEAD:?}"
            ));
        }
        for (number, cell) in rows {
            breaches.extend(
                problems(tree, cell)
                    .into_iter()
                    .map(|problem| format!("{path}:{number}: {problem}")),
            );
        }
    }
    breaches
}

/// The last cells of the rows of such tables, with their line numbers.
fn rows(text: &str) -> Vec<(usize, &str)> {
    let mut is_inside = false;
    let mut rows = vec![];
    for (i, line) in text.lines().enumerate() {
        let cell = line
            .strip_prefix('|')
            .and_then(|row| row.trim_end().strip_suffix('|')?.split('|').next_back());
        match cell.map(str::trim) {
            None => is_inside = false,
            Some(HEAD) => is_inside = true,
            Some(cell) if is_inside && !cell.starts_with("---") => rows.push((i + 1, cell)),
            Some(_) => {}
        }
    }
    rows
}

fn problems(tree: &Tree, cell: &str) -> Breaches {
    let tests: Vec<String> = quoted(cell).map(|(_, test)| test).collect();
    if tests.is_empty() && cell != UNTESTED {
        return vec![format!(
            "names no test, expected `file::name`, or: {UNTESTED}"
        )];
    }
    tests
        .iter()
        .filter(|test| !exists(tree, test))
        .map(|test| format!("there is no test `{test}`"))
        .collect()
}

fn exists(tree: &Tree, test: &str) -> bool {
    let Some((path, name)) = test.split_once("::") else {
        return false;
    };
    let Some(text) = tree.text(path) else {
        return false;
    };
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    match path.rsplit('.').next() {
        Some("rs") => {
            let begin = format!("fn {name}(");
            let Some(at) = lines.iter().position(|line| line.starts_with(&begin)) else {
                return false;
            };
            lines[..at]
                .iter()
                .rev()
                .take_while(|line| line.starts_with("#["))
                .any(|line| *line == "#[test]")
        }
        // Browser tests of the page, and text scenarios.
        Some("mjs") => lines
            .iter()
            .any(|line| line.starts_with(&format!("test('{name}',"))),
        Some("txt") => lines
            .iter()
            .any(|line| line.strip_prefix("## ") == Some(name)),
        _ => false,
    }
}
