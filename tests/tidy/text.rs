//! Parses lines, manifests and documents.

/// Numbered lines without comments, up to the tests at the end of the file.
pub(crate) fn code_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines: Vec<&str> = text.lines().collect();
    let opens_tests = |two: &[&str]| {
        two[0] == "#[cfg(test)]" && two[1].starts_with("mod ") && two[1].ends_with('{')
    };
    let end = lines
        .windows(2)
        .position(opens_tests)
        .unwrap_or(lines.len());
    let numbered = lines.into_iter().take(end).enumerate();
    numbered.map(|(i, line)| (i + 1, without_comment(line)))
}

/// The line up to a `//` that begins a comment (not the slashes of an address such as `http://`).
fn without_comment(line: &str) -> &str {
    let comment = line.match_indices("//").find(|(at, _)| {
        line[..*at]
            .chars()
            .next_back()
            .is_none_or(char::is_whitespace)
    });
    comment.map_or(line, |(at, _)| &line[..at])
}

/// Whether `word` occurs in the line as a separate word, not as the end of a longer name.
pub(crate) fn names(line: &str, word: &str) -> bool {
    let alone =
        |(at, _): (usize, &str)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    line.match_indices(word).any(alone)
}

/// Line number, section and name of every entry in a manifest's dependency sections.
pub(crate) fn manifest_entries(text: &str) -> Vec<(usize, String, String)> {
    let mut section = String::new();
    let mut entries = Vec::new();
    for (number, line) in text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.trim()))
    {
        if let Some(header) = line
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
        {
            section = header.to_owned();
            // `[dependencies.name]` is an entry by itself.
            if let Some((of, name)) = header.rsplit_once("dependencies.") {
                entries.push((number, format!("{of}dependencies"), name.to_owned()));
            }
            continue;
        }
        let name: String = line
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '-' || *c == '_')
            .collect();
        if section.ends_with("dependencies") && !name.is_empty() {
            entries.push((number, section.clone(), package_of(line).unwrap_or(name)));
        }
    }
    entries
}

/// The package behind a renamed entry, without our prefix.
fn package_of(line: &str) -> Option<String> {
    let package = line.split("package = \"").nth(1)?.split('"').next()?;
    Some(
        package
            .strip_prefix("squall-")
            .unwrap_or(package)
            .to_owned(),
    )
}

/// Every string in single backticks outside fenced blocks, with its line number.
pub(crate) fn quoted(text: &str) -> impl Iterator<Item = (usize, String)> {
    prose(text).flat_map(|(number, line)| {
        line.split('`')
            .skip(1)
            .step_by(2)
            .map(move |word| (number, word.to_owned()))
    })
}

/// Lines outside fenced blocks, numbered from 1; lines inside are empty.
pub(crate) fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_fenced = false;
    text.lines().enumerate().map(move |(i, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_fenced ^= is_fence;
        (
            i + 1,
            if is_fence || is_fenced {
                ""
            } else {
                line.trim()
            },
        )
    })
}

/// Whether a word in backticks is a path in this repository: it has a folder or a file extension,
/// and no character used in commands, keys or Rust.
pub(crate) fn is_path(word: &str) -> bool {
    let foreign = word.starts_with(['/', '-', '.', '~']) && !word.starts_with(".ci/")
        || word.starts_with(concat!("squ", "all/"));
    let odd =
        word.contains("::") || word.contains([' ', '<', '>', '*', ':', '(', '=', '|', '{', '$']);
    let ending = [".rs", ".toml", ".md", ".msg", ".json"]
        .iter()
        .any(|end| word.ends_with(end));
    !foreign && !odd && (ending || word.contains('/'))
}
