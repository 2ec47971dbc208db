//! Mistakes in strategies: variables and rules.

use super::{BASE, VARIABLES, assert_broken};

const CASES: &str = r#"
## names that are taken
[variables]
tagged = true #~ 10: variable is "tagged", which is a fact, expected another name
own_flag = 1 #~ 12: variable is "own_flag", which is a place or a boat, expected another name
min = 2 #~ 7: variable is "min", which is a call, expected another name
in = 3 #~ 6: variable is "in", which is a word that CEL reserves, expected another name
2nd = 4 #~ 7: variable is "2nd", which begins with a digit, expected another name
Laps = 5 #~ 8: variable is "Laps", expected 1 to 40 of a-z, 0-9 and _

## a text without its values
[variables]
phase = "go" #~ 9: phase is the string "go", expected a number, true, false, or a table { values = [...], initial = ..., shared = ... }

## no initial value
[variables]
laps = { shared = true } #~ 8: laps.values is missing, expected the texts it may have, or initial, a number or a truth

## an initial value that is none
[variables]
phase = { values = ["go", "return"], initial = "retrun" } #~ 48: initial is "retrun", expected one of go, return (did you mean return?)
other = { values = ["go"], initial = 3 } #~ 38: initial is 3, expected one of go

## values of a bad kind
[variables]
a = { values = [] } #~ 16: values has 0 entries, expected 1 to 100
b = { values = ["x", "x"] } #~ 22: values has "x" again, expected different ones
c = { values = ["Go now"] } #~ 17: values is "Go now", expected 1 to 40 of a-z, 0-9 and _
d = { values = [1] } #~ 17: values is 1, expected 1 to 40 of a-z, 0-9 and _

## a non-finite number
[variables]
a = nan #~ 5: a is nan, expected a finite number
b = { initial = inf } #~ 17: initial is inf, expected a finite number

## a list
[variables]
a = [1, 2] #~ 5: a is a list, expected a number, true, false, or a table { values = [...], initial = ..., shared = ... }

## an unknown key of a variable
[variables]
a = { initial = 3, share = true } #~ 20: share is unknown, expected one of initial, shared, values (did you mean shared?)

## a rule without anything
[[rule]] #~ 1: rule.on is missing, expected it, or when, or both #~ 1: rule.set is missing, expected values for variables

## a variable where there are none
[[rule]]
when = "tagged"
set = { laps = 1 } #~ 16: laps is unknown, expected a name from [variables], which has none
"#;

const WITH_VARIABLES: &str = r#"
## a rule that sets nothing
[[rule]]
when = "tagged"
set = {} #~ 7: set is empty, expected values for variables

## an event that is none
[[rule]]
on = "enemy grab" #~ 6: on is "enemy grab", expected one of {events} (did you mean enemy grabs?)
set = { laps = 1 }
[[rule]]
on = "they grabs" #~ 6: on is "they grabs", expected one of {events}
set = { laps = 1 }
[[rule]]
on = "i" #~ 6: on is "i", expected one of {events}
set = { laps = 1 }
[[rule]]
on = "i grabs flag" #~ 6: on is "i grabs flag", expected one of {events} (did you mean i grabs?)
set = { laps = 1 }

## values of the wrong kind
[[rule]]
when = "tagged"
set = { laps = true, phase = 3, alarmed = "laps", speed = 3 } #~ 16: laps is true, expected a finite number or an expression #~ 30: phase is 3, expected one of go, return #~ 44: alarmed has a number here, expected true or false, such as a comparison #~ 59: speed is unknown, expected one of the variables alarmed, laps, phase
"#;

#[test]
fn variables_and_rules_are_checked() {
    assert_broken(BASE, CASES);
    assert_broken(VARIABLES, WITH_VARIABLES);
}
