//! Syntax errors of a file: one message per mistake, without the parser's follow-up errors.

use toml::de::DeTable;

/// Maximum number of reported mistakes; a file with more is not a scenario file.
const MOST: usize = 20;

/// Each mistake with its byte offset in the text.
pub(super) fn mistakes(text: &str) -> Vec<(usize, String)> {
    let mut text = text.to_owned();
    let mut mistakes = vec![];
    while mistakes.len() < MOST {
        let errors = DeTable::parse_recoverable(&text).1;
        let Some(first) = errors
            .iter()
            .min_by_key(|error| error.span().map_or(0, |span| span.start))
        else {
            break;
        };
        let Some(span) = first.span() else {
            mistakes.push((
                0,
                "found a key with too many parts, expected at most 3".to_owned(),
            ));
            break;
        };
        let (start, end) = line_of(&text, span.start);
        mistakes.push(
            in_words(&text[start..end], start)
                .unwrap_or_else(|| (span.start, first.message().to_owned())),
        );
        // Remove this line: any remaining error is a separate mistake.
        text.replace_range(start..end, &" ".repeat(end - start));
    }
    mistakes.sort();
    mistakes
}

/// Start and end of the line that contains `at`; if `at` is the end of the file, of the last line
/// with content.
fn line_of(text: &str, at: usize) -> (usize, usize) {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let bounds = |at: usize| {
        let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        (
            start,
            text[at..]
                .find('\n')
                .map_or(text.len(), |newline| at + newline),
        )
    };
    let (start, end) = bounds(at);
    match text[..start].trim_end() {
        before if text[start..end].trim().is_empty() && !before.is_empty() => bounds(before.len()),
        _ => (start, end),
    }
}

/// Common mistakes: a value without quotes, or a missing value.
fn in_words(line: &str, start: usize) -> Option<(usize, String)> {
    let (key, value) = line.split_once('=')?;
    let at = start + line.len() - value.trim_start().len();
    let value = value.split('#').next().unwrap_or_default().trim();
    let key = key.trim();
    if key.is_empty() || key.contains(['[', '{', '"', '\'', '#']) {
        return None;
    }
    if value.is_empty() {
        return Some((at, format!("{key} has no value, expected one after =")));
    }
    let is_bare = value.starts_with(|first: char| first.is_alphabetic() || "./~_".contains(first))
        && !value.contains(['"', '\'']);
    is_bare.then(|| (at, format!("{value} is not in quotes, expected {value:?}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_is_told_once_and_the_next_one_too() {
        let told = |text: &str| {
            let told = mistakes(text)
                .into_iter()
                .map(|(at, message)| format!("{at}: {message}"));
            told.collect::<Vec<_>>().join("; ")
        };
        for (text, want) in [
            ("a = 1\nb = \"x\"", ""),
            (
                "sea = ../seas/gale.toml",
                "6: ../seas/gale.toml is not in quotes, expected \"../seas/gale.toml\"",
            ),
            (
                "sea = gale # strong\nx =  \ny = [1,",
                "6: gale is not in quotes, expected \"gale\"; 25: x has no value, expected one after =; 33: unclosed array, expected `]`",
            ),
            (
                "roles = [\"idle]\nassignment = \"fixed\"",
                "15: invalid basic string, expected `\"`",
            ),
            ("ß = ./ß\n", "5: ./ß is not in quotes, expected \"./ß\""),
        ] {
            assert_eq!(told(text), want, "{text}");
        }
        assert!(mistakes(&"= \n".repeat(1000)).len() <= MOST);
        assert!(mistakes("\u{feff}[").len() <= MOST && mistakes(&"[".repeat(10_000)).len() <= MOST);
    }
}
