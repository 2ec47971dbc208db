//! Mistakes in strategies: expressions.

use super::{Broken, assert_broken};

/// Conditions, and what must be reported for a file that has them in this line.
const CONDITIONS: &[Broken] = &[
    ("an expression that ends early", "tagged &&", &["8:18: when ends too early, expected a value there"]),
    ("nothing", "", &["8:9: when ends too early, expected a value there"]),
    ("two values", "tagged own_side", &[r#"8:16: when has "own_side" here, expected an operator or the end"#]),
    (
        "one equals sign",
        "phase = 'go'",
        &[r#"8:15: when has "=" here, expected an operator or the end (did you mean ==?)"#],
    ),
    (
        "words for signs",
        "tagged and own_side",
        &[r#"8:16: when has "and" here, expected an operator or the end (did you mean &&?)"#],
    ),
    ("a single sign", "tagged & own_side", &[r#"8:16: when has "&" here, expected an operator (did you mean &&?)"#]),
    ("a bracket too few", "(tagged || own_side", &["8:28: when ends too early, expected ')'"]),
    ("a bracket too many", "tagged)", &[r#"8:15: when has ")" here, expected an operator or the end"#]),
    ("a text without an end", "phase == 'go", &[r#"8:18: when has "'" here: unterminated string literal"#]),
    ("half a choice", "tagged ? own_side", &["8:26: when ends too early, expected ':' in conditional expression"]),
    ("a letter of another alphabet", "tägged", &[r#"8:10: when has "ägged" here, expected a value"#]),
    (
        "an unknown name",
        "taged",
        &[
            r#"8:9: when has "taged" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean tagged?)"#,
        ],
    ),
    (
        "a number for a condition",
        "laps + 1",
        &["8:14: when has a number here, expected true or false, such as a comparison"],
    ),
    ("a text for a condition", "phase", &["8:9: when has a text here, expected true or false, such as a comparison"]),
    ("a truth for a number", "tagged > 3", &["8:9: when has true or false here, expected a number"]),
    (
        "a number among truths",
        "tagged && laps",
        &["8:19: when has a number here, expected true or false, such as a comparison"],
    ),
    (
        "a value that a text does not have",
        "phase == 'retrun'",
        &[r#"8:18: when compares phase with "retrun", expected one of go, return (did you mean return?)"#],
    ),
    (
        "an order of texts",
        "phase > 'go'",
        &["8:9: when has a text here, expected a number", r#"8:17: when has the text "go" here, expected a number"#],
    ),
    (
        "two text variables",
        "phase == phase",
        &["8:15: when compares two texts, expected a text variable and one of its values"],
    ),
    (
        "a text beside a number",
        "laps == 'go'",
        &[r#"8:14: when compares a number with the text "go", expected two of one kind"#],
    ),
    (
        "a text as a result",
        "(tagged ? 'go' : 'return') == phase",
        &[r#"8:19: when has the text "go" here, expected a number, or true or false"#],
    ),
    ("a choice of two kinds", "(tagged ? 1 : true) > 0", &["8:23: when has true or false here, expected a number"]),
    (
        "a place as such",
        "own_flag > 3",
        &["8:9: when has the place own_flag here, expected it in a measure, as in distance(own_flag)"],
    ),
    (
        "a place that is none",
        "distance(own_flg) < 3",
        &[r#"8:18: when asks for the distance of "own_flg", expected {places} (did you mean own_flag?)"#],
    ),
    (
        "a measure of a number",
        "distance(3) < 3",
        &["8:18: when has a value in distance(), expected the name of a place or boat"],
    ),
    (
        "a measure of two",
        "distance(own_flag, enemy_flag) < 3",
        &["8:9: when gives 2 things to distance(), expected one place or boat"],
    ),
    ("an unknown call", "dist(own_flag) < 3", &["8:9: when calls dist(), expected one of {calls}"]),
    ("three numbers", "max(1, 2, 3) < laps", &["8:9: when gives 3 things to max(), expected two numbers"]),
    ("the rest", "3 % 2 == 1", &["8:11: when has % here, expected only {CEL that is allowed}"]),
    ("a list", "laps in [1, 2]", &["8:14: when has in here, expected only {CEL that is allowed}"]),
    ("a map", "{'a': 1}.a == laps", &["8:17: when has the field .a here, expected only {CEL that is allowed}"]),
    ("a field", "phase.length > 3", &["8:14: when has the field .length here, expected only {CEL that is allowed}"]),
    (
        "a method",
        "phase.startsWith('g')",
        &["8:25: when has the method startsWith() here, expected only {CEL that is allowed}"],
    ),
    ("a macro", "[1].all(x, x > 1)", &["8:16: when has a macro here, expected only {CEL that is allowed}"]),
    ("a test of presence", "has(phase.x)", &["8:9: when has has() here, expected only {CEL that is allowed}"]),
    ("null", "phase == null", &["8:18: when has null here, expected only {CEL that is allowed}"]),
    ("a word that is reserved", "if", &[r#"8:9: when has "if" here, expected a name that CEL does not reserve"#]),
    (
        "mates and facts",
        "mates(tagged) > 0",
        &["8:15: when asks mates for tagged, which is a fact, expected a shared variable"],
    ),
    (
        "mates and what is not shared",
        "mates(laps > 2) > 0",
        &["8:15: when asks mates for laps, which is not shared, expected a shared variable"],
    ),
    (
        "mates and measures",
        "mates(distance(CF) < 2) > 0",
        &["8:15: when asks mates for distance(), which is a measure, expected a shared variable"],
    ),
    (
        "mates of mates",
        "mates(mates(phase == 'go') > 1) > 0",
        &["8:15: when has mates() within mates(), expected shared variables"],
    ),
    (
        "mates without a condition",
        "mates(3) > 0",
        &["8:15: when has a number here, expected true or false, such as a comparison"],
    ),
    (
        "too deep",
        "(1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + (1 + 1)))))))))))))))))))))))))))))))))))))))) > 0",
        &["8:9: when is nested too deeply, expected at most 30 brackets in each other"],
    ),
];

#[test]
fn conditions_are_checked() {
    for (name, condition, want) in CONDITIONS {
        let variables = "alarmed = false\nlaps = 0\nphase = { values = [\"go\", \"return\"], shared = true }\n";
        let modes = format!("[[mode]]\nname = \"a\"\nwhen = \"{condition}\"\n[[mode]]\nname = \"b\"\n");
        let text = format!("base = \"s.toml\"\n[variables]\n{variables}{modes}");
        assert_broken(&[(name, &text, want)]);
    }
}

/// Expressions elsewhere, and long ones.
const EXPRESSIONS: &[Broken] = &[
    (
        "an unknown name in a program without variables",
        r#"base = "s.toml"
[[mode]]
name = "a"
when = "alarmd"
[[mode]]
name = "b"
"#,
        &[
            r#"4:9: when has "alarmd" here, which is unknown, expected a variable, a fact such as tagged or time_s, or a call such as distance(own_flag)"#,
        ],
    ),
    (
        "too long",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged || tagged"
[[mode]]
name = "b"
"#,
        &["8:8: when is 1006 characters long, expected at most 1000"],
    ),
    (
        "a long text of several lines",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = '''
tagged
  && lap > 3
'''
[[mode]]
name = "b"
"#,
        &[
            r#"10:6: when has "lap" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean laps?)"#,
        ],
    ),
    (
        "behind an escape",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[[mode]]
name = "a"
when = "phase == \"go\" && \u0074agged && lap > 3"
[[mode]]
name = "b"
"#,
        &[
            r#"8:43: when has "lap" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag) (did you mean laps?)"#,
        ],
    ),
    (
        "in the numbers of a behaviour",
        r#"base = "s.toml"
[variables]
alarmed = false
laps = 0
phase = { values = ["go", "return"], shared = true }
[behaviour.go]
kind = "waypoint"
points = ["CF"]
speed_m_s = "tagged ? 2 : cruise"
weight = "tagged"
"#,
        &[
            r#"9:27: speed_m_s has "cruise" here, which is unknown, expected a variable (alarmed, laps, phase), a fact such as tagged or time_s, or a call such as distance(own_flag)"#,
            "10:11: weight has true or false here, expected a number",
        ],
    ),
];

#[test]
fn expressions_are_checked() {
    assert_broken(EXPRESSIONS);
}
