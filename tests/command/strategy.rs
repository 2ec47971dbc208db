//! `squall strategy` from the command line: its output for valid and invalid files.

use crate::program::{printed, project, refusal, scenario, squall};

/// The output of `squall strategy` for a file with this content: success, standard output, standard
/// error.
fn shown(text: &str, more: &[&str]) -> (bool, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    std::fs::write(&path, text).unwrap();
    let file = path.display().to_string();
    let output = squall(project(), &[&["strategy", file.as_str()], more].concat());
    let root = format!("{}/", folder.path().display());
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap().replace(&root, "");
    (
        output.status.success(),
        text(output.stdout),
        text(output.stderr),
    )
}

const PROGRAM: &str = r#"
about = "an example"
[variables]
laps = 0
[[mode]]
name = "tagged"
when = "tagged"
[[mode]]
name = "playing"
[[mode]]
name = "attacking"
in = "playing"
when = "laps < 3 && !has_flag"
[[mode]]
name = "waiting"
in = "playing"
[behaviour.stay_in]
kind = "op_region"
[behaviour.keep_clear]
kind = "avoid_collision"
weight = 250
[behaviour.grab]
kind = "waypoint"
in = ["playing"]
when = "known(enemy_flag)"
weight = "50 + laps"
points = ["enemy_flag"]
duration_s = 30
on_reach = { laps = "laps + 1" }
"#;

#[test]
fn a_strategy_is_shown_with_its_modes_and_what_runs_in_them() {
    let (is_good, text, _) = shown(PROGRAM, &[]);
    assert!(is_good);
    let want = "\
strategy x - an example

role 1: x - an example

  modes
    tagged when tagged
    playing otherwise
      attacking when laps < 3 && !has_flag
      waiting otherwise

  in tagged
    keep_clear  avoid_collision  250  safety
    stay_in     op_region        300  safety

  in playing:attacking
    grab        waypoint         50 + laps  when known(enemy_flag), for 30 s
    keep_clear  avoid_collision  250        safety
    stay_in     op_region        300        safety

  in playing:waiting
    grab        waypoint         50 + laps  when known(enemy_flag), for 30 s
    keep_clear  avoid_collision  250        safety
    stay_in     op_region        300        safety
";
    assert_eq!(text, want);
}

#[test]
fn an_unsafe_strategy_says_so_loudly() {
    let program = "unsafe_i_know = true\nunsafe_because = \"it lies still\"\n[behaviour.stop]\nkind = \"full_stop\"\n";
    let (_, text, _) = shown(program, &[]);
    assert!(text.contains("\n  !!! UNSAFE: it lies still\n"), "{text}");
    assert!(!shown(PROGRAM, &[]).1.contains("UNSAFE"));
}

#[test]
fn a_broken_strategy_is_explained_and_fails() {
    let (is_good, text, errors) = shown(&PROGRAM.replace("laps < 3", "lap < 3"), &[]);
    assert!(!is_good);
    assert!(
        text.starts_with(
            "x.toml:13:9: `when` contains \"lap\", which is unknown, expected a variable (laps)"
        ),
        "{text}"
    );
    assert!(errors.contains("1 error"), "{errors}");
}

#[test]
fn a_strategy_is_drawn_as_a_graph() {
    let (is_good, text, _) = shown(PROGRAM, &["--dot"]);
    assert!(is_good);
    for line in [
        "digraph \"x\" {",
        "    r0 -> r0m0 [label=\"when tagged\"];",
        "    r0m1 -> r0m2 [label=\"when laps < 3 && !has_flag\"];",
        "    r0m0 [label=\"tagged\\nkeep_clear: avoid_collision 250, safety\\nstay_in: op_region 300, safety\"];",
    ] {
        assert!(
            text.lines().any(|found| found == line),
            "{line} is not in\n{text}"
        );
    }
    assert_eq!(text.matches('{').count(), text.matches('}').count());
}

#[test]
fn shipped_strategies_are_shown_role_by_role() {
    let text = printed(project(), &["strategy", "scenarios/strategies/pav01.toml"]);
    for words in [
        "role 1: easy_defender",
        "role 2: easy_attacker",
        "\n  in tagged\n",
    ] {
        assert!(text.contains(words), "{words} is not in\n{text}");
    }
}

#[test]
fn the_reference_is_printed_without_a_file() {
    let page =
        std::fs::read_to_string(project().join("scenarios/strategies/REFERENCE.md")).unwrap();
    assert!(printed(project(), &["strategy", "--reference"]) == page);
    refusal(project(), &["strategy"]);
}

#[test]
fn a_check_warns_of_points_within_the_turning_circle_of_the_boat() {
    let folder = tempfile::tempdir().unwrap();
    let game = |points: &str| {
        let strategy = format!(
            "base = \"{}\"\nabout = \"a square\"\n[[mode]]\nname = \"all\"\n[behaviour.round]\nkind = \"waypoint\"\nrepeat = 9\npoints = {points}\n",
            scenario("strategies/safety.toml")
        );
        std::fs::write(folder.path().join("square.toml"), strategy).unwrap();
        let base = scenario("games/surveyor_2v2.toml");
        let game = format!(
            "base = \"{base}\"\n[[team]]\nname = \"blue\"\nstrategy = \"square.toml\"\n\
             [[team]]\nname = \"red\"\nstrategy = \"square.toml\"\n"
        );
        std::fs::write(folder.path().join("game.toml"), game).unwrap();
        printed(&folder, &["check", "game.toml"])
    };
    let said = game("[[30, 20], [30, 24], [26, 24], [26, 20]]");
    assert!(
        said.starts_with(
            "game.toml: valid game\n  warning: square: behaviour \"round\": 4 of 4 points lie"
        ),
        "{said}"
    );
    assert!(
        said.contains("circle of a surveyor_afloat coming"),
        "{said}"
    );
    assert_eq!(
        game("[[30, 20], [30, 50], [60, 50], [60, 20]]"),
        "game.toml: valid game\n"
    );
}
