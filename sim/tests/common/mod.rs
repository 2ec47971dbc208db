//! Scenarios for tests, written as a user would write them.
#![allow(dead_code, reason = "each test file uses its part")]

use game::Scenario;
use std::path::{Path, PathBuf};

/// The shipped scenarios.
pub fn scenarios() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios")
}

/// A shipped game.
pub fn shipped(game: &str) -> Scenario {
    game::scenario::load(&scenarios().join("games").join(game)).unwrap_or_else(|e| panic!("{e}"))
}

/// A game written here; paths in it are relative to `scenarios/games`.
pub fn written(toml: &str) -> Scenario {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let root = scenarios().canonicalize().expect("the scenarios are there");
    let path = dir.path().join("test.toml");
    std::fs::write(&path, toml.replace("../", &format!("{}/", root.display()))).expect("a file can be written");
    game::scenario::load(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// One boat of this kind a side, idle, on open salt water, blue at its half point.
pub fn alone(boat: &str, sea: &str) -> Scenario {
    written(&format!(
        r#"
field = "../fields/open_800x400.toml"
rules = "../rules/aquaticus_2023.toml"
sea = "../seas/{sea}.toml"
boat = "../boats/{boat}.toml"
[[team]]
name = "blue"
strategy = "../strategies/idle.toml"
[[team]]
name = "red"
strategy = "../strategies/idle.toml"
[[vehicle]]
name = "blue_one"
team = "blue"
at = "CH"
heading_deg = 0
[[vehicle]]
name = "red_one"
team = "red"
at = "CF"
"#
    ))
}
