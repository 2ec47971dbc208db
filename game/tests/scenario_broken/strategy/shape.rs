//! Mistakes in strategies: shapes.

use super::{BASE, assert_broken};

const ALONE: &str = r#"
## a string without an end
about = "x #~ 11: invalid basic string, expected `"`
[behaviour.go]
kind = "timer"

## nothing #~ 1:1: roles is missing, expected it, or at least one [behaviour.NAME]
# Nothing.

## a table of the old format
roles = ["p.toml"] #~ 10: roles names "p.toml", which deals roles itself, expected the file of one program
[easy_attacker] #~ 2: easy_attacker is unknown, expected one of {keys of strategies}
speed_m_s = 5

## a behaviour that is no table
behaviour = 3 #~ 13: behaviour is 3, expected tables [behaviour.NAME]
"#;

const CASES: &str = r#"
## an unknown key
behavior = 3 #~ 1: behavior is unknown, expected one of {keys of strategies} (did you mean behaviour?)

## behaviours that are no tables
[behaviour]
go = "waypoint" #~ 6: go is the string "waypoint", expected a table with kind = ...

## a number for the helm
helm = 3 #~ 8: helm is 3, expected a table

## a helm out of range
helm = { courses = 4, speeds = 1.5, speed_max_m_s = 0, hysteresis = nan, rate = 4 } #~ 20: courses is 4, expected 8 to 3600 #~ 32: speeds is 1.5, expected a whole number #~ 53: speed_max_m_s is 0, expected 0.1 to 60 #~ 69: hysteresis is nan, expected 0 to 0.1 #~ 74: rate is unknown, expected one of courses, hysteresis, speed_max_m_s, speeds

## a text for a truth
unsafe_i_know = "yes" #~ 17: unsafe_i_know is the string "yes", expected true or false

## modes as a table
[mode] #~ 1: mode is a table, expected a list
name = "a"

## an unknown key of a mode
[[mode]]
name = "a"
if = "tagged" #~ 1: if is unknown, expected one of in, name, set, when (did you mean in?)

## an unknown key of a rule
[[rule]] #~ 1: rule.set is missing, expected values for variables
when = "tagged"
then = {} #~ 1: then is unknown, expected one of on, set, when (did you mean when?)

## a condition that is no text
[[mode]]
name = "a"
when = true #~ 8: when is true, expected a string
[[mode]]
name = "b"

## a name in capitals
[[mode]]
name = "Attack" #~ 8: name is "Attack", expected 1 to 40 of a-z, 0-9 and _
[behaviour.Go] #~ 1: behaviour is "Go", expected 1 to 40 of a-z, 0-9 and _
kind = "timer"
duration_s = 1
"#;

#[test]
fn the_shape_of_a_strategy_is_checked() {
    assert_broken("", ALONE);
    assert_broken(BASE, CASES);
}
