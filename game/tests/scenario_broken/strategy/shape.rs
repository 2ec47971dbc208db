//! Mistakes in strategies: shapes.

use super::{Broken, assert_broken};

const SHAPES: &[Broken] = &[
    (
        "a string without an end",
        r#"about = "x
[behaviour.go]
kind = "timer"
"#,
        &[r#"1:11: invalid basic string, expected `"`"#],
    ),
    (
        "nothing",
        "# Nothing.
",
        &["1:1: roles is missing, expected it, or at least one [behaviour.NAME]"],
    ),
    (
        "an unknown key",
        r#"base = "s.toml"
behavior = 3
"#,
        &["2:1: behavior is unknown, expected one of {keys of strategies} (did you mean behaviour?)"],
    ),
    (
        "a table of the old format",
        r#"roles = ["p.toml"]
[easy_attacker]
speed_m_s = 5
"#,
        &[
            r#"1:10: roles names "p.toml", which deals roles itself, expected the file of one program"#,
            "2:2: easy_attacker is unknown, expected one of {keys of strategies}",
        ],
    ),
    (
        "a behaviour that is no table",
        "behaviour = 3
",
        &["1:13: behaviour is 3, expected tables [behaviour.NAME]"],
    ),
    (
        "behaviours that are no tables",
        r#"base = "s.toml"
[behaviour]
go = "waypoint"
"#,
        &[r#"3:6: behaviour.go is "waypoint", expected a table with kind = ..."#],
    ),
    (
        "a number for the helm",
        r#"base = "s.toml"
helm = 3
"#,
        &["2:8: helm is 3, expected a table"],
    ),
    (
        "a helm out of range",
        r#"base = "s.toml"
helm = { courses = 4, speeds = 1.5, speed_max_m_s = 0, hysteresis = nan, rate = 4 }
"#,
        &[
            "2:20: courses is 4, expected 8 to 3600",
            "2:32: speeds is 1.5, expected a whole number",
            "2:53: speed_max_m_s is 0, expected 0.1 to 60",
            "2:69: hysteresis is nan, expected 0 to 0.1",
            "2:74: rate is unknown, expected one of courses, speeds, speed_max_m_s, hysteresis",
        ],
    ),
    (
        "a text for a truth",
        r#"base = "s.toml"
unsafe_i_know = "yes"
"#,
        &[r#"2:17: unsafe_i_know is the string "yes", expected a boolean"#],
    ),
    (
        "modes as a table",
        r#"base = "s.toml"
[mode]
name = "a"
"#,
        &["2:1: mode is a table, expected a list"],
    ),
    (
        "an unknown key of a mode",
        r#"base = "s.toml"
[[mode]]
name = "a"
if = "tagged"
"#,
        &["4:1: if is unknown, expected one of name, in, when, set (did you mean in?)"],
    ),
    (
        "an unknown key of a rule",
        r#"base = "s.toml"
[[rule]]
when = "tagged"
then = {}
"#,
        &[
            "2:1: rule.set is missing, expected values for variables",
            "4:1: then is unknown, expected one of on, when, set (did you mean when?)",
        ],
    ),
    (
        "a condition that is no text",
        r#"base = "s.toml"
[[mode]]
name = "a"
when = true
[[mode]]
name = "b"
"#,
        &["4:8: when is true, expected a string"],
    ),
    (
        "a name in capitals",
        r#"base = "s.toml"
[[mode]]
name = "Attack"
[behaviour.Go]
kind = "timer"
duration_s = 1
"#,
        &[
            r#"3:8: name is "Attack", expected 1 to 40 of a-z, 0-9 and _"#,
            r#"4:12: behaviour is "Go", expected 1 to 40 of a-z, 0-9 and _"#,
        ],
    ),
];

#[test]
fn the_shape_of_a_strategy_is_checked() {
    assert_broken(SHAPES);
}
