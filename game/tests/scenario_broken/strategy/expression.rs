//! Mistakes in strategies: expressions.

use super::{BASE, VARIABLES, assert_broken};

/// Conditions, a line each.
const CONDITIONS: &str = r#"
tagged && #~ 18: when ends too early, expected a value there
 #~ 9: when ends too early, expected a value there
tagged own_side #~ 16: when has "own_side" here, expected an operator or the end
phase = 'go' #~ 15: when has "=" here, expected an operator or the end (did you mean ==?)
tagged and own_side #~ 16: when has "and" here, expected an operator or the end (did you mean &&?)
tagged & own_side #~ 16: when has "&" here, expected an operator (did you mean &&?)
(tagged || own_side #~ 28: when ends too early, expected ')'
tagged) #~ 15: when has ")" here, expected an operator or the end
phase == 'go #~ 18: when has "'" here: unterminated string literal
tagged ? own_side #~ 26: when ends too early, expected ':' in conditional expression
tägged #~ 10: when has "ägged" here, expected a value
taged #~ 9: when has "taged" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean tagged?)
laps + 1 #~ 14: when has a number here, expected true or false, such as a comparison
phase #~ 9: when has a text here, expected true or false, such as a comparison
tagged > 3 #~ 9: when has true or false here, expected a number
tagged && laps #~ 19: when has a number here, expected true or false, such as a comparison
phase == 'retrun' #~ 18: when compares phase with "retrun", expected one of go, return (did you mean return?)
phase > 'go' #~ 9: when has a text here, expected a number #~ 17: when has the text "go" here, expected a number
phase == phase #~ 15: when compares two texts, expected a text variable and one of its values
laps == 'go' #~ 14: when compares a number with the text "go", expected two of one kind
(tagged ? 'go' : 'return') == phase #~ 19: when has the text "go" here, expected a number, or true or false
(tagged ? 1 : true) > 0 #~ 23: when has true or false here, expected a number
own_flag > 3 #~ 9: when has the place own_flag here, expected it in a measure, as in distance(own_flag)
distance(own_flg) < 3 #~ 18: when asks for the distance of "own_flg", expected {places} (did you mean own_flag?)
distance(3) < 3 #~ 18: when has a value in distance(), expected the name of a place or boat
distance(own_flag, enemy_flag) < 3 #~ 9: when gives 2 things to distance(), expected one place or boat
dist(own_flag) < 3 #~ 9: when calls dist(), expected one of {calls}
max(1, 2, 3) < laps #~ 9: when gives 3 things to max(), expected two numbers
3 % 2 == 1 #~ 11: when has % here, expected only {CEL that is allowed}
laps in [1, 2] #~ 14: when has in here, expected only {CEL that is allowed}
{'a': 1}.a == laps #~ 17: when has the field .a here, expected only {CEL that is allowed}
phase.length > 3 #~ 14: when has the field .length here, expected only {CEL that is allowed}
phase.startsWith('g') #~ 25: when has the method startsWith() here, expected only {CEL that is allowed}
[1].all(x, x > 1) #~ 16: when has a macro here, expected only {CEL that is allowed}
has(phase.x) #~ 9: when has has() here, expected only {CEL that is allowed}
phase == null #~ 18: when has null here, expected only {CEL that is allowed}
if #~ 9: when has "if" here, expected a name that CEL does not reserve
mates(tagged) > 0 #~ 15: when asks mates for tagged, which is a fact, expected a shared variable
mates(laps > 2) > 0 #~ 15: when asks mates for laps, which is not shared, expected a shared variable
mates(distance(CF) < 2) > 0 #~ 15: when asks mates for distance(), which is a measure, expected a shared variable
mates(mates(phase == 'go') > 1) > 0 #~ 15: when has mates() within mates(), expected shared variables
mates(3) > 0 #~ 15: when has a number here, expected true or false, such as a comparison
(1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + 1)))))))))))))))))))))))))))))))))))))))) > 0 #~ 9: when is nested too deeply, expected at most 30 brackets in each other
"#;

#[test]
fn conditions_are_checked() {
    let mode = |line: &str| {
        let (condition, want) = line.split_once(" #~ ").expect("every line says what is wrong");
        format!("\n## {condition}\n[[mode]]\nname = \"a\"\nwhen = \"{condition}\" #~ {want}\n[[mode]]\nname = \"b\"\n")
    };
    assert_broken(VARIABLES, &CONDITIONS.lines().filter(|line| !line.is_empty()).map(mode).collect::<String>());
}

/// Expressions elsewhere, and those of several lines.
const EXPRESSIONS: &str = r#"
## a long text of several lines
[[mode]]
name = "a"
when = '''
tagged
  && lap > 3 #~ 6: when has "lap" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean laps?)
'''
[[mode]]
name = "b"

## behind an escape
[[mode]]
name = "a"
when = "phase == \"go\" && \u0074agged && lap > 3" #~ 43: when has "lap" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean laps?)
[[mode]]
name = "b"

## in the numbers of a behaviour
[behaviour.go]
kind = "waypoint"
points = ["CF"]
speed_m_s = "tagged ? 2 : cruise" #~ 27: speed_m_s has "cruise" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag)
weight = "tagged" #~ 11: weight has true or false here, expected a number
"#;

const WITHOUT_VARIABLES: &str = r#"
## an unknown name in a program without variables
[[mode]]
name = "a"
when = "alarmd" #~ 9: when has "alarmd" here, which is unknown, expected a variable, a fact such as tagged or time_s, or a call such as distance(own_flag)
[[mode]]
name = "b"
"#;

#[test]
fn expressions_are_checked() {
    assert_broken(VARIABLES, EXPRESSIONS);
    assert_broken(BASE, WITHOUT_VARIABLES);
    let long = format!("{}tagged", "tagged || ".repeat(100));
    let said = "8: when is 1006 characters long, expected at most 1000";
    let modes = format!("[[mode]]\nname = \"a\"\nwhen = \"{long}\" #~ {said}\n[[mode]]\nname = \"b\"\n");
    assert_broken(VARIABLES, &format!("\n## too long\n{modes}"));
}
