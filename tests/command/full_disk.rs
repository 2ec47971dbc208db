//! A full disk: every command reports it and fails. Linux provides the device `/dev/full` for this.
#![cfg(target_os = "linux")]

use crate::program::{command, only_file, printed, project, words};
use std::fs::File;
use std::path::Path;

/// A short recorded game in a folder, in which all commands run.
fn recorded_game(dir: &Path) -> String {
    let args = [
        "run",
        "attack_1v1",
        "--in-process",
        "--set",
        "game.duration_s=5",
        "--record",
        "runs",
    ];
    printed(dir, &args);
    only_file(dir.join("runs"))
}

/// The commands that, with this standard output, do not fail or do not report the full disk.
fn silent<'a>(dir: &Path, output: &str, commands: &[&'a str]) -> Vec<&'a str> {
    let is_silent = |line: &&&str| {
        let mut command = command(dir, &words(line));
        let output = command
            .stdout(File::create(output).unwrap())
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        output.status.success()
            || !errors.contains("cannot ")
            || !errors.contains("No space left on device")
    };
    commands.iter().filter(is_silent).copied().collect()
}

#[test]
fn results_that_cannot_be_printed_are_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let game = recorded_game(dir.path());
    let policy = project()
        .join("scenarios/policies/options.onnx")
        .display()
        .to_string();
    let commands = [
        "run attack_1v1 --in-process --no-record --set game.duration_s=5",
        &format!("log {game}"),
        &format!("log {game} --csv frame"),
        &format!("log --compare {game} {game}"),
        &format!("log --quality {game}"),
        &format!("replay --check {game}"),
        &format!("policy {policy}"),
        "tournament simple --games 2 --jobs 1",
        "trial surveyor_m1_8 --manoeuvre turning_circle",
        "sea gale",
        "strategy strategy_4 --dot",
        "files",
        "schema game",
        "new strategy mine",
        "copy strategy_4 other",
        "completions bash",
        "man pages",
    ];
    assert_eq!(silent(dir.path(), "/dev/full", &commands), [""; 0]);
}

#[test]
fn results_that_cannot_be_written_are_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let game = recorded_game(dir.path());
    let commands = [
        "run attack_1v1 --in-process --no-record --set game.duration_s=5 --json /dev/full",
        &format!("log {game} --json /dev/full"),
        &format!("log {game} --csv frame --out /dev/full"),
        &format!("log --compare {game} {game} --json /dev/full"),
        &format!("log --quality {game} --json /dev/full"),
        "tournament simple --games 2 --jobs 1 --json /dev/full",
        "tournament simple --games 2 --jobs 1 --csv /dev/full",
        "trial surveyor_m1_8 --manoeuvre turning_circle --csv /dev/full",
        "trial surveyor_m1_8 --manoeuvre turning_circle --plot /dev/full",
        "sea gale --plot /dev/full",
    ];
    assert_eq!(silent(dir.path(), "/dev/null", &commands), [""; 0]);
}
