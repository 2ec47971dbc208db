//! Loads games from files and plays them.

use agent::MindRunner;
use scenario::{Outcome, Scenario};
use sim::Contest;
use std::path::{Path, PathBuf};

/// A shipped file.
pub(crate) fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios")
        .join(path)
}

/// The scenario of `game.toml` among these files, in which `SCENARIOS` is replaced with the folder
/// of the shipped files.
pub(crate) fn loaded(files: &[(&str, impl AsRef<str>)]) -> Scenario {
    let folder = tempfile::tempdir().expect("a folder for files");
    for (name, text) in files {
        let text = text
            .as_ref()
            .replace("SCENARIOS", &shipped("").display().to_string());
        std::fs::write(folder.path().join(name), text).expect("a file in it");
    }
    scenario::load(&folder.path().join("game.toml")).unwrap_or_else(|e| panic!("{e}"))
}

/// The outcome of the game with its own seed.
pub(crate) fn played(scenario: &Scenario) -> Outcome {
    arena::play(scenario, agent::minds_of(scenario), scenario.seed)
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Plays a game, and passes the contest and the minds to `shown` after every decision, until it
/// returns `false`.
pub(crate) fn watch(scenario: &Scenario, mut shown: impl FnMut(&Contest, &MindRunner) -> bool) {
    let mut contest = Contest::new(scenario, 1).unwrap_or_else(|e| panic!("{e}"));
    let mut runner = arena::runner_of(agent::minds_of(scenario));
    loop {
        arena::decide(&mut contest, &mut runner);
        contest.advance();
        if !shown(&contest, &runner) || contest.is_over() {
            return;
        }
    }
}
