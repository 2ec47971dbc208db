//! Measures how fast games run: simulated time per second of one core, and their digests.
//!
//! Run `cargo run --release -p squall-arena --example speed -- [--seeds N] [--duration-s S]
//! [GAME.toml ...]`. The default is the shipped games that need no person and no real boat, with
//! seed 1. A pure optimisation leaves every digest unchanged.

mod core_time;

use core_time::core_time_s;
use primitives::SimTime;
use scenario::Scenario;
use std::path::{Path, PathBuf};

fn main() {
    let mut seeds = 1;
    let mut duration_s = f64::INFINITY;
    let mut games = Vec::new();
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        let mut number = || {
            args.next()
                .and_then(|value| value.parse().ok())
                .unwrap_or_else(|| panic!("{arg} N"))
        };
        match arg.as_str() {
            "--seeds" => seeds = number() as u64,
            "--duration-s" => duration_s = number(),
            _ => games.push(PathBuf::from(arg)),
        }
    }
    if games.is_empty() {
        games = shipped();
    }
    for path in &games {
        let scenario = scenario::load(path).unwrap_or_else(|e| panic!("{e}"));
        for seed in 1..=seeds {
            print_game(path, &scenario, seed, SimTime::from_s(duration_s.min(1e6)));
        }
    }
}

/// The games that need no person and no real boat.
fn shipped() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games");
    let entries = folder
        .read_dir()
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut games: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a folder that can be read").path())
        .collect();
    games.sort();
    games.retain(|path| {
        !["mixed_2v2", "person_2v2"]
            .iter()
            .any(|name| path.file_stem().is_some_and(|stem| stem == *name))
    });
    games
}

#[expect(clippy::print_stdout, reason = "this is a program")]
fn print_game(path: &Path, scenario: &Scenario, seed: u64, until: SimTime) {
    let scenario = Scenario {
        seed,
        ..scenario.clone()
    };
    let begun_s = core_time_s();
    let minds = agent::minds_of(&scenario);
    let outcome = arena::play_watched(&scenario, minds, seed, |contest| contest.now() < until);
    let outcome = outcome.unwrap_or_else(|e| panic!("{e}"));
    let taken_s = core_time_s() - begun_s;
    println!(
        "{:<20} seed {seed}  {:>5.1} s  {taken_s:>8.3} s of a core  {:>8.1} times real time  {}",
        path.file_stem().unwrap_or_default().to_string_lossy(),
        outcome.duration_s,
        outcome.duration_s / taken_s,
        outcome.digest
    );
}
