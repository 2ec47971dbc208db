//! Expressions of strategy files: they mean what CEL says, are written as they were typed, and survive the journey.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use game::scenario::{self, Problems};
use game::strategy::{Expression, Fact, Measure, Place, Program, Values};
use proptest::prelude::*;

const HEAD: &str = r#"
[variables]
alarmed = true
laps = 3
phase = { values = ["go", "return"], initial = "return", shared = true }
[behaviour.stay_in]
kind = "op_region"
[behaviour.keep_clear]
kind = "avoid_collision"
"#;

/// The game as these tests know it.
struct Known;

impl Values for Known {
    fn fact(&self, fact: Fact) -> f64 {
        match fact {
            Fact::Tagged | Fact::OwnSide => 1.0,
            Fact::TimeS => 12.5,
            _ => 0.0,
        }
    }
    fn variable(&self, index: u16) -> f64 {
        [1.0, 3.0, 1.0][usize::from(index)]
    }
    fn measure(&self, measure: Measure, place: &Place) -> f64 {
        match (measure, place) {
            (Measure::Distance, Place::Point(name)) if name == "CF" => 7.0,
            (Measure::Distance, _) => 1e9,
            _ => 0.0,
        }
    }
    fn mates(&self, condition: &Expression) -> f64 {
        if condition.is_true(self) { 2.0 } else { 0.0 }
    }
}

fn program(text: &str) -> Result<Program, Problems> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    std::fs::write(&path, text).unwrap();
    scenario::load_strategy(&path).map(|strategy| strategy.roles.into_iter().next().unwrap())
}

fn quoted(expression: &str) -> String {
    format!("\"{}\"", expression.replace('\\', "\\\\").replace('"', "\\\""))
}

/// A program with a rule under this condition.
fn with_condition(condition: &str) -> Result<Program, Problems> {
    program(&format!("{HEAD}[[rule]]\nwhen = {}\nset = {{ laps = 1 }}\n", quoted(condition)))
}

fn condition(program: &Program) -> &Expression {
    program.rules[0].when.as_ref().unwrap()
}

/// A program with a timer of this many seconds.
fn with_number(number: &str) -> Result<Program, Problems> {
    program(&format!("{HEAD}[behaviour.wait]\nkind = \"timer\"\nduration_s = {}\n", quoted(number)))
}

fn number(program: &Program) -> &Expression {
    let wait = program.behaviours.iter().find(|behaviour| behaviour.name == "wait").unwrap();
    &wait.duration_s.as_ref().unwrap().expression
}

const CONDITIONS: [(&str, bool); 42] = [
    ("true", true),
    ("false", false),
    ("!false", true),
    ("!!true", true),
    ("tagged", true),
    ("has_flag", false),
    ("tagged && has_flag", false),
    ("tagged || has_flag", true),
    // && binds tighter than ||.
    ("true || false && false", true),
    ("(true || false) && false", false),
    ("false && false || true", true),
    // Comparisons bind tighter than both, ! tighter than comparisons.
    ("1 < 2 && 2 < 1", false),
    ("!tagged == false", true),
    ("!(tagged == false)", true),
    ("laps > 2", true),
    ("laps > 3", false),
    ("laps >= 3", true),
    ("laps <= 3", true),
    ("laps < 3", false),
    ("laps == 3", true),
    ("laps == 3.0", true),
    ("laps != 3", false),
    ("-laps < 0", true),
    ("laps == -3", false),
    ("1 + 2 * 3 == 7", true),
    ("(1 + 2) * 3 == 9", true),
    ("10 - 4 - 3 == 3", true),
    ("12 / 2 / 3 == 2.0", true),
    ("2 - -2 == 4", true),
    ("1e2 == 100.0 && 0x10 == 16 && .5 == 0.5", true),
    ("phase == 'return'", true),
    ("'return' == phase", true),
    ("phase == \"go\"", false),
    ("phase != 'go'", true),
    ("tagged == own_side", true),
    ("tagged != own_side", false),
    ("tagged ? has_flag : true", false),
    ("false ? false : false ? false : true", true),
    ("tagged && (laps > 2 ? true : false)", true),
    ("distance(CF) < 10 && distance('CF') == distance(CF) && distance(own_flag) > 1e8", true),
    ("mates(phase == 'return') == 2 && mates(phase == 'go') == 0", true),
    ("tagged // a comment, as CEL has it", true),
];

const NUMBERS: [(&str, f64); 12] = [
    ("5", 5.0),
    ("2.5e1", 25.0),
    ("laps * 2 + 1", 7.0),
    ("laps - 1 - 1", 1.0),
    ("laps - (1 - 1)", 3.0),
    ("5 / 2", 2.5),
    ("laps / 0", 0.0),
    ("min(laps, 2) + max(laps, 2)", 5.0),
    ("tagged ? 1 + 1 : 9", 2.0),
    ("time_s", 12.5),
    ("-laps + 10", 7.0),
    ("mates(phase != 'go') + mates", 2.0),
];

