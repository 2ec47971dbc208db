//! Parses expressions as CEL, and records where each part is in the file.

use crate::diagnostics::Diagnostics;
use cel::common::ast::{IdedExpr, SourceInfo};
use cel::parser::PrattParser;
use std::sync::Arc;

/// Maximum length of an expression, characters.
pub(super) const LONGEST: usize = 1000;
/// Maximum nesting depth.
pub(super) const DEEPEST: usize = 30;

/// A parsed expression.
pub(super) struct Parsed {
    pub(super) root: IdedExpr,
    places: Option<Arc<SourceInfo>>,
    /// The offset in the virtual text of every byte of the expression, and of its end.
    offsets: Vec<usize>,
}

impl Parsed {
    /// The offset of a part in the virtual text.
    pub(super) fn place(&self, part: &IdedExpr) -> usize {
        let places = self.places.as_ref();
        let range = places.and_then(|places| places.offset_for(part.id));
        let place = self
            .offsets
            .get(range.map_or(0, |(start, _)| start as usize));
        place.or(self.offsets.last()).copied().unwrap_or(0)
    }
}

/// Parses the expression of `key` at `at`; reports syntax errors.
pub(super) fn parse(diagnostics: &Diagnostics, key: &str, at: usize, text: &str) -> Option<Parsed> {
    let length = text.chars().count();
    if length > LONGEST {
        let message = format!("`{key}` is {length} characters long, expected at most {LONGEST}");
        diagnostics.note(at, message);
        return None;
    }
    let offsets = offsets(diagnostics.sources.borrow().text_from(at), at, text);
    let parser = || PrattParser::new().max_recursion_depth(DEEPEST as u16);
    match parser().parse(text) {
        Ok(root) => {
            // The parser reports the positions of parts only if the syntax is invalid, so add a
            // surplus bracket.
            let places = parser().parse(&format!("{text}\n)")).err();
            let errors = places.into_iter().flat_map(|errors| errors.errors);
            let places = errors.filter_map(|error| error.source_info).next();
            Some(Parsed {
                root,
                places,
                offsets,
            })
        }
        Err(errors) => {
            let error = errors.errors.first()?;
            let start = byte_at(text, error.pos);
            let at = offsets.get(start).or(offsets.last()).copied().unwrap_or(at);
            let complaint = complaint(&error.msg, text.get(start..).unwrap_or_default());
            diagnostics.note(at, format!("`{key}` {complaint}"));
            None
        }
    }
}

/// The byte offset in `text` of a line and a column (in characters), both counted from 1; (0, 0) is
/// the start.
fn byte_at(text: &str, (line, column): (isize, isize)) -> usize {
    let lines = (line - 1).max(0) as usize;
    let start: usize = text.split_inclusive('\n').take(lines).map(str::len).sum();
    let rest = text.get(start..).unwrap_or_default();
    let columns = (column - 1).max(0) as usize;
    let byte = rest.char_indices().nth(columns).map(|(byte, _)| byte);
    start + byte.unwrap_or(rest.len())
}

/// Rewords the parser's error in the terms of strategy files; `rest` is the expression from the
/// error onwards.
fn complaint(message: &str, rest: &str) -> String {
    if message.contains("recursion limit") {
        return format!("is nested too deeply, expected at most {DEEPEST} levels of brackets");
    }
    if rest.trim().is_empty() {
        let wanted = if message.starts_with("expected") {
            message
        } else {
            "expected a value"
        };
        return format!("ends unexpectedly, {wanted}");
    }
    let token = token(rest);
    let guess = match token {
        "=" => " (did you mean ==?)",
        "and" | "AND" | "&" => " (did you mean &&?)",
        "or" | "OR" | "|" => " (did you mean ||?)",
        "not" | "NOT" => " (did you mean !?)",
        _ => "",
    };
    match message {
        _ if message.contains("expecting <EOF>") => {
            format!("contains {token:?}, expected an operator or the end{guess}")
        }
        "unexpected token" | "unexpected character" => {
            format!("contains {token:?}, expected a value{guess}")
        }
        _ if message.starts_with("unexpected single") => {
            format!("contains {token:?}, expected an operator{guess}")
        }
        _ if message.starts_with("reserved identifier") => {
            format!("contains {token:?}, expected a name that CEL does not reserve")
        }
        _ if message.starts_with("expected") => format!("contains {token:?}, {message}"),
        _ => format!("contains {token:?}: {message}"),
    }
}

/// The first word or symbol of `rest`.
fn token(rest: &str) -> &str {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    let end = match rest.chars().next() {
        Some(first) if is_word(first) => rest.find(|c| !is_word(c)).unwrap_or(rest.len()),
        Some(first) => first.len_utf8(),
        None => 0,
    };
    &rest[..end]
}

/// The offset of each byte of a string value, and of its end. `source` begins with the value as
/// written, at offset `start`.
fn offsets(source: &str, start: usize, value: &str) -> Vec<usize> {
    let mut quotes = ["\"\"\"", "'''", "\"", "'"].into_iter();
    let opening = quotes.find(|quotes| source.starts_with(quotes));
    let opening = opening.unwrap_or("");
    let has_escapes = opening.starts_with('"');
    let mut at = opening.len();
    if opening.len() == 3 {
        let newline = ["\r\n", "\n"]
            .into_iter()
            .find(|newline| source[at..].starts_with(newline));
        at += newline.map_or(0, str::len);
    }
    let mut offsets = vec![];
    for c in value.chars() {
        let mut rest = source.get(at..).unwrap_or_default();
        // A backslash at the end of a line, and the white space after it, are not part of the
        // value.
        let continued = |escape: &&str| has_escapes && escape.starts_with(char::is_whitespace);
        while let Some(escape) = rest.strip_prefix('\\').filter(continued) {
            rest = escape.trim_start();
        }
        at = source.len() - rest.len();
        offsets.extend(std::iter::repeat_n(start + at, c.len_utf8()));
        at += match rest.as_bytes() {
            [b'\\', b'u', ..] if has_escapes => 6,
            [b'\\', b'U', ..] if has_escapes => 10,
            [b'\\', b'x', ..] if has_escapes => 4,
            [b'\\', ..] if has_escapes => 2,
            [b'\r', b'\n', ..] if c == '\n' => 2,
            _ => c.len_utf8(),
        };
    }
    offsets.push(start + at);
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_of_a_string_is_found_where_it_was_written() {
        for (source, value, want) in [
            ("\"ab\" # c", "ab", vec![11, 12, 13]),
            ("'a\\b'", "a\\b", vec![11, 12, 13, 14]),
            ("\"\"\"\nab\"\"\"", "ab", vec![14, 15, 16]),
            ("'''\r\nab'''", "ab", vec![15, 16, 17]),
            (r#""\"x\u00e9y""#, "\"xéy", vec![11, 13, 14, 14, 20, 21]),
            ("\"\"\"a \\\n   b\"\"\"", "a b", vec![13, 14, 20, 21]),
        ] {
            assert_eq!(offsets(source, 10, value), want, "{source}");
        }
    }

    #[test]
    fn a_line_and_a_column_are_a_byte() {
        for (pos, want) in [
            ((1, 1), 0),
            ((1, 3), 3),
            ((2, 1), 5),
            ((2, 9), 7),
            ((0, 0), 0),
            ((9, 9), 7),
        ] {
            assert_eq!(byte_at("aéb\ncd", pos), want, "{pos:?}");
        }
    }
}
