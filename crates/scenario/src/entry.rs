//! Strategies without a file: those that run a competition entry.

use std::path::{Path, PathBuf};

/// The extension of the path of such a strategy: `FOLDER.host` for the entry in `FOLDER`.
const HOST: &str = "host";

/// The path of the strategy that runs the entry in a folder, or the entry with this `solution.py`.
///
/// # Errors
/// If there is no such folder or file.
pub fn strategy_path(entry: &str) -> Result<PathBuf, String> {
    let given = Path::new(entry);
    let folder = if given.is_file() {
        given.parent().unwrap_or(given)
    } else {
        given
    };
    let folder = std::path::absolute(folder).map_err(|error| error.to_string())?;
    if !folder.join("solution.py").is_file() {
        return Err(format!(
            "there is no solution.py in {entry}, expected the folder of an entry"
        ));
    }
    // Append it, because a folder's own name may contain a dot.
    let mut path = folder.components().collect::<PathBuf>().into_os_string();
    path.push(format!(".{HOST}"));
    Ok(path.into())
}

/// Whether a path was made by [`strategy_path`].
pub fn is_strategy_path(path: &Path) -> bool {
    path.extension().is_some_and(|end| end == HOST) && path.with_extension("").is_dir()
}

/// The content of such a strategy; `None` for other paths.
pub(super) fn strategy(path: &Path) -> Option<String> {
    let folder = path.file_stem().filter(|_| is_strategy_path(path))?;
    let folder = serde_json::Value::from(folder.to_string_lossy());
    Some(format!(
        "base = \"scenarios/strategies/policy.toml\"\nabout = \"plays as the competition entry {}\"\n\n\
         [behaviour.learned]\nhost = {folder}\ndirect = true\n",
        folder
            .as_str()
            .unwrap_or_default()
            .replace(['"', '\\'], "?"),
    ))
}
