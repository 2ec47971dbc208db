//! Mistakes in strategies: variables and rules.

use super::{Broken, assert_broken};

const VARIABLES: &[Broken] = &[
    (
        "names that are taken",
        r#"base = "s.toml"
[variables]
tagged = true
own_flag = 1
min = 2
in = 3
2nd = 4
Laps = 5
"#,
        &[
            r#"3:10: variable is "tagged", which is a fact, expected another name"#,
            r#"4:12: variable is "own_flag", which is a place or a boat, expected another name"#,
            r#"5:7: variable is "min", which is a call, expected another name"#,
            r#"6:6: variable is "in", which is a word that CEL reserves, expected another name"#,
            r#"7:7: variable is "2nd", which begins with a digit, expected another name"#,
            r#"8:8: variable is "Laps", expected 1 to 40 of a-z, 0-9 and _"#,
        ],
    ),
    (
        "a text without its values",
        r#"base = "s.toml"
[variables]
phase = "go"
"#,
        &[
            r#"3:9: phase is the string "go", expected a number, true, false, or a table { values = [...], initial = ..., shared = ... }"#,
        ],
    ),
    (
        "no initial value",
        r#"base = "s.toml"
[variables]
laps = { shared = true }
"#,
        &["3:8: laps.values is missing, expected the texts it may have, or initial, a number or a truth"],
    ),
    (
        "an initial value that is none",
        r#"base = "s.toml"
[variables]
phase = { values = ["go", "return"], initial = "retrun" }
other = { values = ["go"], initial = 3 }
"#,
        &[
            r#"3:48: initial is "retrun", expected one of go, return (did you mean return?)"#,
            "4:38: initial is 3, expected one of go",
        ],
    ),
    (
        "values of a bad kind",
        r#"base = "s.toml"
[variables]
a = { values = [] }
b = { values = ["x", "x"] }
c = { values = ["Go now"] }
d = { values = [1] }
"#,
        &[
            "3:16: values has 0 entries, expected 1 to 100",
            r#"4:22: values has "x" again, expected different ones"#,
            r#"5:17: values is "Go now", expected 1 to 40 of a-z, 0-9 and _"#,
            "6:17: values is 1, expected a string",
        ],
    ),
    (
        "a number that is none",
        r#"base = "s.toml"
[variables]
a = nan
b = { initial = inf }
"#,
        &["3:5: a is nan, expected a finite number", "4:17: b is inf, expected a finite number"],
    ),
    (
        "a list",
        r#"base = "s.toml"
[variables]
a = [1, 2]
"#,
        &[
            "3:5: a is a list, expected a number, true, false, or a table { values = [...], initial = ..., shared = ... }",
        ],
    ),
    (
        "an unknown key of a variable",
        r#"base = "s.toml"
[variables]
a = { initial = 3, share = true }
"#,
        &["3:20: share is unknown, expected one of values, initial, shared (did you mean shared?)"],
    ),
    (
        "a rule without anything",
        r#"base = "s.toml"
[[rule]]
"#,
        &[
            "2:1: rule.on is missing, expected it, or when, or both",
            "2:1: rule.set is missing, expected values for variables",
        ],
    ),
    (
        "a rule that sets nothing",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[rule]]
when = "tagged"
set = {}
"#,
        &["6:1: rule.set is missing, expected values for variables"],
    ),
    (
        "an event that is none",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[rule]]
on = "enemy grab"
set = { laps = 1 }
[[rule]]
on = "they grabs"
set = { laps = 1 }
[[rule]]
on = "i"
set = { laps = 1 }
[[rule]]
on = "i grabs flag"
set = { laps = 1 }
"#,
        &[
            r#"7:6: on is "enemy grab", expected one of {events} (did you mean enemy grabs?)"#,
            r#"10:6: on is "they grabs", expected one of {events}"#,
            r#"13:6: on is "i", expected one of {events}"#,
            r#"16:6: on is "i grabs flag", expected one of {events} (did you mean i grabs?)"#,
        ],
    ),
    (
        "values of the wrong kind",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[rule]]
when = "tagged"
set = { laps = true, phase = 3, alarmed = "laps", speed = 3 }
"#,
        &[
            "8:16: laps is true, expected a finite number or an expression",
            "8:30: phase is 3, expected one of go, return",
            "8:44: alarmed has a number here, expected true or false, such as a comparison",
            "8:59: speed is unknown, expected one of the variables alarmed, laps, phase",
        ],
    ),
    (
        "a variable where there are none",
        r#"base = "s.toml"
[[rule]]
when = "tagged"
set = { laps = 1 }
"#,
        &["4:16: laps is unknown, expected a name from [variables], which has none"],
    ),
];

#[test]
fn variables_and_rules_are_checked() {
    assert_broken(VARIABLES);
}
