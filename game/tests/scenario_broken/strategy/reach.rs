//! Mistakes in strategies: modes that can never be.

use super::{Broken, assert_broken};

const NEVER: &[Broken] = &[
    (
        "a contradiction",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged && !tagged"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "a constant",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "1 > 2"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "after the same condition",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
when = "own_side && tagged"
[[mode]]
name = "c"
"#,
        &["9:1: mode b can never be (whenever it could be, one before it is: a), expected one that can"],
    ),
    (
        "after everything",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
when = "!tagged"
[[mode]]
name = "c"
"#,
        &["12:1: mode c can never be (whenever it could be, one before it is: a, b), expected one that can"],
    ),
    (
        "after all numbers",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "enemies < 2"
[[mode]]
name = "b"
when = "enemies >= 2"
[[mode]]
name = "c"
"#,
        &["12:1: mode c can never be (whenever it could be, one before it is: a, b), expected one that can"],
    ),
    (
        "between two whole numbers",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "enemies > 1 && enemies < 2"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "below the least",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "distance(CF) < 0"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "a fact that implies another",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "has_flag && !enemy_flag_taken"
[[mode]]
name = "b"
when = "enemy_in_zone && enemies_in_zone == 0"
[[mode]]
name = "c"
when = "enemies_in_zone > 1 && !enemy_in_zone"
[[mode]]
name = "d"
"#,
        &[
            "6:1: mode a can never be (its when never holds), expected one that can",
            "9:1: mode b can never be (its when never holds), expected one that can",
            "12:1: mode c can never be (its when never holds), expected one that can",
        ],
    ),
    (
        "a part that the whole rules out",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
[[mode]]
name = "c"
in = "b"
when = "tagged"
[[mode]]
name = "d"
in = "b"
"#,
        &["11:1: mode b:c can never be (its when never holds in the modes that it is in), expected one that can"],
    ),
    (
        "a part of the whole that is always there",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
in = "a"
when = "tagged"
[[mode]]
name = "c"
in = "a"
[[mode]]
name = "d"
"#,
        &["13:1: mode a:c can never be (whenever it could be, one before it is: b), expected one that can"],
    ),
    (
        "parts of a mode that can never be",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged && !tagged"
[[mode]]
name = "b"
in = "a"
when = "own_side"
[[mode]]
name = "c"
in = "a"
[[mode]]
name = "d"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "a truth that nobody changes",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "alarmed"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds; alarmed is only ever false), expected one that can"],
    ),
    (
        "a text that nobody gives",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "phase == 'return'"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds; phase is only ever 'go'), expected one that can"],
    ),
    (
        "a number that nobody changes",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "laps > 3"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds; laps is only ever 0), expected one that can"],
    ),
    (
        "numbers that rules give",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "laps > 3"
[[mode]]
name = "b"
[[rule]]
when = "tagged"
set = { laps = 3 }
"#,
        &["6:1: mode a can never be (its when never holds; laps is only ever 0 or 3), expected one that can"],
    ),
    (
        "all texts",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "phase == 'go'"
[[mode]]
name = "b"
when = "phase == 'return'"
[[mode]]
name = "c"
[[rule]]
when = "tagged"
set = { phase = "return" }
"#,
        &["12:1: mode c can never be (whenever it could be, one before it is: a, b), expected one that can"],
    ),
    (
        "a comparison of two numbers and its opposite",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "score < enemy_score && !(score < enemy_score)"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "a choice",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "(tagged ? own_side : own_side) && !own_side"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "truths that are compared",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged == own_side && tagged && !own_side"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds), expected one that can"],
    ),
    (
        "counts of mates",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "mates(phase == 'go') > 0 && mates(phase == 'go') < 1"
[[mode]]
name = "b"
"#,
        &["6:1: mode a can never be (its when never holds; phase is only ever 'go'), expected one that can"],
    ),
];

#[test]
fn modes_that_can_never_be_are_found() {
    assert_broken(NEVER);
}
