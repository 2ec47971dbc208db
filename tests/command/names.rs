//! Files and recordings given by name, and files on disk that override built-in ones.

use crate::program::{command, only_file, printed, refusal};
use std::path::Path;

/// Built-in files stand in for files missing from a folder `scenarios`, even if its name is not
/// typed.
#[test]
fn a_file_in_scenarios_is_the_same_from_every_folder() {
    let dir = tempfile::tempdir().unwrap();
    let games = dir.path().join("scenarios/games");
    std::fs::create_dir_all(&games).unwrap();
    let text =
        "base = \"mixed_2v2.toml\"\nduration_s = 60\nfield = \"../fields/aquaticus_160x80.toml\"\n";
    std::fs::write(games.join("mine.toml"), text).unwrap();
    for (folder, path) in [
        ("", "scenarios/games/mine.toml"),
        ("scenarios", "games/mine.toml"),
        ("scenarios/games", "mine.toml"),
        ("scenarios/games", "../games/mine.toml"),
    ] {
        let said = printed(dir.path().join(folder), &["check", path]);
        assert_eq!(said.trim_end(), format!("{path}: valid game"));
    }
}

#[test]
fn a_name_does_for_every_scenario_file() {
    let dir = tempfile::tempdir().unwrap();
    printed(&dir, &["new", "strategy", "mine"]);
    printed(&dir, &["new", "boat", "mine"]);
    let said = printed(&dir, &["check", "mine", "gale"]);
    let valid = |path: &str, kind: &str| format!("scenarios/{path}.toml: valid {kind}\n");
    assert_eq!(
        said,
        [
            valid("boats/mine", "boat"),
            valid("strategies/mine", "strategy"),
            valid("seas/gale", "sea")
        ]
        .concat()
    );
    assert!(
        refusal(&dir, &["check", "min"])
            .contains("no scenario file named \"min\" (did you mean mine?)")
    );
    assert!(
        printed(&dir, &["policy", "options"]).contains("options: a value of a strategy's variable")
    );
    assert!(refusal(&dir, &["policy", "option"]).contains("one of chooser, mctf_2026, options"));
    std::fs::write(
        dir.path().join("scenarios/strategies/based.toml"),
        "base = \"policy\"\n",
    )
    .unwrap();
    assert_eq!(
        printed(&dir, &["check", "based"]),
        valid("strategies/based", "strategy")
    );
    let said = printed(&dir, &["tournament", "mine", "strategy_4", "--games", "2"]);
    assert!(
        said.contains("mine ") && said.contains("strategy_4 ") && said.contains("squall run"),
        "{said}"
    );
    assert!(refusal(&dir, &["tournament", "mine", "mine"]).contains("given twice"));
}

#[test]
fn a_model_plays_like_the_strategy_that_uses_it() {
    let dir = tempfile::tempdir().unwrap();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/policies/options.onnx");
    std::fs::copy(model, dir.path().join("trained_1.onnx")).unwrap();
    let digest = |strategy: &str| {
        let how = ["--in-process", "--no-record", "--set", "game.duration_s=20"];
        let said = printed(
            &dir,
            &[&["run", "surveyor_2v2", "--blue", strategy][..], &how].concat(),
        );
        said.split("digest ").nth(1).unwrap()[..32].to_owned()
    };
    let want = digest("learned");
    for model in ["trained_1.onnx", "scenarios/policies/options.onnx"] {
        assert_eq!(digest(model), want, "{model}");
        assert!(
            printed(&dir, &["policy", model]).contains("options: a value"),
            "{model}"
        );
    }
    // The strategy file that training writes next to a model takes precedence.
    let strategy = "base = \"scenarios/strategies/strategy_4.toml\"\n";
    std::fs::write(dir.path().join("trained_1.toml"), strategy).unwrap();
    assert_eq!(digest("trained_1.onnx"), digest("strategy_4"));
}

#[test]
fn a_recording_has_a_name_and_the_newest_needs_none() {
    let dir = tempfile::tempdir().unwrap();
    for args in [&["log"][..], &["replay", "--check"]] {
        assert!(
            refusal(&dir, args).contains("no recordings in runs/; record a game"),
            "{args:?}"
        );
    }
    printed(
        &dir,
        &[
            "run",
            "attack_1v1",
            "--in-process",
            "--set",
            "game.duration_s=5",
        ],
    );
    let older = Path::new(&only_file(dir.path().join("runs")))
        .file_stem()
        .unwrap()
        .to_str()
        .unwrap()
        .to_owned();
    printed(
        &dir,
        &[
            "run",
            "pav01_vs_pav01",
            "--in-process",
            "--set",
            "game.duration_s=7",
        ],
    );
    let listed = printed(&dir, &["runs"]);
    let rows: Vec<Vec<&str>> = listed
        .lines()
        .map(|row| row.split_whitespace().collect())
        .collect();
    assert!(
        rows.len() == 3 && rows[1][0].contains("_pav01_vs_pav01_") && rows[2][0] == older,
        "{listed}"
    );
    assert_eq!(
        rows[1][3..],
        ["7", "s", "0", ":", "0", "pav01", ":", "pav01"]
    );
    for (args, want) in [
        (&["log"][..], "in process, 7.0 s"),
        (&["log", "attack"], "in process, 5.0 s"),
        (&["replay", "--check"], "to 7.0 s"),
        (&["replay", "--check", &older], "to 5.0 s"),
    ] {
        let said = printed(&dir, args);
        assert!(said.contains(want), "{args:?}: {said}");
    }
    assert!(refusal(&dir, &["log", "gale"]).contains("no recording matches \"gale\" in runs/"));
}

#[test]
fn the_users_own_files_come_first_and_one_that_overrides_is_announced_once() {
    let dir = tempfile::tempdir().unwrap();
    let stderr =
        |args: &[&str]| String::from_utf8(command(&dir, args).output().unwrap().stderr).unwrap();
    let remark =
        "scenarios/strategies/strategy_4.toml overrides the built-in strategies/strategy_4.toml\n";
    printed(&dir, &["copy", "gale"]);
    assert_eq!(stderr(&["new", "strategy", "strategy_4"]), remark);
    let listed = printed(&dir, &["files"]);
    let own = "your own files:\n  scenarios/strategies/strategy_4.toml  overrides the built-in file; goes for";
    assert!(
        listed.starts_with(own) && listed.contains("\nseas: any "),
        "{listed}"
    );
    let of_kind = printed(&dir, &["files", "strategy"]);
    assert!(
        of_kind.contains("\n  strategy_3 ") && !of_kind.contains("gale"),
        "{of_kind}"
    );
    for how in [&["--in-process"][..], &[]] {
        let game = [
            "run",
            "strategy_4_vs_3",
            "--no-record",
            "--set",
            "game.duration_s=2",
        ];
        assert_eq!(stderr(&[&game, how].concat()), remark);
    }
}
