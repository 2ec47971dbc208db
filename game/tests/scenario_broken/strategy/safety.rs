//! Mistakes in strategies: safety.

use super::{BASE, VARIABLES, assert_broken};

const ALONE: &str = r#"
## no safety #~ 1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because #~ 1:1: mode active has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]

## no reason
unsafe_i_know = true #~ 17: unsafe_because is missing, expected the reason
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]

## an empty reason
unsafe_i_know = true
unsafe_because = " " #~ 18: unsafe_because is empty, expected the reason
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]

## a reason alone
unsafe_because = "a test" #~ 18: unsafe_because is given without unsafe_i_know = true, expected both or neither
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]

## a reason that says no
unsafe_i_know = false
unsafe_because = "a test" #~ 18: unsafe_because is given without unsafe_i_know = true, expected both or neither
[behaviour.go]
kind = "waypoint"
points = ["enemy_flag"]

## a reason of another file #~ 1:1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because #~ 1:1: mode active has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
base = "unsafe.toml"
[behaviour.go]
kind = "waypoint"
points = ["CF"]
"#;

const CASES: &str = r#"
## safety with a condition #~ 1:1: mode active has no avoid_collision on guard (keep_clear is none: it has a condition), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.keep_clear]
when = "!tagged"

## safety for some contacts #~ 1:1: mode active has no avoid_collision on guard (keep_clear is none: it is not for all contacts), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.keep_clear]
contacts = "enemies"

## safety without weight #~ 1:1: mode active has no avoid_collision on guard (keep_clear is none: weight is 0), expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because #~ 1:1: mode active has no op_region on guard (stay_in is none: weight is no number), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.keep_clear]
weight = 0
[behaviour.stay_in]
weight = "100 + score"

## safety for a while #~ 1:1: mode active has no op_region on guard (stay_in is none: it has a duration_s), expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.stay_in]
duration_s = 30

## a reason that is not needed
unsafe_i_know = true
unsafe_because = "a test" #~ 18: unsafe_because is not needed: every mode has op_region and avoid_collision, expected none
"#;

const WITH_VARIABLES: &str = r#"
## safety in some modes only
[[mode]]
name = "a"
when = "tagged"
[[mode]] #~ 1: mode b has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
name = "b"
[behaviour.keep_clear]
in = ["a"]

## safety in all parts but one
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
in = "a"
when = "own_side"
[[mode]] #~ 1: mode a:c has no op_region on guard, expected a behaviour of this kind, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
name = "c"
in = "a"
[[mode]]
name = "d"
[behaviour.stay_in]
in = ["b", "d"]
"#;

#[test]
fn safety_is_not_optional() {
    assert_broken("", ALONE);
    assert_broken(BASE, CASES);
    assert_broken(VARIABLES, WITH_VARIABLES);
}
