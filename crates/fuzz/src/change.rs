//! Mutates real inputs: bytes, words and numbers, lines, and pieces of other inputs.

use crate::Dice;
use std::ops::Range;

/// Maximum length of a mutated input, bytes.
const LENGTH_MAX: usize = 1 << 20;

/// Edge-case numbers in the notation of TOML, JSON or CSV, words with a meaning in these formats,
/// and characters that end a string or control a terminal when printed.
const WORDS: [&str; 28] = [
    "0",
    "-0.0",
    "-1",
    "0.5",
    "1e-9",
    "255",
    "256",
    "65536",
    "4294967296",
    "9223372036854775807",
    "18446744073709551616",
    "1e16",
    "1e308",
    "1e309",
    "1e-320",
    "nan",
    "-inf",
    "null",
    "true",
    "\"\"",
    "[]",
    "{}",
    "base",
    "\"../x\"",
    "\0",
    "\u{9b}",
    "\u{202e}",
    "\n",
];

/// Edge-case integers and floating-point numbers.
const NUMBERS: [u64; 16] = [
    0,
    1,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    i64::MAX as u64,
    i64::MIN as u64,
    u64::MAX,
    1.0_f64.to_bits(),
    f64::NAN.to_bits(),
    f64::INFINITY.to_bits(),
    f64::MAX.to_bits(),
    f64::MIN_POSITIVE.to_bits(),
];

/// Mutates an input a few times, sometimes with pieces of other inputs.
pub fn change(input: &[u8], others: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = input.to_vec();
    // Usually few, so that mutated inputs pass the first check.
    let most = *dice.one_of(&[1, 1, 2, 3, 8]);
    for _ in 0..=dice.roll(most) {
        once(&mut bytes, others, dice);
    }
    bytes.truncate(LENGTH_MAX);
    bytes
}

fn once(bytes: &mut Vec<u8>, others: &[Vec<u8>], dice: &mut Dice) {
    let place = place(bytes, dice);
    match dice.roll(10) {
        0 => drop(bytes.drain(place)),
        1 => bytes.truncate(place.start),
        2 => {
            let copy = bytes[place.clone()].repeat(1 + dice.roll(4));
            bytes.splice(place.start..place.start, copy);
        }
        3 | 4 => drop(bytes.splice(place, dice.one_of(&WORDS).bytes())),
        5 => put(bytes, &[dice.number() as u8], dice),
        6 => {
            let size = *dice.one_of(&[1, 2, 4, 4, 8, 8]);
            let number = dice.one_of(&NUMBERS).wrapping_add(dice.roll(3) as u64);
            put(bytes, &number.to_le_bytes()[..size], dice);
        }
        7 => {
            let other = dice.one_of(others);
            put(bytes, &other[dice.range(other.len(), 64)], dice);
        }
        _ => {
            // Preferably replace a number with a number and a word with a word.
            let other = dice.one_of(others);
            let kind = kind(&bytes[place.clone()]);
            let mut pieces = (0..8).map(|_| &other[self::place(other, dice)]);
            let piece = pieces.find(|piece| self::kind(piece) == kind);
            bytes.splice(place, piece.unwrap_or_default().iter().copied());
        }
    }
}

/// A random place: a word or number, a line, or a few bytes.
fn place(bytes: &[u8], dice: &mut Dice) -> Range<usize> {
    let few = dice.range(bytes.len(), 16);
    let belongs: fn(&u8) -> bool = match dice.roll(4) {
        0 => return few,
        1 => |byte| *byte != b'\n',
        _ => |byte| byte.is_ascii_alphanumeric() || b"_+-.".contains(byte),
    };
    let (before, after) = bytes.split_at(few.start);
    let ends = |byte: &u8| !belongs(byte);
    let from = before.iter().rposition(ends).map_or(0, |at| at + 1);
    from..few.start + after.iter().position(ends).unwrap_or(after.len())
}

/// Whether a piece begins with a letter, and whether it begins with a digit.
fn kind(piece: &[u8]) -> [bool; 2] {
    [u8::is_ascii_alphabetic, u8::is_ascii_digit].map(|is| piece.first().is_some_and(is))
}

/// Overwrites a random place with as much of a piece as fits. Usually this is where a message has
/// numbers: at a multiple of their size after the four bytes of the encapsulation.
fn put(bytes: &mut [u8], piece: &[u8], dice: &mut Dice) {
    let step = match dice.roll(4) {
        0 => 1,
        _ => piece.len().next_power_of_two().min(8),
    };
    let at = 4 % step + step * dice.roll(bytes.len() / step + 1);
    let old = bytes.iter_mut().skip(at);
    old.zip(piece).for_each(|(old, new)| *old = *new);
}
