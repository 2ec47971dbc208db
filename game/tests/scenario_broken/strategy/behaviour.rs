//! Mistakes in strategies: behaviours.

use super::{Broken, assert_broken};

const BEHAVIOURS: &[Broken] = &[
    (
        "no kind",
        r#"base = "s.toml"
[behaviour.go]
speed_m_s = 3
"#,
        &["2:12: behaviour.go.kind is missing, expected one of {kinds}"],
    ),
    (
        "a mistyped kind",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypiont"
points = ["CF"]
"#,
        &[r#"3:8: kind is "waypiont", expected one of {kinds} (did you mean waypoint?)"#],
    ),
    (
        "a kind that is no text",
        r#"base = "s.toml"
[behaviour.go]
kind = 3
weight = -1
"#,
        &["3:8: kind is 3, expected one of {kinds}", "4:10: weight is -1, expected 0 to 1000"],
    ),
    (
        "a mistyped safety behaviour",
        r#"base = "s.toml"
behaviour.keep_clear.kind = "avoid_colision"
"#,
        &[r#"2:29: kind is "avoid_colision", expected one of {kinds} (did you mean avoid_collision?)"#],
    ),
    (
        "a key of another kind",
        r#"base = "s.toml"
[behaviour.go]
kind = "cut_range"
contact = "opponent"
speed_m_s = 3
"#,
        &["5:1: speed_m_s is unknown, expected one of kind, contact, patience, time_on_leg_s, giveup_m, {keys of all}"],
    ),
    (
        "a mistyped key",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_ms = 3
"#,
        &[
            "5:1: speed_ms is unknown, expected one of kind, points, reverse, repeat, speed_m_s, capture_radius_m, slip_radius_m, lead_m, course_share, {keys of all} (did you mean speed_m_s?)",
        ],
    ),
    (
        "a key that means nothing without others",
        r#"base = "s.toml"
[behaviour.wait]
kind = "timer"
duration_s = 3
speed_m_s = 3
"#,
        &["5:1: speed_m_s is unknown, expected one of kind, {keys of all}"],
    ),
    (
        "nothing that is required",
        r#"base = "s.toml"
[behaviour.a]
kind = "waypoint"
[behaviour.b]
kind = "cut_range"
[behaviour.c]
kind = "timer"
[behaviour.d]
kind = "shield"
[behaviour.e]
kind = "constant_heading"
[behaviour.f]
kind = "attractor"
[behaviour.g]
kind = "loiter"
[behaviour.h]
kind = "max_speed"
"#,
        &[
            "2:12: behaviour.a.points is missing, expected a list of places",
            "4:12: behaviour.b.contact is missing, expected one of {boats}",
            "6:12: behaviour.c.duration_s is missing, expected 0 to 86400",
            "8:12: behaviour.d.guarded is missing, expected [x, y], or the name of a place or a boat",
            "10:12: behaviour.e.heading_deg is missing, expected -360 to 360",
            "12:12: behaviour.f.to is missing, expected [x, y], or the name of a place or a boat",
            "14:12: behaviour.g.ellipse is missing, expected it or polygon",
            "16:12: behaviour.h.speed_m_s is missing, expected 0 to 60",
        ],
    ),
    (
        "no points",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = []
"#,
        &["4:10: points has 0 entries, expected 1 to 1000"],
    ),
    (
        "a point that is none",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["CCH", "own_flg", [nan, 0]]
"#,
        &[
            r#"4:11: points is "CCH", expected [x, y], {places} (did you mean CC?)"#,
            r#"4:18: points is "own_flg", expected [x, y], {places} (did you mean own_flag?)"#,
            "4:29: points is [nan, 0], expected both within 1000000 of 0",
        ],
    ),
    (
        "a point of three numbers",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["CH", [1, 2, 3]]
"#,
        &[r#"4:17: points is of length 3, expected [x, y] or the name of a point such as "CH""#],
    ),
    (
        "a point that is a number",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = [3]
"#,
        &[r#"4:11: points is 3, expected [x, y] or the name of a point such as "CH""#],
    ),
    (
        "points that are no list",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = "CF"
"#,
        &[r#"4:10: points is the string "CF", expected a list"#],
    ),
    (
        "a boat that is none",
        r#"base = "s.toml"
[behaviour.go]
kind = "intercept"
contact = "nearest_enemies"
"#,
        &[r#"4:11: contact is "nearest_enemies", expected one of {boats}"#],
    ),
    (
        "a place for a boat",
        r#"base = "s.toml"
[behaviour.go]
kind = "intercept"
contact = "own_flag"
"#,
        &[r#"4:11: contact is "own_flag", expected one of {boats}"#],
    ),
    (
        "both shapes",
        r#"base = "s.toml"
[behaviour.go]
kind = "loiter"
polygon = ["CF", "CH", "PH"]
ellipse = {}
"#,
        &["5:11: ellipse is given with polygon, expected one of them"],
    ),
    (
        "a polygon of two corners",
        r#"base = "s.toml"
[behaviour.go]
kind = "loiter"
polygon = ["CF", "CH"]
"#,
        &["4:11: polygon has 2 entries, expected 3 to 1000"],
    ),
    (
        "half an ellipse",
        r#"base = "s.toml"
[behaviour.go]
kind = "loiter"
ellipse = { along_m = 0, corners = 2, width_m = 3 }
turn = "left"
"#,
        &[
            "4:11: behaviour.go.ellipse.centre is missing, expected [x, y], or the name of a place or a boat",
            "4:11: ellipse.across_m is missing, expected 1 to 10000",
            "4:23: along_m is 0, expected 1 to 10000",
            "4:36: corners is 2, expected 3 to 1000",
            "4:39: width_m is unknown, expected one of centre, along_m, across_m, corners",
            r#"5:8: turn is "left", expected one of clockwise, counterclockwise, best (did you mean best?)"#,
        ],
    ),
    (
        "numbers out of range",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = -1
capture_radius_m = 0
course_share = 1.5
weight = 1001
duration_s = -1
"#,
        &[
            "5:13: speed_m_s is -1, expected 0 to 60",
            "6:20: capture_radius_m is 0, expected 0.1 to 1000",
            "7:16: course_share is 1.5, expected 0 to 1",
            "8:10: weight is 1001, expected 0 to 1000",
            "9:14: duration_s is -1, expected 0 to 86400",
        ],
    ),
    (
        "a constant expression out of range",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = "10 * 7"
"#,
        &["5:13: speed_m_s is 70, expected 0 to 60"],
    ),
    (
        "a truth for a number",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
speed_m_s = true
"#,
        &["5:13: speed_m_s is true, expected a number or an expression"],
    ),
    (
        "an inner distance beyond the outer",
        r#"base = "s.toml"
[behaviour.keep_clear]
inner_m = 16
cpa_max_m = 2
[behaviour.hold]
kind = "station_keep"
inner_radius_m = 20
[behaviour.to]
kind = "attractor"
to = "CF"
inner_m = 30
outer_m = "4 * 5"
"#,
        &[
            "3:11: inner_m is 16, expected at most outer_m, which is 15",
            "4:13: cpa_min_m is 3, expected at most cpa_max_m, which is 2",
            "7:18: inner_radius_m is 20, expected at most outer_radius_m, which is 15",
            "11:11: inner_m is 30, expected at most outer_m, which is 20",
        ],
    ),
    (
        "unknown choices",
        r#"base = "s.toml"
[behaviour.keep_clear]
contacts = "enemy"
grade = "cubic"
"#,
        &[
            r#"3:12: contacts is "enemy", expected one of all, enemies, taggers, mates"#,
            r#"4:9: grade is "cubic", expected one of linear, quasi, quadratic"#,
        ],
    ),
    (
        "an unknown mode",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "attack"
when = "tagged"
[[mode]]
name = "defend"
[behaviour.go]
kind = "waypoint"
in = ["atack", "defend"]
points = ["CF"]
"#,
        &[r#"13:7: in has "atack", expected one of the modes attack, defend (did you mean attack?)"#],
    ),
    (
        "no mode at all",
        r#"base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]
in = []
"#,
        &["5:6: in has 0 entries, expected at least one mode"],
    ),
    (
        "unknown variables at moments",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[behaviour.go]
kind = "waypoint"
points = ["CF"]
on_run = { lapse = 1 }
on_reach = { phase = "gone" }
on_complete = { laps = "laps + tagged", alarmed = 1 }
"#,
        &[
            "9:20: lapse is unknown, expected one of the variables alarmed, laps, phase (did you mean laps?)",
            r#"10:22: phase is "gone", expected one of go, return (did you mean go?)"#,
            "11:32: laps has true or false here, expected a number",
            "11:51: alarmed is 1, expected true, false or an expression",
        ],
    ),
];

#[test]
fn behaviours_are_checked() {
    assert_broken(BEHAVIOURS);
}
