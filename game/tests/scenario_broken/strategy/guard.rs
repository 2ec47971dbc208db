//! Mistakes in strategies: safety that is none, and more than a helm or a team can take.

use super::{BASE, assert_broken};

/// Numbers with which a behaviour is no guard: whose, what the file says of it, and why it is none.
const POWERLESS: &[(&str, &str, &str)] = &[
    ("stay_in", "margin_m = -1000", "margin_m is -1000, less than 0"),
    ("stay_in", "margin_m = \"time_s > 10 ? -1000 : 0\"", "margin_m is no number"),
    ("stay_in", "save_m = 0", "save_m is 0, less than 1"),
    ("stay_in", "lookahead_s = 0.5", "lookahead_s is 0.5, less than 1"),
    ("stay_in", "exit_s = 600", "exit_s is 600, more than 10"),
    ("stay_in", "recovery_speed_m_s = 0", "recovery_speed_m_s is 0, less than 0.1"),
    ("keep_clear", "inner_m = 0\nouter_m = \"has_flag ? 0 : 30\"", "outer_m is no number"),
    ("keep_clear", "cpa_min_m = 0\ncpa_max_m = 0", "cpa_max_m is 0, less than 3"),
    ("keep_clear", "time_on_leg_s = 0.1", "time_on_leg_s is 0.1, less than 1"),
];

const VOID: &str = r#"
## a goal above safety
[behaviour.go]
kind = "waypoint"
points = ["CF"]
weight = 301 #~ 10: weight is 301 in mode active, expected at most 300, which op_region or avoid_collision has there

## safety that is worth hardly anything
[behaviour.stay_in]
weight = 1e-9
[behaviour.go] #~ 1: weight is 100 in mode active, expected at most 0.000000001, which op_region or avoid_collision has there
kind = "waypoint"
points = ["CF"]

## numbers that are none
[behaviour.go]
kind = "waypoint"
points = ["CF"]
speed_m_s = nan #~ 13: speed_m_s is nan, expected 0 to 60
weight = inf #~ 10: weight is inf, expected 0 to 1000
"#;

#[test]
fn safety_cannot_be_voided() {
    assert_broken(BASE, VOID);
    for (name, keys, why) in POWERLESS {
        let (kind, all) = match *name {
            "stay_in" => ("op_region", ""),
            _ => ("avoid_collision", " for all contacts"),
        };
        let want = format!(
            "1:1: mode active has no {kind} on guard ({name} is none: {why}), expected a behaviour of this kind{all}, without \
             when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because"
        );
        assert_broken(BASE, &format!("\n## {why} #~ {want}\n[behaviour.{name}]\n{keys}\n"));
    }
}

#[test]
fn there_is_an_end_to_what_is_heard() {
    let avoid: String = (0..16).map(|i| format!("[behaviour.a{i:02}]\nkind = \"avoid_collision\"\n")).collect();
    let functions = "1:1: mode active could ask for 273 functions at once, expected at most 256: 16 for each avoid_collision and \
                     avoid_obstacle, 2 for each cut_range, 1 for each other behaviour";
    assert_broken(BASE, &format!("\n## more than a helm hears #~ {functions}\n{avoid}"));
    let shared: String = (0..257).map(|i| format!("v{i} = {{ initial = 0, shared = true }}\n")).collect();
    let variables = "[variables] #~ 1: variables has 257 shared ones, expected at most 256";
    assert_broken(BASE, &format!("\n## more than mates hear\n{variables}\n{shared}"));
}
