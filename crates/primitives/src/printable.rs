//! Makes strings from files and other nodes safe for a terminal by escaping control sequences.

use std::borrow::Cow;
use std::fmt::Write;

/// Maximum length of a printed line, characters.
const LINE_MAX: usize = 2000;
/// Number of characters shown from the end of a longer line.
const TAIL: usize = 400;

/// Escapes a multi-line string as in JSON: control characters, except line breaks and tabs, and
/// characters that change the writing direction.
pub fn text(text: &str) -> Cow<'_, str> {
    spelt(text, |character| {
        !matches!(character, '\n' | '\t') && steers(character)
    })
}

/// Like [`text`], for a string that may contain colours (`ESC [ numbers m`).
pub fn coloured(text: &str) -> String {
    let mut parts = text.split('\x1b');
    let mut shown = self::text(parts.next().unwrap_or_default()).into_owned();
    for part in parts {
        let numbers = |c: char| c.is_ascii_digit() || c == ';';
        let is_colour = part
            .strip_prefix('[')
            .is_some_and(|rest| rest.trim_start_matches(numbers).starts_with('m'));
        shown += if is_colour { "\x1b" } else { "\\u001b" };
        shown += &self::text(part);
    }
    shown
}

/// Escapes one line of a message. Omits the middle of a very long one.
pub fn line(text: &str) -> String {
    shortened(&spelt(text, steers)).into_owned()
}

/// A message of one or more lines, each escaped as by [`line()`].
pub fn message(text: &str) -> String {
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// Like [`message`], for a message that may contain colours.
pub fn coloured_message(text: &str) -> String {
    text.split('\n')
        .map(|line| shortened(&coloured(line)).into_owned())
        .collect::<Vec<_>>()
        .join("\n")
}

fn steers(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn spelt(text: &str, is_spelt: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_spelt) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_spelt(character) {
            write!(shown, "\\u{:04x}", u32::from(character))
                .expect("writing to a string cannot fail");
        } else {
            shown.push(character);
        }
    }
    Cow::Owned(shown)
}

fn shortened(text: &str) -> Cow<'_, str> {
    // The byte count is already known, and the character count is never larger.
    let surplus = if text.len() > LINE_MAX {
        text.chars().count().saturating_sub(LINE_MAX)
    } else {
        0
    };
    if surplus == 0 {
        return Cow::Borrowed(text);
    }
    let head: String = text.chars().take(LINE_MAX - TAIL).collect();
    let tail: String = text.chars().skip(LINE_MAX - TAIL + surplus).collect();
    Cow::Owned(format!("{head} … ({surplus} characters) … {tail}"))
}

/// Appends a line to a string, without trailing blanks.
pub fn add_line(text: &mut String, args: std::fmt::Arguments<'_>) {
    text.push_str(args.to_string().trim_end_matches(' '));
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_controls_the_terminal() {
        for (raw, want) in [
            ("blue_one → 5 m\n\tand on", "blue_one → 5 m\n\tand on"),
            (
                "\x1b[2J\x1b]0;owned\x07",
                "\\u001b[2J\\u001b]0;owned\\u0007",
            ),
            ("over\rwritten\x08", "over\\u000dwritten\\u0008"),
            ("\u{9b}31m\u{7f}", "\\u009b31m\\u007f"),
            ("\u{202e}txt.exe", "\\u202etxt.exe"),
        ] {
            assert_eq!(text(raw), want);
        }
        assert_eq!(line("a\nb"), "a\\u000ab", "one line stays one");
        assert_eq!(message("a\nb\x1b"), "a\nb\\u001b");
        assert_eq!(
            coloured("\x1b[94mblue\x1b[0m \x1b[1;31mx\x1b[2J\x1b"),
            "\x1b[94mblue\x1b[0m \x1b[1;31mx\\u001b[2J\\u001b"
        );
    }

    #[test]
    fn of_a_very_long_line_both_ends_are_shown() {
        let long = format!("key {} is unknown, expected a name", "ß".repeat(1_000_000));
        let shown = line(&long);
        assert!(
            shown.chars().count() < LINE_MAX + 50,
            "{} characters",
            shown.chars().count()
        );
        assert!(shown.starts_with("key ßß") && shown.ends_with("ß is unknown, expected a name"));
        assert_eq!(line(&"x".repeat(LINE_MAX)), "x".repeat(LINE_MAX));
    }
}
