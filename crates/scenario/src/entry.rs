//! Strategies without a file: those that play a competition entry or a trained model.

use crate::built_in;
use crate::policy::{BYTES_MAX, PartialSpec, PolicyModel};
use primitives::input_file;
use std::path::{Path, PathBuf};

/// The extension of the path of such a strategy: `FOLDER.host` for the entry in `FOLDER`.
const HOST: &str = "host";
/// The extension for the model in `FILE.onnx`: `FILE.policy`.
const POLICY: &str = "policy";

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
            "no solution.py in {entry}, expected the folder of a competition entry"
        ));
    }
    // Append it, because a folder's own name may contain a dot.
    let mut path = folder.components().collect::<PathBuf>().into_os_string();
    path.push(format!(".{HOST}"));
    Ok(path.into())
}

/// The path of the strategy that plays a model: the file that training wrote next to it, if there
/// is one.
pub fn policy_path(model: &Path) -> PathBuf {
    let written = model.with_extension("toml");
    if written.is_file() {
        written
    } else {
        model.with_extension(POLICY)
    }
}

/// The strategy file that a path means: itself, the strategy of a model, or that of the entry in a
/// folder (`is_host`).
///
/// # Errors
/// If there is no such model or entry.
pub(super) fn strategy_file(path: &Path, is_host: bool) -> Result<PathBuf, String> {
    if is_host {
        return strategy_path(&path.to_string_lossy());
    }
    if path.extension().is_none_or(|end| end != "onnx") {
        return Ok(path.to_owned());
    }
    if path.is_file() || built_in(path).is_some() {
        return Ok(policy_path(path));
    }
    Err(format!("there is no file {}", path.display()))
}

/// Whether a path comes from [`strategy_path`] or [`policy_path`].
pub fn is_strategy_path(path: &Path) -> bool {
    let is_host = path.extension().is_some_and(|end| end == HOST);
    is_host && path.with_extension("").is_dir() || policy_strategy(path).is_some()
}

/// The content of the strategy that plays the model in `FILE.onnx`. For a model that chooses
/// options, it is based on the built-in strategy with these options.
fn policy_strategy(path: &Path) -> Option<String> {
    let model = path
        .extension()
        .filter(|end| *end == POLICY)
        .map(|_| path.with_extension("onnx"))?;
    let bytes = input_file::read(&model, BYTES_MAX).ok();
    let bytes = bytes.or_else(|| built_in(&model).map(<[u8]>::to_vec))?;
    let policy = PolicyModel::read("", &bytes, PartialSpec::default()).ok();
    let options = policy.and_then(|policy| policy.options().map(|names| format!("{names:?}")));
    let has_options = |name: &&str| {
        let text = built_in(Path::new(&format!("scenarios/strategies/{name}.toml")));
        let text = String::from_utf8_lossy(text.unwrap_or_default());
        options.as_ref().is_some_and(|names| text.contains(names))
    };
    let base = ["options", "primitives"].into_iter().find(has_options);
    Some(format!(
        "base = \"scenarios/strategies/{}.toml\"\n\n[behaviour.learned]\nmodel = {}\n",
        base.unwrap_or("policy"),
        serde_json::Value::from(model.file_name()?.to_string_lossy()),
    ))
}

/// The content of such a strategy; `None` for other paths.
pub(super) fn strategy(path: &Path) -> Option<String> {
    if let Some(text) = policy_strategy(path) {
        return Some(text);
    }
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
