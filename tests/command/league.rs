//! `squall league`, and the leagues of `squall tournament`: results are kept, and only missing games
//! are played.

use crate::program::scenario;
use crate::tournament::{json, output, place, tournament_of};
use serde_json::Value;

#[test]
fn who_joins_a_league_plays_its_own_games_alone_and_a_torn_line_is_played_again() {
    let dir = tempfile::tempdir().unwrap();
    let league = place(&dir, "league");
    let whole = place(&dir, "whole.json");
    let results = format!("{league}/results.jsonl");
    let play = |entries: &[(&str, &str)], options: &[&str]| {
        let tournament = tournament_of(&dir, "games = 4", entries);
        let output = output(&[&["tournament", &tournament], options].concat());
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    let [four, pav01, idle] = ["strategy_4", "pav01", "idle"].map(|name| (name, name));
    let said = play(&[four, pav01], &["--league", &league]);
    assert!(said.contains("0 of 4 games already played"), "{said}");
    // The last line was truncated when the machine stopped. The resumed league writes the same
    // bytes.
    let text = std::fs::read_to_string(&results).unwrap();
    let uninterrupted = std::fs::read(format!("{league}/report.json")).unwrap();
    std::fs::write(&results, &text[..text.len() - 9]).unwrap();
    let said = play(&[four, pav01], &["--league", &league]);
    assert!(said.contains("3 of 4 games already played"), "{said}");
    assert_eq!(std::fs::read_to_string(&results).unwrap(), text);
    assert_eq!(
        std::fs::read(format!("{league}/report.json")).unwrap(),
        uninterrupted
    );
    std::fs::write(&results, &text[..text.len() - 9]).unwrap();
    let said = play(&[four, pav01, idle], &["--league", &league]);
    assert!(
        said.contains("3 of 12 games already played") && said.contains("9 games in"),
        "{said}"
    );
    // The result equals that of a tournament that plays all games.
    play(&[four, pav01, idle], &["--json", &whole]);
    let mut known = json(&format!("{league}/report.json"));
    let mut anew = json(&whole);
    anew["rate"] = Value::Null;
    // Only the history shows that idle joined later: it is rated after its first game.
    let joined = |report: &mut Value| {
        let idle = report["entries"]
            .as_array()
            .unwrap()
            .iter()
            .position(|row| row["name"] == "idle")
            .unwrap();
        let history = report["history"].take();
        history
            .as_array()
            .unwrap()
            .iter()
            .find(|at| !at["elo"][idle].is_null())
            .unwrap()["games"]
            .clone()
    };
    assert_eq!(
        (joined(&mut known), joined(&mut anew)),
        (4.into(), 3.into())
    );
    assert_eq!(known, anew);
    // A renamed file is the same player; a changed file is not.
    let said = play(&[("renamed", "strategy_4"), pav01], &["--league", &league]);
    assert!(said.contains("4 of 4 games already played"), "{said}");
    let said = play(&[four, ("pav01", "easy_attackers")], &["--league", &league]);
    assert!(said.contains("0 of 4 games already played"), "{said}");
    // If a game file has changed on disk, its earlier results are unusable.
    let changed = text.replacen("\"seed\":1", "\"seed\":7", 1);
    assert_ne!(changed, text);
    for (damaged, expected) in [
        ("{}\n", "missing field"),
        (changed.as_str(), "its checksum does not match"),
    ] {
        std::fs::write(&results, damaged).unwrap();
        let refused = output(&[
            "tournament",
            &place(&dir, "tournament.toml"),
            "--league",
            &league,
        ]);
        let why = String::from_utf8(refused.stderr).unwrap();
        assert!(
            !refused.status.success() && why.contains("results.jsonl: line 1 is not a league game"),
            "{why}"
        );
        assert!(why.contains(expected), "{why}");
    }
}

#[test]
fn a_league_plays_its_file_and_the_given_strategies_in_every_sea_and_nothing_twice() {
    let dir = tempfile::tempdir().unwrap();
    let entries = [("pav01", "pav01"), ("idle", "idle")];
    let file = tournament_of(&dir, "games = 2", &entries).replace("tournament.toml", "own.toml");
    std::fs::rename(place(&dir, "tournament.toml"), &file).unwrap();
    let folder = place(&dir, "league");
    let play = |more: &[&str]| {
        let how = [&["league", "--file", &file, "--folder", &folder], more].concat();
        let output = output(&how);
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        (String::from_utf8(output.stderr).unwrap(), text)
    };
    let (said, _) = play(&[]);
    assert!(said.contains("0 of 2 games already played"), "{said}");
    let seas = ["--sea", "moderate_breeze", "--sea", "calm"];
    let (said, text) = play(&[&["scenarios/policies/options.onnx"][..], &seas].concat());
    assert!(said.contains("2 of 12 games already played"), "{said}");
    assert!(said.contains("squall view "), "{said}");
    for words in ["learned", "rule_based", "moderate_breeze", "--sea SEA"] {
        assert!(text.contains(words), "{text}");
    }
    let report = json(&format!("{folder}/report.json"));
    assert_eq!(report["seas"].as_array().unwrap().len(), 2);
    assert_eq!(report["games_per_pairing"], 4);
    let twice = output(&["league", "--sea", "calm", "--sea", "calm"]);
    let why = String::from_utf8(twice.stderr).unwrap();
    assert!(why.contains("a sea is given twice"), "{why}");
}

#[test]
fn a_changed_competition_entry_plays_its_games_again() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::create_dir(dir.path().join("rival")).unwrap();
    let solution = dir.path().join("rival/solution.py");
    let write = |action: u32| {
        let text = "class solution:\n    def compute_action(self, *a, **k):\n        return ";
        std::fs::write(&solution, format!("{text}{action}\n")).unwrap();
    };
    let file = tournament_of(&dir, "games = 2", &[("idle", "idle")]);
    let text = std::fs::read_to_string(&file).unwrap();
    let rival = "[[entry]]\nname = \"rival\"\nstrategy = \"host:rival\"\n";
    std::fs::write(&file, text + rival).unwrap();
    let league = place(&dir, "league");
    let known = || {
        let said = output(&["tournament", &file, "--league", &league]).stderr;
        let said = String::from_utf8(said).unwrap();
        said.lines().next().unwrap().to_owned()
    };
    write(16);
    assert_eq!(known(), "0 of 2 games already played");
    assert_eq!(known(), "2 of 2 games already played");
    write(4);
    assert_eq!(known(), "0 of 2 games already played");
    let report = json(&format!("{league}/report.json"));
    assert_eq!(report["failures"], serde_json::json!([]));
    let rows = report["entries"].as_array().unwrap();
    let rival = rows.iter().find(|row| row["name"] == "rival").unwrap();
    assert_eq!(rival["kind"], "public");
}

