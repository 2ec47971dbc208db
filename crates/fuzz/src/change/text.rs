//! Mutates texts (TOML, JSON, CSV, sentences): words, numbers and lines replace their own kind.

use super::count;
use crate::Dice;

/// Maximum length of a mutated text, bytes.
const LENGTH_MAX: usize = 1 << 17;

/// Edge-case numbers in the notation of TOML, JSON or CSV.
const NUMBERS: [&str; 24] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "0.5",
    "1e-9",
    "1e9",
    "255",
    "256",
    "65536",
    "4294967296",
    "9223372036854775807",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1e15",
    "1e16",
    "1e308",
    "1e309",
    "1e-320",
    "nan",
    "-inf",
    "999999999999999999999999999999999999999999",
];

/// Words with a meaning to some reader.
const WORDS: [&str; 13] = [
    "null",
    "true",
    "false",
    "\"\"",
    "[]",
    "{}",
    "\"\\u0000\"",
    "\"../x\"",
    "\"é\"",
    "base",
    ",",
    "\n",
    "[[x]]",
];

/// Characters that end a text, or control a terminal when printed.
const CHARACTERS: [char; 12] = [
    '\0', '\x1b', '\x7f', '\u{9b}', '\u{202e}', '\u{feff}', 'ß', '"', '\\', '\n', '\r', '#',
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Number,
    Word,
    Quoted,
    Other,
}

/// Pieces of many texts, as replacements.
pub struct Pieces {
    /// Numbers, words and quoted texts, by [`Kind`].
    kinds: [Vec<String>; 3],
    lines: Vec<String>,
}

impl Pieces {
    /// Collects the pieces of the texts.
    pub fn of(texts: &[Vec<u8>]) -> Pieces {
        let numbers = NUMBERS.map(str::to_owned).to_vec();
        let words = WORDS.map(str::to_owned).to_vec();
        let mut pieces = Pieces {
            kinds: [numbers, words, vec!["\"\"".to_owned()]],
            lines: vec![String::new()],
        };
        for text in texts.iter().map(|text| String::from_utf8_lossy(text)) {
            pieces.lines.extend(
                text.lines()
                    .filter(|line| line.len() < 1000)
                    .map(str::to_owned),
            );
            for (kind, piece) in split(&text)
                .into_iter()
                .filter(|(_, piece)| piece.len() < 200)
            {
                pieces
                    .kinds
                    .get_mut(kind as usize)
                    .into_iter()
                    .for_each(|all| all.push(piece.to_owned()));
            }
        }
        for all in pieces.kinds.iter_mut().chain([&mut pieces.lines]) {
            all.sort();
            all.dedup();
        }
        pieces
    }

    /// A random piece of the same kind.
    fn like(&self, kind: Kind, dice: &mut Dice) -> &str {
        match kind {
            Kind::Number if dice.roll(2) == 0 => NUMBERS[dice.roll(NUMBERS.len())],
            Kind::Other => WORDS[dice.roll(WORDS.len())],
            kind => {
                let all = &self.kinds[kind as usize];
                &all[dice.roll(all.len())]
            }
        }
    }

    /// One of the texts with a few mutations.
    pub fn change(&self, texts: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
        let mut text = String::from_utf8_lossy(&texts[dice.roll(texts.len())]).into_owned();
        for _ in 0..count(dice) {
            text = if dice.roll(3) == 0 {
                self.change_line(&text, dice)
            } else {
                self.change_piece(&text, dice)
            };
            if text.len() > LENGTH_MAX {
                break;
            }
        }
        let mut bytes = text.into_bytes();
        if dice.roll(16) == 0 && !bytes.is_empty() {
            let at = dice.roll(bytes.len());
            bytes[at] = dice.number() as u8;
        }
        bytes
    }

    fn line(&self, dice: &mut Dice) -> &str {
        &self.lines[dice.roll(self.lines.len())]
    }

    fn change_piece(&self, text: &str, dice: &mut Dice) -> String {
        let mut pieces: Vec<(Kind, &str)> = split(text);
        // Half of the time a number, because numbers affect a program most.
        let numbers: Vec<usize> = (0..pieces.len())
            .filter(|i| pieces[*i].0 == Kind::Number)
            .collect();
        let at = if numbers.is_empty() || dice.roll(2) == 0 {
            dice.roll(pieces.len())
        } else {
            *dice.one_of(&numbers)
        };
        let Some((kind, piece)) = pieces.get(at).copied() else {
            return dice.one_of(&WORDS).to_string();
        };
        let longer;
        match dice.roll(8) {
            0 => drop(pieces.remove(at)),
            1 => pieces.insert(at, (kind, piece)),
            2 => {
                let other = dice.roll(pieces.len());
                pieces.swap(at, other);
            }
            3 => {
                let mut changed = piece.to_owned();
                let places: Vec<usize> = changed.char_indices().map(|(place, _)| place).collect();
                changed.insert(*dice.one_of(&places), *dice.one_of(&CHARACTERS));
                longer = changed;
                pieces[at].1 = &longer;
            }
            4 if dice.roll(20) == 0 => {
                longer = piece.repeat(1 + dice.roll(2000));
                pieces[at].1 = &longer;
            }
            _ => pieces[at].1 = self.like(kind, dice),
        }
        pieces.into_iter().map(|(_, piece)| piece).collect()
    }

    fn change_line(&self, text: &str, dice: &mut Dice) -> String {
        let mut lines: Vec<&str> = text.split('\n').collect();
        let at = dice.roll(lines.len());
        match dice.roll(5) {
            0 => drop(lines.remove(at)),
            1 => lines.insert(at, lines[dice.roll(lines.len())]),
            2 => lines[at] = self.line(dice),
            3 => lines.insert(at, self.line(dice)),
            _ => lines.truncate(at + 1),
        }
        lines.join("\n")
    }
}

/// Splits a text into pieces without losing anything.
fn split(text: &str) -> Vec<(Kind, &str)> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (kind, length) = match first {
            '"' | '\'' => (Kind::Quoted, quoted_length(rest, first)),
            '0'..='9' | '-' => (
                Kind::Number,
                length_of(rest, |c| c.is_ascii_alphanumeric() || "-+._".contains(c)),
            ),
            c if c.is_alphabetic() => (
                Kind::Word,
                length_of(rest, |c| c.is_alphanumeric() || c == '_'),
            ),
            c if c.is_whitespace() => (Kind::Other, length_of(rest, char::is_whitespace)),
            c => (Kind::Other, c.len_utf8()),
        };
        let (piece, after) = rest.split_at(length);
        pieces.push((kind, piece));
        rest = after;
    }
    pieces
}

fn length_of(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|c| !belongs(c)).unwrap_or(text.len())
}

/// Length of a quoted text with its quotes; 1 if the line ends first.
fn quoted_length(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '\n' => break,
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            c if c == quote => return at + 1,
            _ => {}
        }
    }
    1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_split_into_words_and_numbers_and_nothing_is_lost() {
        let text = "a_b = -1.5e3 # ß\n\"x\\\"y\" 'open\n{\"k\":[1]}";
        let pieces = split(text);
        assert_eq!(
            pieces.iter().map(|(_, piece)| *piece).collect::<String>(),
            text
        );
        for want in [
            (Kind::Word, "a_b"),
            (Kind::Number, "-1.5e3"),
            (Kind::Quoted, "\"x\\\"y\""),
            (Kind::Quoted, "\"k\""),
        ] {
            assert!(pieces.contains(&want), "no {want:?} in {pieces:?}");
        }
    }
}
