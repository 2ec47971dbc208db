//! Mistakes in strategies: roles, and the files that they name.

use super::assert_broken;

const CASES: &str = r#"
## no roles
roles = [] #~ 9: roles has 0 entries, expected 1 to 1000

## roles that are no files
roles = ["s.toml", "easy_defender"] #~ 20: strategies/easy_defender cannot be read (No such file or directory (os error 2)), expected a file

## a number for a role
roles = ["s.toml", 3] #~ 20: roles is 3, expected the path of a file

## an unknown way to deal
roles = ["s.toml"]
assignment = "seed" #~ 14: assignment is "seed", expected one of fixed, seeded (did you mean seeded?)

## roles that deal roles
roles = ["y.toml"] #~ 10: roles names "y.toml", which deals roles itself, expected the file of one program
--- strategies/y.toml
roles = ["s.toml"]

## roles that are the file itself
roles = ["x.toml"] #~ 10: roles names "x.toml", which deals roles itself, expected the file of one program

## roles and a program
base = "s.toml"
roles = ["s.toml"]
helm = {} #~ 8: helm is given with roles, expected in the files that roles names
mode = [] #~ 8: mode is given with roles, expected in the files that roles names
[variables] #~ 1: variables is given with roles, expected in the files that roles names
a = 1
[[rule]] #~ 1: rule is given with roles, expected in the files that roles names
when = "tagged"
set = { a = 2 }
--- strategies/s.toml
[behaviour.stay_in] #~ 1: behaviour.stay_in is given with roles, expected in the files that roles names
kind = "op_region"
[behaviour.keep_clear] #~ 1: behaviour.keep_clear is given with roles, expected in the files that roles names
kind = "avoid_collision"

## a way to deal nothing
base = "s.toml"
assignment = "fixed" #~ 14: assignment is given without roles, expected with them only

## a mistake in the file of a role that occurs twice
roles = ["y.toml", "s.toml", "y.toml"]
--- strategies/y.toml
base = "s.toml"
[[mode]]
name = "a"
when = "taged" #~ 9: when has "taged" here, which is unknown, expected a variable, a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean tagged?)
[[mode]]
name = "b"

## a mistake in the base of a role
--- games/x.toml
base = "g.toml"
--- strategies/p.toml
roles = ["y.toml"]
--- strategies/y.toml
base = "z.toml"
[behaviour.go]
speed_m_s = 70 #~ 13: speed_m_s is 70, expected 0 to 60
--- strategies/z.toml
base = "s.toml"
[behaviour.go]
kind = "waypoint"
points = ["CG"] #~ 11: points is "CG", expected [x, y], {places} (did you mean CB?)

## a role laid over a base of another kind
base = "s.toml" #~ 1: mode active has no avoid_collision on guard, expected a behaviour of this kind for all contacts, without when and duration_s, with a weight that is a number above 0; or unsafe_i_know = true and unsafe_because
[behaviour.keep_clear]
kind = "full_stop"
--- strategies/s.toml
[behaviour.stay_in]
kind = "op_region"
[behaviour.keep_clear]
kind = "avoid_collision"
outer_m = 20 #~ 1: outer_m is unknown, expected one of duration_s, in, kind, on_active, on_complete, on_idle, on_inactive, on_reach, on_run, perpetual, weight, when
"#;

#[test]
fn roles_are_checked() {
    assert_broken("", CASES);
}
