//! Expressions in strategy files mean the same as in CEL, print as written, and survive
//! serialisation.

#![expect(clippy::unwrap_used, reason = "a test that cannot continue has failed")]

use proptest::prelude::*;
use scenario::Problems;
use scenario::strategy::{Expression, Fact, Measure, Place, Program, Values};

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

/// The game's values in these tests.
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
    fn between(&self, measure: Measure, from: &Place, to: &Place) -> f64 {
        match (measure, from, to) {
            (Measure::Distance, Place::Boat(_), Place::Mark(_)) => 40.0,
            (Measure::Closing, Place::Boat(_), Place::Mark(_)) => 1.5,
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
    scenario::load_file::<scenario::strategy::Strategy>(&path)
        .map(|strategy| strategy.roles.into_iter().next().unwrap())
}

fn quoted(expression: &str) -> String {
    let escaped = expression.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}

/// A program with a rule under this condition.
fn with_condition(condition: &str) -> Result<Program, Problems> {
    program(&format!(
        "{HEAD}[[rule]]\nwhen = {}\nset = {{ laps = 1 }}\n",
        quoted(condition)
    ))
}

fn condition(program: &Program) -> &Expression {
    program.rules[0].when.as_ref().unwrap()
}

/// A program with a timer of this many seconds.
fn with_number(number: &str) -> Result<Program, Problems> {
    program(&format!(
        "{HEAD}[behaviour.wait]\nkind = \"timer\"\nduration_s = {}\n",
        quoted(number)
    ))
}

fn number(program: &Program) -> &Expression {
    let mut behaviours = program.behaviours.iter();
    let wait = behaviours.find(|behaviour| behaviour.name == "wait");
    &wait.unwrap().duration_s.as_ref().unwrap().expression
}

/// The expressions in the accompanying file: whether each is a condition, its source, and its value
/// (1 for true).
fn cases() -> Vec<(bool, &'static str, f64)> {
    let lines = include_str!("strategy_expressions.txt").lines();
    let lines = lines.filter(|line| !line.starts_with('#'));
    let case = |line: &'static str| {
        let parts = line.rsplit_once(" => ");
        let (text, want) = parts.unwrap_or_else(|| panic!("not EXPRESSION => VALUE: {line}"));
        let number = || want.parse().unwrap_or_else(|e| panic!("{line}: {e}"));
        match want {
            "true" | "false" => (true, text, f64::from(u8::from(want == "true"))),
            _ => (false, text, number()),
        }
    };
    let cases: Vec<_> = lines.map(case).collect();
    assert!(cases.len() >= 54, "{} expressions", cases.len());
    cases
}

/// The program with this expression, which must be valid, and the expression in it.
fn read(is_condition: bool, text: &str) -> (Program, Expression) {
    let program = match is_condition {
        true => with_condition(text),
        false => with_number(text),
    };
    let program = program.unwrap_or_else(|problems| panic!("{text}: {problems}"));
    let expression = match is_condition {
        true => condition(&program).clone(),
        false => number(&program).clone(),
    };
    (program, expression)
}

fn value(is_condition: bool, expression: &Expression) -> f64 {
    if is_condition {
        f64::from(u8::from(expression.is_true(&Known)))
    } else {
        expression.value(&Known)
    }
}

#[test]
fn expressions_are_evaluated_as_cel_does_and_survive_json_exactly() {
    for (is_condition, text, want) in cases() {
        let (program, expression) = read(is_condition, text);
        assert_eq!(value(is_condition, &expression), want, "{text}");
        let json = serde_json::to_string(&program).unwrap();
        let again: Program = serde_json::from_str(&json).unwrap();
        assert_eq!(again, program, "{json}");
    }
}

#[test]
fn expressions_in_words_mean_the_same() {
    for (is_condition, text, want) in cases() {
        let in_words = |program: &Program, expression: &Expression| match is_condition {
            true => program.condition_text(expression),
            false => program.number_text(expression),
        };
        let (program, expression) = read(is_condition, text);
        let words = in_words(&program, &expression);
        let (again, expression) = read(is_condition, &words);
        assert_eq!(value(is_condition, &expression), want, "{text}: {words}");
        assert_eq!(in_words(&again, &expression), words, "{text}");
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

/// Fragments of valid and invalid expressions.
fn pieces() -> Vec<&'static str> {
    let words = "tagged laps phase 'go' \"go\" 1 2.5 true null CF in 0x 1u b'x' é \u{1f6a4} \n";
    let signs =
        "&& || ! == != < >= + - * / % ? : ( ) [ ] { } , . distance( mates( min( has( \\ ' \" // `";
    words.split(' ').chain(signs.split(' ')).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_expressions_are_refused_or_read(text in any::<String>(), quotes in 0..2) {
        let given = if quotes == 0 { quoted(&text) } else { format!("'''{text}'''") };
        answers(&given);
    }

    #[test]
    fn arbitrary_pieces_are_refused_or_read(these in prop::collection::vec(prop::sample::select(pieces()), 0..24), spaced in any::<bool>()) {
        answers(&quoted(&these.join(if spaced { " " } else { "" })));
    }
}

/// Any result is acceptable, but problems must lie within the file.
fn answers(given: &str) {
    let text = format!(
        "{HEAD}[[rule]]\nwhen = {given}\nset = {{ laps = 1 }}\n[behaviour.w]\nkind = \"timer\"\nduration_s = {given}\n"
    );
    let lines = text.split('\n').count();
    if let Err(problems) = program(&text) {
        assert!(!problems.0.is_empty());
        for problem in &problems.0 {
            assert!((1..=lines).contains(&problem.line) && problem.column > 0);
        }
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
    // Long but flat expressions are valid.
    let flat = format!("{}tagged", "tagged || ".repeat(90));
    assert!(with_condition(&flat).is_ok());
}
