//! `squall log` from the command line: records a short game, then examines it in every way; user
//! errors are explained.

use crate::program;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::OnceLock;
use tempfile::TempDir;

/// A recorded game and its result, shared by all tests.
struct Game {
    _dir: TempDir,
    recording: String,
    result: Value,
}

fn game() -> &'static Game {
    static GAME: OnceLock<Game> = OnceLock::new();
    GAME.get_or_init(|| {
        let dir = tempfile::tempdir().unwrap();
        let runs = text(dir.path().join("runs"));
        let json = text(dir.path().join("result.json"));
        let game = "scenarios/games/attack_1v1.toml";
        program::printed(
            program::project(),
            &[
                "run",
                game,
                "--in-process",
                "--record",
                &runs,
                "--json",
                &json,
            ],
        );
        let result = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
        Game {
            _dir: dir,
            recording: program::only_file(&runs),
            result,
        }
    })
}

fn text(path: PathBuf) -> String {
    path.display().to_string()
}

/// The output of `squall log` for the game; it must succeed.
fn log(args: &[&str]) -> String {
    program::printed(program::project(), &[&["log"], args].concat())
}

#[test]
fn the_summary_agrees_with_the_result_of_the_game() {
    let game = game();
    let dir = tempfile::tempdir().unwrap();
    let json = text(dir.path().join("summary.json"));
    let page = log(&[&game.recording, "--json", &json]);
    for part in [
        "attack_1v1",
        "seed 1",
        "in process",
        "blue",
        "digest",
        "navigation error",
        "picture/blue",
        "messages",
    ] {
        assert!(page.contains(part), "{part} is not in\n{page}");
    }
    let summary: Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let outcome = &game.result;
    // The frames contain every event.
    assert_eq!(summary["events"], outcome["events"]);
    assert_eq!(summary["score"], outcome["score"]["teams"]);
    assert_eq!(
        (&summary["digest"], &summary["winner"]),
        (&outcome["digest"], &outcome["winner"])
    );
    assert_eq!(summary["is_cut"], Value::Bool(false));
    for boat in summary["boats"].as_array().unwrap() {
        let name = boat["boat"].as_str().unwrap();
        assert_eq!(boat["counts"], outcome["counts"]["boats"][name], "{name}");
        assert!(boat["distance_m"].as_f64().unwrap() >= 0.0);
    }
    let events = log(&[&game.recording, "--events"]);
    assert_eq!(
        events.lines().count(),
        outcome["events"].as_array().unwrap().len()
    );
}

#[test]
fn every_topic_comes_as_csv() {
    let game = game();
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("table.csv");
    for topic in ["frame", "inputs", "picture/blue", "picture/red", "events"] {
        let printed = log(&[&game.recording, "--csv", topic]);
        assert!(
            printed.starts_with("t_s,") && printed.lines().count() > 1,
            "{topic}: {printed}"
        );
        assert_eq!(
            log(&[
                &game.recording,
                "--csv",
                topic,
                "--out",
                out.to_str().unwrap()
            ]),
            ""
        );
        assert_eq!(std::fs::read_to_string(&out).unwrap(), printed, "{topic}");
    }
    let frame = log(&[&game.recording, "--csv", "frame"]);
    let mut rows = csv::Reader::from_reader(frame.as_bytes());
    let heads = rows.headers().unwrap().clone();
    assert!(
        heads.iter().any(|head| head.ends_with(".north_m")),
        "{heads:?}"
    );
    assert!(rows.records().all(|row| row.unwrap().len() == heads.len()));
}

#[test]
fn moos_logs_are_written_for_shore_and_boats() {
    let game = game();
    let dir = tempfile::tempdir().unwrap();
    let logs = dir.path().join("logs");
    log(&[&game.recording, "--alog", logs.to_str().unwrap()]);
    assert_eq!(std::fs::read_dir(&logs).unwrap().count(), 3);
    let shoreside = std::fs::read_to_string(logs.join("shoreside.alog")).unwrap();
    assert!(
        shoreside.starts_with("%%%%")
            && shoreside.contains(" NODE_REPORT ")
            && shoreside.contains(" BLUE_SCORES ")
    );
    let logs = logs.to_str().unwrap();
    let events = log(&[&game.recording, "--events"]);
    assert_eq!(log(&[logs, "--events"]), events, "they are read again");
    let alone = dir.path().join("shore.alog");
    log(&[&game.recording, "--alog", alone.to_str().unwrap()]);
    assert_eq!(std::fs::read_to_string(alone).unwrap(), shoreside);
}

#[test]
fn a_game_beside_itself_differs_in_nothing() {
    let game = game();
    let dir = tempfile::tempdir().unwrap();
    let json = text(dir.path().join("compare.json"));
    let page = log(&[
        "--compare",
        &game.recording,
        &game.recording,
        "--json",
        &json,
    ]);
    assert!(
        page.contains("Fréchet") && !page.contains("only in"),
        "{page}"
    );
    let comparison: Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    for pair in comparison["boats"].as_array().unwrap() {
        for (what, metres) in pair["apart"].as_object().unwrap() {
            assert_eq!(metres.as_f64(), Some(0.0), "{what}");
        }
    }
}

#[test]
fn mistakes_are_explained() {
    let recording = game().recording.as_str();
    let toml = "scenarios/games/attack_1v1.toml";
    for (args, said) in [
        (
            &[recording, "--csv", "whales"][..],
            "no topic \"whales\" in this recording; its topics are: events, frame",
        ),
        (
            &["--compare", recording, "nowhere.mcap"],
            "there is no file nowhere.mcap",
        ),
        (
            &["--compare", recording],
            "--compare needs two recordings, but got 1",
        ),
        (
            &[recording, recording],
            "needs one recording, or several with --quality, but got 2",
        ),
        (
            &["--quality", recording, "nowhere.mcap"],
            "there is no file nowhere.mcap",
        ),
        (&[recording, "--alog", toml], "cannot create the folder"),
    ] {
        let refused = program::refusal(program::project(), &[&["log"], args].concat());
        assert!(
            refused.contains(said),
            "{args:?} should print {said:?}, but prints {refused}"
        );
    }
}
