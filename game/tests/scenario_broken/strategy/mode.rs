//! Mistakes in strategies: modes.

use super::{VARIABLES, assert_broken};

const CASES: &str = r#"
## a mode without a name
[[mode]] #~ 1: mode.name is missing, expected 1 to 40 of a-z, 0-9 and _
when = "tagged"
[[mode]]
name = "b"

## a name twice
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "a" #~ 8: name is "a" again, expected a different one for each mode

## an unknown parent
[[mode]]
name = "defend"
[[mode]]
name = "a"
in = "defent" #~ 6: in is "defent", expected one of the modes before, defend (did you mean defend?)

## a parent that comes later
[[mode]]
name = "a"
in = "b" #~ 6: in is "b", which does not stand before this mode, expected one that does
[[mode]]
name = "b"

## a mode in itself
[[mode]]
name = "a"
in = "a" #~ 6: in is "a", which does not stand before this mode, expected one that does
[[mode]]
name = "b"

## a condition for the last
[[mode]]
name = "a"
when = "tagged"
[[mode]]
name = "b"
when = "!tagged" #~ 8: when is given for b, the last mode, expected none: it is what remains

## a condition for the only one
[[mode]]
name = "a"
when = "tagged" #~ 8: when is given for a, the last mode, expected none: it is what remains

## a condition for the last part
[[mode]]
name = "a"
[[mode]]
name = "b"
in = "a"
when = "tagged" #~ 8: when is given for b, the last part of a, expected none: it is what remains

## no condition for an earlier one
[[mode]] #~ 1: mode.when is missing, expected a condition: without one for a it is never b
name = "a"
[[mode]]
name = "b"
when = "tagged"
[[mode]]
name = "c"

## no condition for an earlier part
[[mode]]
name = "a"
[[mode]] #~ 1: mode.when is missing, expected a condition: without one for b it is never c
name = "b"
in = "a"
[[mode]]
name = "c"
in = "a"

## unknown variables in set
[[mode]]
name = "a"
set = { fase = "go" } #~ 16: fase is unknown, expected one of the variables alarmed, laps, phase (did you mean phase?)
"#;

#[test]
fn modes_are_checked() {
    assert_broken(VARIABLES, CASES);
}
