//! Finds and opens a recording given by the user, and reports damage in it.

use crate::scenario_files::existing;
use crate::terminal;
use anyhow::{Context, Error, Result, anyhow, bail, ensure};
use recording::{Bag, Recording, RecordingError, alog, logs};
use std::cmp::Reverse;
use std::path::{Path, PathBuf};

/// The folder in which games are recorded by default.
pub const FOLDER: &str = "runs";

/// The game whose rules and boat are used for logs of an unknown game.
pub const UNKNOWN_GAME: &str = "scenarios/games/pav01_vs_pav01.toml";

/// The recordings of games in a folder, newest first.
pub fn runs(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(Result::ok)
        .map(|file| file.path());
    let is_game = |path: &PathBuf| {
        path.extension().is_some_and(|end| end == "mcap") && !stem(path).starts_with("gateway-")
    };
    let mut runs: Vec<PathBuf> = files.filter(is_game).collect();
    runs.sort_by_cached_key(|path| {
        Reverse((
            path.metadata().and_then(|file| file.modified()).ok(),
            path.clone(),
        ))
    });
    runs
}

/// The name of a recording: its file name without the extension.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// Parses an argument that names a recording: a path, or part of a name in `runs`, which selects
/// the newest match.
pub fn named(word: &str) -> Result<PathBuf> {
    let path = Path::new(word);
    if word.contains(['/', '\\']) || path.extension().is_some() || path.exists() {
        return existing(word).map_err(Error::msg);
    }
    let found = runs(Path::new(FOLDER))
        .into_iter()
        .find(|path| stem(path).contains(word));
    found.ok_or_else(|| {
        anyhow!("no recording matches {word:?} in {FOLDER}/; list the recordings with: squall runs")
    })
}

/// Checks that the recording contains the inputs of its game, so that the game can be rerun.
pub fn check_inputs(recording: &Recording) -> Result<()> {
    ensure!(
        recording.header().info.pace != logs::PACE,
        "a recording made from logs does not contain the inputs of a game"
    );
    Ok(())
}

/// The given recording, or the newest in `runs`, whose name is then printed.
pub fn or_newest(given: Option<&Path>) -> Result<PathBuf> {
    if let Some(path) = given {
        return Ok(path.to_owned());
    }
    let newest = runs(Path::new(FOLDER)).into_iter().next();
    let newest = newest.with_context(|| none_in(Path::new(FOLDER)))?;
    terminal::remark(&format!("using the newest recording: {}", newest.display()));
    Ok(newest)
}

/// Advice for a folder without recordings.
pub fn none_in(folder: &Path) -> String {
    format!(
        "no recordings in {}/; record a game, for example with: squall run strategy_4_vs_3",
        folder.display()
    )
}

/// Opens the recording of a game; errors name the purpose `to`, for example "replay".
pub fn open(file: &Path, to: &str) -> Result<Recording> {
    let bag = open_any(file, to)?;
    Recording::of_bag(bag).with_context(|| format!("cannot {to} {}", file.display()))
}

/// Opens a recording of any kind, or the MOOS logs of a game: one, or all in a folder. A game file
/// in the folder of the logs identifies the game.
pub fn open_any(file: &Path, to: &str) -> Result<Bag> {
    let opened = if file.is_dir() || alog::is_log(file) {
        let Logs { files, game } = logs(file)?;
        let base = game.as_deref();
        let base = base.unwrap_or(Path::new(UNKNOWN_GAME));
        alog::read(&files, scenario::load(base)?, game.is_some())
    } else {
        Bag::open(file)
    };
    let bag = opened.map_err(|error| match error {
        // These errors already name the file.
        RecordingError::File { .. } | RecordingError::Log(_) => Error::new(error),
        error => Error::new(error).context(format!("cannot {to} {}", file.display())),
    })?;
    if let [first, ..] = &bag.damage[..] {
        let places = bag.damage.len();
        let of = if places == 1 {
            String::new()
        } else {
            format!(" (the first of {places} damaged ranges)")
        };
        let place = format!("bytes {} to {}{of}", first.start, first.end - 1);
        let file = file.display();
        terminal::remark(&format!(
            "{file} is damaged: {place} changed after they were written; data below may be wrong or missing"
        ));
    }
    Ok(bag)
}

/// MOOS logs of a game, and the game file in their folder.
struct Logs {
    files: Vec<PathBuf>,
    game: Option<PathBuf>,
}

/// Finds MOOS logs: a file, or all logs in a folder and its subfolders, such as those of a mission.
fn logs(path: &Path) -> Result<Logs> {
    let folder = match path.parent() {
        _ if path.is_dir() => path,
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let listed = |folder: &Path| {
        let files = std::fs::read_dir(folder).into_iter().flatten();
        files.filter_map(Result::ok).map(|file| file.path())
    };
    let is_game = |file: &PathBuf| file.extension().is_some_and(|end| end == "toml");
    // If there are several, take the first by name: folders are listed in no particular order.
    let game = listed(folder).filter(is_game).min();
    let mut files: Vec<PathBuf> = if path.is_dir() {
        listed(path)
            .chain(listed(path).flat_map(|inner| listed(&inner)))
            .collect()
    } else {
        vec![path.to_owned()]
    };
    files.retain(|file| alog::is_log(file));
    files.sort();
    if files.is_empty() {
        bail!(
            "{} contains no MOOS logs, which begin with a line of %",
            path.display()
        );
    }
    if game.is_none() {
        terminal::remark("no game file beside the logs: field, flags and rules are unknown");
    }
    Ok(Logs { files, game })
}
