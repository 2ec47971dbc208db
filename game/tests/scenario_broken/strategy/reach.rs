//! Mistakes in strategies: modes that can never be.

use super::{VARIABLES, assert_broken};

const CASES: &str = r#"
## a contradiction
mode = [
  { name = "a", when = "tagged && !tagged" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## a constant
mode = [
  { name = "a", when = "1 > 2" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## after the same condition
mode = [
  { name = "a", when = "tagged" },
  { name = "b", when = "own_side && tagged" }, #~ 3: mode b can never be (whenever it could be, one before it is: a), expected one that can
  { name = "c" },
]

## after everything
mode = [
  { name = "a", when = "tagged" },
  { name = "b", when = "!tagged" },
  { name = "c" }, #~ 3: mode c can never be (whenever it could be, one before it is: a, b), expected one that can
]

## after all numbers
mode = [
  { name = "a", when = "enemies < 2" },
  { name = "b", when = "enemies >= 2" },
  { name = "c" }, #~ 3: mode c can never be (whenever it could be, one before it is: a, b), expected one that can
]

## between two whole numbers
mode = [
  { name = "a", when = "enemies > 1 && enemies < 2" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## below the least
mode = [
  { name = "a", when = "distance(CF) < 0" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## a fact that implies another
mode = [
  { name = "a", when = "has_flag && !enemy_flag_taken" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b", when = "enemy_in_zone && enemies_in_zone == 0" }, #~ 3: mode b can never be (its when never holds), expected one that can
  { name = "c", when = "enemies_in_zone > 1 && !enemy_in_zone" }, #~ 3: mode c can never be (its when never holds), expected one that can
  { name = "d" },
]

## a part that the whole rules out
mode = [
  { name = "a", when = "tagged" },
  { name = "b" },
  { name = "c", in = "b", when = "tagged" }, #~ 3: mode b:c can never be (its when never holds in the modes that it is in), expected one that can
  { name = "d", in = "b" },
]

## a part of the whole that is always there
mode = [
  { name = "a", when = "tagged" },
  { name = "b", in = "a", when = "tagged" },
  { name = "c", in = "a" }, #~ 3: mode a:c can never be (whenever it could be, one before it is: b), expected one that can
  { name = "d" },
]

## parts of a mode that can never be
mode = [
  { name = "a", when = "tagged && !tagged" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b", in = "a", when = "own_side" },
  { name = "c", in = "a" },
  { name = "d" },
]

## a truth that nobody changes
mode = [
  { name = "a", when = "alarmed" }, #~ 3: mode a can never be (its when never holds; alarmed is only ever false), expected one that can
  { name = "b" },
]

## a text that nobody gives
mode = [
  { name = "a", when = "phase == 'return'" }, #~ 3: mode a can never be (its when never holds; phase is only ever 'go'), expected one that can
  { name = "b" },
]

## a number that nobody changes
mode = [
  { name = "a", when = "laps > 3" }, #~ 3: mode a can never be (its when never holds; laps is only ever 0), expected one that can
  { name = "b" },
]

## numbers that rules give
mode = [
  { name = "a", when = "laps > 3" }, #~ 3: mode a can never be (its when never holds; laps is only ever 0 or 3), expected one that can
  { name = "b" },
]
[[rule]]
when = "tagged"
set = { laps = 3 }

## all texts
mode = [
  { name = "a", when = "phase == 'go'" },
  { name = "b", when = "phase == 'return'" },
  { name = "c" }, #~ 3: mode c can never be (whenever it could be, one before it is: a, b), expected one that can
]
[[rule]]
when = "tagged"
set = { phase = "return" }

## a comparison of two numbers and its opposite
mode = [
  { name = "a", when = "score < enemy_score && !(score < enemy_score)" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## a choice
mode = [
  { name = "a", when = "(tagged ? own_side : own_side) && !own_side" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## truths that are compared
mode = [
  { name = "a", when = "tagged == own_side && tagged && !own_side" }, #~ 3: mode a can never be (its when never holds), expected one that can
  { name = "b" },
]

## counts of mates
mode = [
  { name = "a", when = "mates(phase == 'go') > 0 && mates(phase == 'go') < 1" }, #~ 3: mode a can never be (its when never holds; phase is only ever 'go'), expected one that can
  { name = "b" },
]
"#;

#[test]
fn modes_that_can_never_be_are_found() {
    assert_broken(VARIABLES, CASES);
}
