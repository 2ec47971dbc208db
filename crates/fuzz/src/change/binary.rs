//! Mutates binary inputs: numbers at likely positions, lengths, and pieces of other inputs.

use super::count;
use crate::Dice;

/// Maximum length of a mutated input, bytes.
const LENGTH_MAX: usize = 1 << 20;

/// Edge-case integers.
const EDGES: [u64; 12] = [
    0,
    1,
    2,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    0x8000_0000_0000_0000,
    u64::MAX,
];

/// Edge-case floating-point numbers.
const POINTS: [f64; 10] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN_POSITIVE,
    1e-320,
];

/// One of the inputs with a few mutations.
pub fn change(inputs: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = dice.one_of(inputs).clone();
    for _ in 0..count(dice) {
        once(&mut bytes, inputs, dice);
    }
    bytes.truncate(LENGTH_MAX);
    bytes
}

fn once(bytes: &mut Vec<u8>, inputs: &[Vec<u8>], dice: &mut Dice) {
    match dice.roll(9) {
        0 => {
            let at = dice.roll(bytes.len());
            bytes
                .iter_mut()
                .skip(at)
                .take(1)
                .for_each(|byte| *byte = dice.number() as u8);
        }
        1 => {
            let at = dice.roll(bytes.len());
            bytes
                .iter_mut()
                .skip(at)
                .take(1)
                .for_each(|byte| *byte ^= 1 << dice.roll(8));
        }
        2 | 3 => {
            // Numbers lie at multiples of their size after the four bytes of the encapsulation, or
            // anywhere.
            let size = *dice.one_of(&[1, 2, 4, 4, 8, 8]);
            let edge = dice
                .one_of(&EDGES)
                .wrapping_add(dice.roll(3) as u64)
                .wrapping_sub(1);
            put(bytes, &edge.to_le_bytes()[..size], dice);
        }
        4 => put(bytes, &dice.one_of(&POINTS).to_le_bytes(), dice),
        5 => drop(bytes.drain(dice.range(bytes.len(), 16))),
        6 => bytes.truncate(dice.roll(bytes.len() + 1)),
        7 => {
            let copy = bytes[dice.range(bytes.len(), 64)].repeat(1 + dice.roll(4));
            let to = dice.roll(bytes.len() + 1);
            bytes.splice(to..to, copy);
        }
        _ => {
            let other = dice.one_of(inputs);
            let piece = &other[dice.range(other.len(), 64)];
            put(bytes, piece, dice);
        }
    }
}

/// Overwrites a random place with a piece, as far as it fits.
fn put(bytes: &mut [u8], piece: &[u8], dice: &mut Dice) {
    let step = if dice.roll(4) == 0 {
        1
    } else {
        piece.len().next_power_of_two().min(8)
    };
    let first = if step == 1 { 0 } else { 4 % step };
    let at = first + step * dice.roll(bytes.len() / step + 1);
    bytes
        .iter_mut()
        .skip(at)
        .zip(piece)
        .for_each(|(byte, new)| *byte = *new);
}
