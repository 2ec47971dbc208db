//! The built-in scenario files, and the resolution of file arguments: a path, or the name of a
//! file.

use crate::program;
use anyhow::{Result, anyhow, bail};
use include_dir::{Dir, include_dir};
use scenario::{Kind, built_in, did_you_mean, other_kind, set_built_in};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../scenarios");
/// The folder searched for named files, in the current folder and its parents.
const FOLDER: &str = "scenarios";

/// The kinds of files that the program knows.
static KINDS: OnceLock<&[Kind]> = OnceLock::new();

/// Makes the built-in files available where files on the disk are missing, and sets the kinds of
/// files by which a file of the wrong kind is recognised.
pub fn install(kinds: &'static [Kind]) {
    // An earlier caller installed the same kinds: a process runs one program.
    let _ = KINDS.set(kinds);
    set_built_in(|name| FILES.get_file(name).map(include_dir::File::contents));
}

fn kinds() -> &'static [Kind] {
    KINDS.get().copied().unwrap_or_default()
}

/// The contents of the built-in file of this name, if it exists.
pub fn contents(kind: Kind, name: &str) -> Option<&'static [u8]> {
    FILES.get_file(format!("{}/{name}.toml", kind.folder())).map(include_dir::File::contents)
}

/// Finds the file that an argument names: a path, or a name in `scenarios` here, in a parent
/// folder, or built in.
pub fn find(word: &str, kind: Kind) -> Result<PathBuf> {
    find_beside(word, kind, None)
}

/// The same, but searches the folder `beside` first for a name.
pub fn find_beside(word: &str, kind: Kind, beside: Option<&Path>) -> Result<PathBuf> {
    let given = PathBuf::from(word);
    if given.extension().is_some_and(|end| end == "mcap") {
        bail!("{word} is a recording, expected a {kind}; show it with squall replay, or analyse it with squall log");
    }
    if word.contains(['/', '\\']) || is_toml(&given) || given.is_file() {
        return match other_kind(kinds(), &given, kind) {
            Some(other) => bail!("{word} is a {other}, expected a {kind}{}", where_it_goes(other)),
            None if given.exists() || built_in(&given).is_some() => Ok(given),
            None => {
                let name = name_of(&given).unwrap_or_default();
                let there =
                    names_in(given.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new(".")));
                let there: Vec<&str> = there.iter().map(String::as_str).collect();
                if !word.contains('/') && contents(kind, &name).is_some() {
                    bail!("there is no file {word}, but there is a built-in {kind} of the name {name}");
                }
                bail!("there is no file {word}{}", did_you_mean(&name, &there))
            }
        };
    }
    let here = std::env::current_dir().unwrap_or_default();
    let above = here.ancestors().map(|folder| folder.join(FOLDER).join(kind.folder()));
    let folders: Vec<PathBuf> = beside.map(Path::to_owned).into_iter().chain(above).collect();
    let file = format!("{word}.toml");
    if let Some(path) = folders.iter().map(|folder| folder.join(&file)).find(|path| path.is_file()) {
        // As a user would type it, so that the printed path can be read again.
        return Ok(path.strip_prefix(&here).map(Path::to_owned).unwrap_or(path));
    }
    let inside = Path::new(FOLDER).join(kind.folder()).join(file);
    if built_in(&inside).is_some() { Ok(inside) } else { Err(unknown(word, kind, &folders)) }
}

fn unknown(word: &str, kind: Kind, folders: &[PathBuf]) -> anyhow::Error {
    let mut others = kinds().iter().copied().filter(|other| *other != kind);
    if let Some(other) = others.find(|other| names(*other).contains(word)) {
        return anyhow!("there is no {kind} {word}, but there is a {other} of that name{}", where_it_goes(other));
    }
    let mut known = names(kind);
    known.extend(folders.iter().flat_map(|folder| names_in(folder)));
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let guess = did_you_mean(word, &known);
    let list =
        if guess.is_empty() { format!(", expected the path of a file or one of {}", known.join(", ")) } else { guess };
    anyhow!("there is no {kind} {word}{list}")
}

/// The places where a file of a kind is accepted.
fn where_it_goes(kind: Kind) -> String {
    let place = match kind.name() {
        "game" => "play it with squall run",
        "strategy" => "use it with squall run GAME --blue or --red",
        "sea" => "use it with squall run GAME --sea",
        "field" => "use it with squall run GAME --field",
        "tournament" => "play it with squall tournament",
        "sweep" => "run it with squall sweep",
        "training" => "run it with squall train",
        "gateway" => "use it with {gateway} surveyor --config",
        _ => return String::new(),
    };
    format!("; {}", program::text(place))
}

/// The names of the built-in files of a kind.
pub fn names(kind: Kind) -> BTreeSet<String> {
    let files = FILES.get_dir(kind.folder()).into_iter().flat_map(Dir::files);
    files.filter_map(|file| name_of(file.path())).collect()
}

fn names_in(folder: &Path) -> BTreeSet<String> {
    let files = std::fs::read_dir(folder).into_iter().flatten().filter_map(std::result::Result::ok);
    files.filter_map(|file| name_of(&file.path())).collect()
}

fn name_of(path: &Path) -> Option<String> {
    is_toml(path).then(|| path.file_stem()?.to_str().map(str::to_owned))?
}

/// Whether the name of a file ends as those of scenario files, on Windows also with capitals.
pub fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}

/// Parses an argument that names an existing file or folder of any kind.
///
/// # Errors
/// If there is none; suggests a similar name.
pub fn existing(word: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(word);
    if path.exists() {
        return Ok(path);
    }
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).into_iter().flatten().filter_map(std::result::Result::ok);
    let there: Vec<String> = files.map(|file| file.file_name().to_string_lossy().into_owned()).collect();
    let there: Vec<&str> = there.iter().map(String::as_str).collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Err(format!("there is no file {word}{}", did_you_mean(&name, &there)))
}

/// Parses an argument that names a file of this kind.
pub fn file_of(kind: Kind) -> impl Fn(&str) -> Result<PathBuf> + Clone {
    move |word| find(word, kind)
}