#[test]
fn an_endless_file_in_place_of_a_leagues_results_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    for endless in ["/proc/kmsg", "/dev/zero"] {
        let results = place(&dir, "results.jsonl");
        std::os::unix::fs::symlink(endless, &results).unwrap();
        let refused = output(&["tournament", "simple", "--league", &place(&dir, "")]);
        let why = String::from_utf8(refused.stderr).unwrap();
        assert!(why.contains("cannot open the league"), "{endless}: {why}");
        assert!(!refused.status.success());
        std::fs::remove_file(&results).unwrap();
    }
}

#[test]
fn an_entry_is_a_strategy_file_a_trained_model_or_a_competition_entry() {
    let dir = tempfile::tempdir().unwrap();
    let model = scenario("policies/options.onnx");
    std::fs::copy(model, dir.path().join("mine.onnx")).unwrap();
    let file = tournament_of(&dir, "games = 2", &[("idle", "idle")]);
    let text = std::fs::read_to_string(&file).unwrap() + "kind = \"planner\"\n";
    let report = place(&dir, "report.json");
    let play = |strategy: &str| {
        let entry = format!("[[entry]]\nname = \"mine\"\nstrategy = {strategy:?}\n");
        std::fs::write(&file, format!("{text}{entry}")).unwrap();
        output(&["tournament", &file, "--json", &report])
    };
    let played = play("mine.onnx");
    assert!(played.status.success(), "{played:?}");
    let report = json(&report);
    for (name, kind) in [("mine", "learned"), ("idle", "planner")] {
        let rows = report["entries"].as_array().unwrap();
        let row = rows.iter().find(|row| row["name"] == name).unwrap();
        assert_eq!(row["kind"], kind, "{name}");
    }
    for (wrong, why) in [
        ("host:none", "no solution.py in"),
        ("none.onnx", "there is no file"),
    ] {
        let refused = play(wrong);
        let said = String::from_utf8(refused.stderr).unwrap();
        assert!(!refused.status.success() && said.contains(why), "{said}");
        assert!(said.contains("tournament.toml:"), "{said}");
    }
}