#[test]
fn expressions_are_evaluated_as_cel_does() {
    for (text, want) in CONDITIONS {
        let program = with_condition(text).unwrap_or_else(|problems| panic!("{text}: {problems}"));
        assert_eq!(condition(&program).is_true(&Known), want, "{text}");
    }
    for (text, want) in NUMBERS {
        let program = with_number(text).unwrap_or_else(|problems| panic!("{text}: {problems}"));
        assert_eq!(number(&program).value(&Known), want, "{text}");
    }
}

#[test]
fn expressions_in_words_mean_the_same() {
    for (text, want) in CONDITIONS {
        let program = with_condition(text).unwrap();
        let words = program.condition_text(condition(&program));
        let again = with_condition(&words).unwrap_or_else(|problems| panic!("{text}: {words}: {problems}"));
        assert_eq!(condition(&again).is_true(&Known), want, "{text}: {words}");
        assert_eq!(again.condition_text(condition(&again)), words, "{text}");
    }
    for (text, want) in NUMBERS {
        let program = with_number(text).unwrap();
        let words = program.number_text(number(&program));
        let again = with_number(&words).unwrap_or_else(|problems| panic!("{text}: {words}: {problems}"));
        assert_eq!(number(&again).value(&Known), want, "{text}: {words}");
    }
    for text in [
        "phase == 'return' && !alarmed || distance(CF) <= 3",
        "(tagged || has_flag) && laps - (2 - 1) > 0",
        "mates(phase != 'go') > 0",
        "alarmed == (laps > 3)",
        "tagged ? has_flag : own_side ? alarmed : false",
    ] {
        let program = with_condition(text).unwrap();
        assert_eq!(program.condition_text(condition(&program)), text);
    }
}

#[test]
fn expressions_survive_json_exactly() {
    for (text, _) in CONDITIONS {
        let program = with_condition(text).unwrap();
        let text = serde_json::to_string(&program).unwrap();
        assert_eq!(serde_json::from_str::<Program>(&text).unwrap(), program, "{text}");
    }
    for (text, _) in NUMBERS {
        let program = with_number(text).unwrap();
        let text = serde_json::to_string(&program).unwrap();
        assert_eq!(serde_json::from_str::<Program>(&text).unwrap(), program, "{text}");
    }
}

/// What expressions are made of, and what they are not.
const PIECES: [&str; 48] = [
    "tagged",
    "laps",
    "phase",
    "'go'",
    "\"go\"",
    "1",
    "2.5",
    "true",
    "null",
    "&&",
    "||",
    "!",
    "==",
    "!=",
    "<",
    ">=",
    "+",
    "-",
    "*",
    "/",
    "%",
    "?",
    ":",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ".",
    "distance(",
    "mates(",
    "min(",
    "CF",
    "in",
    "has(",
    "\\",
    "'",
    "\"",
    "é",
    "\u{1f6a4}",
    "0x",
    "1u",
    "b'x'",
    "\n",
    "//",
    "`",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_expressions_are_refused_or_read(text in any::<String>(), quotes in 0..2) {
        let given = if quotes == 0 { quoted(&text) } else { format!("'''{text}'''") };
        answers(&given);
    }

    #[test]
    fn arbitrary_pieces_are_refused_or_read(which in prop::collection::vec(0..PIECES.len(), 0..24), spaced in any::<bool>()) {
        let pieces: Vec<&str> = which.into_iter().map(|which| PIECES[which]).collect();
        answers(&quoted(&pieces.join(if spaced { " " } else { "" })));
    }
}

/// Whatever the answer is, it is an answer, and problems stand within the file.
fn answers(given: &str) {
    let text = format!(
        "{HEAD}[[rule]]\nwhen = {given}\nset = {{ laps = 1 }}\n[behaviour.w]\nkind = \"timer\"\nduration_s = {given}\n"
    );
    let lines = text.split('\n').count();
    if let Err(problems) = program(&text) {
        assert!(!problems.0.is_empty());
        assert!(problems.0.iter().all(|problem| (1..=lines).contains(&problem.line) && problem.column > 0));
    }
}

#[test]
fn deep_and_long_expressions_are_refused() {
    for text in [
        "(".repeat(900),
        format!("{}true{}", "(".repeat(400), ")".repeat(400)),
        format!("{}tagged", "!".repeat(900)),
        format!("{}1 > 0", "- ".repeat(400)),
        format!("{}true", "true ? true : ".repeat(70)),
        format!("{}1 > 0", "1 + ".repeat(240)),
        format!("{}1 > 0", "-(".repeat(300)),
        "min(".repeat(240),
        "[".repeat(900),
        format!("{}true", "a.".repeat(400)),
        "tagged || ".repeat(10_000),
    ] {
        answers(&quoted(&text));
    }
    // What is long but flat is fine.
    let flat = format!("{}tagged", "tagged || ".repeat(90));
    assert!(with_condition(&flat).is_ok());
}
