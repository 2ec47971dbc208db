//! The cost of recording: the rate of a 20-against-20 lockstep game with a recording, divided by
//! its rate without.
//!
//! Games with and without a recording alternate, so that both see the same machine. The benchmark
//! prints medians.
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a benchmark reads the clock and prints"
)]

use std::path::Path;
use std::process::Command;

/// Games of each kind.
const ROUNDS: usize = 7;

fn main() {
    // `cargo test --benches` runs this with `--test`: there is nothing to check.
    if !std::env::args().any(|arg| arg == "--bench") {
        return;
    }
    let dir = tempfile::tempdir().expect("a temporary directory");
    let game = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/twenty.toml");
    println!("20 against 20 for 60 s in lockstep, median of {ROUNDS} games each, alternating");
    println!(
        "| agent processes | without, x real time | with a recording | with over without | MB recorded |"
    );
    println!("|---|---|---|---|---|");
    for boats_each in ["1", "10"] {
        let mut rates = Vec::new();
        let mut bytes = 0;
        for _ in 0..ROUNDS {
            let runs = dir.path().join("runs");
            let without = rate(
                &game,
                &["--no-record", "--agents-per-process", boats_each],
                dir.path(),
            );
            let folder = runs.display().to_string();
            let with = rate(
                &game,
                &["--record", &folder, "--agents-per-process", boats_each],
                dir.path(),
            );
            let files = std::fs::read_dir(&runs)
                .expect("recordings")
                .map(|file| file.expect("a file"));
            bytes = files
                .map(|file| file.metadata().expect("the file exists").len())
                .sum();
            std::fs::remove_dir_all(&runs).expect("the folder can be removed");
            rates.push([without, with, with / without]);
        }
        let median = |i: usize| {
            let mut values: Vec<f64> = rates.iter().map(|rate| rate[i]).collect();
            values.sort_by(f64::total_cmp);
            values[values.len() / 2]
        };
        let processes = 40 / boats_each.parse::<u32>().expect("a number");
        let megabytes = bytes as f64 / 1e6;
        println!(
            "| {processes} | {:.1} | {:.1} | {:.3} | {megabytes:.1} |",
            median(0),
            median(1),
            median(2)
        );
    }
}

/// Simulated seconds per second of a game.
fn rate(game: &Path, options: &[&str], dir: &Path) -> f64 {
    let json = dir.join("result.json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
    command
        .arg("run")
        .arg(game)
        .args(options)
        .arg("--json")
        .arg(&json);
    assert!(
        command
            .output()
            .expect("the program starts")
            .status
            .success(),
        "{command:?}"
    );
    let result: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&json).expect("the result can be read"))
            .expect("the result is JSON");
    result["duration_s"].as_f64().expect("a time")
        / result["run"]["wall_s"].as_f64().expect("a time")
}
