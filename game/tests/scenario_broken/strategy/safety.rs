//! Mistakes in strategies: safety.

use super::{Broken, assert_broken};

const SAFETY: &[Broken] = &[
    (
        "no safety",
        r#"[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &[
            "1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
            "1:1: mode active has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety in some modes only",
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
[behaviour.keep_clear]
in = ["a"]
"#,
        &[
            "9:1: mode b has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety in all parts but one",
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
when = "own_side"
[[mode]]
name = "c"
in = "a"
[[mode]]
name = "d"
[behaviour.stay_in]
in = ["b", "d"]
"#,
        &[
            "13:1: mode a:c has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety with a condition",
        r#"base = "s.toml"
[behaviour.keep_clear]
when = "!tagged"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: it has a condition), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety for some contacts",
        r#"base = "s.toml"
[behaviour.keep_clear]
contacts = "enemies"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: it is not for all contacts), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety without weight",
        r#"base = "s.toml"
[behaviour.keep_clear]
weight = 0
[behaviour.stay_in]
weight = "100 + score"
"#,
        &[
            "1:1: mode active has no avoid_collision on guard (keep_clear is none: weight is 0), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
            "1:1: mode active has no op_region on guard (stay_in is none: weight is no number), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "safety for a while",
        r#"base = "s.toml"
[behaviour.stay_in]
duration_s = 30
"#,
        &[
            "1:1: mode active has no op_region on guard (stay_in is none: it has a duration_s), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because",
        ],
    ),
    (
        "no reason",
        r#"unsafe_i_know = true
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["1:17: unsafe_because is missing, expected the reason"],
    ),
    (
        "an empty reason",
        r#"unsafe_i_know = true
unsafe_because = " "
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["2:18: unsafe_because is empty, expected the reason"],
    ),
    (
        "a reason alone",
        r#"unsafe_because = "a test"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["1:18: unsafe_because is given without unsafe_i_know = true, expected both or neither"],
    ),
    (
        "a reason that says no",
        r#"unsafe_i_know = false
unsafe_because = "a test"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
"#,
        &["2:18: unsafe_because is given without unsafe_i_know = true, expected both or neither"],
    ),
    (
        "a reason that is not needed",
        r#"base = "s.toml"
unsafe_i_know = true
unsafe_because = "a test"
"#,
        &["3:18: unsafe_because is not needed: every mode has op_region and avoid_collision, expected none"],
    ),
];

#[test]
fn safety_is_not_optional() {
    assert_broken(SAFETY);
}
