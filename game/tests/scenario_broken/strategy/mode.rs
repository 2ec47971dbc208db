//! Mistakes in strategies: modes.

use super::{Broken, assert_broken};

const MODES: &[Broken] = &[
    (
        "a mode without a name",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
when = "tagged"
[[mode]]
name = "b"
"#,
        &["6:1: mode.name is missing, expected 1 to 40 of a-z, 0-9 and _"],
    ),
    (
        "a name twice",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "a"
"#,
        &[r#"10:8: name is "a" again, expected a different one for each mode"#],
    ),
    (
        "an unknown parent",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "defend"
[[mode]]
name = "a"
in = "defent"
"#,
        &[r#"10:6: in is "defent", expected one of the modes before, defend (did you mean defend?)"#],
    ),
    (
        "a parent that comes later",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
in = "b"
[[mode]]
name = "b"
"#,
        &[r#"8:6: in is "b", which does not stand before this mode, expected one that does"#],
    ),
    (
        "a mode in itself",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
in = "a"
[[mode]]
name = "b"
"#,
        &[r#"8:6: in is "a", which does not stand before this mode, expected one that does"#],
    ),
    (
        "a condition for the last",
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
"#,
        &["11:8: when is given for b, the last mode, expected none: it is what remains"],
    ),
    (
        "a condition for the only one",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged"
"#,
        &["8:8: when is given for a, the last mode, expected none: it is what remains"],
    ),
    (
        "a condition for the last part",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
[[mode]]
name = "b"
in = "a"
when = "tagged"
"#,
        &["11:8: when is given for b, the last part of a, expected none: it is what remains"],
    ),
    (
        "no condition for an earlier one",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
[[mode]]
name = "b"
when = "tagged"
[[mode]]
name = "c"
"#,
        &["6:1: mode.when is missing, expected a condition: without one for a it is never b"],
    ),
    (
        "no condition for an earlier part",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
[[mode]]
name = "b"
in = "a"
[[mode]]
name = "c"
in = "a"
"#,
        &["8:1: mode.when is missing, expected a condition: without one for b it is never c"],
    ),
    (
        "unknown variables in set",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
set = { fase = "go" }
"#,
        &["8:16: fase is unknown, expected one of the variables alarmed, laps, phase (did you mean phase?)"],
    ),
];

#[test]
fn modes_are_checked() {
    assert_broken(MODES);
}
