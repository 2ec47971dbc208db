//! The built-in scenario files, and the resolution of file arguments: a path, or the name of a
//! file.

use crate::{program, terminal};
use anyhow::{Result, anyhow, bail};
use include_dir::{Dir, include_dir};
use scenario::{Kind, built_in, did_you_mean, entry, other_kind, set_built_in};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../scenarios");
/// The folder searched for names, in the current folder and its parents.
const FOLDER: &str = "scenarios";
/// The extension of scenario files.
const TOML: &str = "toml";
/// The folder of policies within `scenarios`, and their file extension.
const POLICIES: (&str, &str) = ("policies", "onnx");

/// The kinds of files that the program supports.
static KINDS: OnceLock<&[Kind]> = OnceLock::new();

/// Makes the built-in files available where files on disk are missing, and registers the known
/// kinds, so that a file of the wrong kind is recognised.
pub fn install(kinds: &'static [Kind]) {
    // An earlier caller installed the same kinds: a process runs only one program.
    let _ = KINDS.set(kinds);
    set_built_in(
        |name| FILES.get_file(name).map(include_dir::File::contents),
        announce,
    );
}

/// Announces, once per path, that a file on disk overrides a built-in one. Child processes leave
/// this to their parent.
pub fn announce(path: &Path) {
    static ANNOUNCED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let is_child = std::env::args_os().any(|word| word == "--for-parent");
    if !is_child
        && ANNOUNCED
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .insert(path.to_owned())
    {
        let mut parts = path
            .components()
            .rev()
            .map(|part| part.as_os_str().to_string_lossy());
        let [name, folder] = [parts.next(), parts.next()].map(Option::unwrap_or_default);
        terminal::remark(&format!(
            "{} overrides the built-in {folder}/{name}",
            path.display()
        ));
    }
}

fn kinds() -> &'static [Kind] {
    KINDS.get().copied().unwrap_or_default()
}

/// The contents of the built-in file of this name, if it exists.
pub fn contents(kind: Kind, name: &str) -> Option<&'static [u8]> {
    FILES
        .get_file(format!("{}/{name}.toml", kind.folder()))
        .map(include_dir::File::contents)
}

/// Finds the file that an argument names: a path, or a name in `scenarios` in the current folder,
/// in a parent folder, or built in.
pub fn find(word: &str, kind: Kind) -> Result<PathBuf> {
    find_beside(word, kind, None)
}

/// Like [`find`], but first searches the folder `beside` for a name.
pub fn find_beside(word: &str, kind: Kind, beside: Option<&Path>) -> Result<PathBuf> {
    let given = PathBuf::from(word);
    if kind == Kind::STRATEGY {
        if let Some(entry) = word.strip_prefix("host:") {
            return entry::strategy_path(entry).map_err(anyhow::Error::msg);
        }
        if entry::is_strategy_path(&given) {
            return Ok(given);
        }
        if given.extension().is_some_and(|end| end == POLICIES.1) {
            return find_policy(word).map(|model| entry::policy_path(&model));
        }
    }
    if given.extension().is_some_and(|end| end == "mcap") {
        bail!(
            "{word} is a recording, expected a {kind}; show it with squall replay, or analyse it with squall log"
        );
    }
    if !is_path(word, TOML) {
        return located(word, (kind.folder(), TOML), beside)
            .ok_or_else(|| unknown(word, kind, beside));
    }
    match other_kind(kinds(), &given, kind) {
        Some(other) => bail!(
            "{word} is a {other}, expected a {kind}{}",
            where_it_goes(other)
        ),
        None if given.exists() || built_in(&given).is_some() => Ok(given),
        None => {
            let name = name_of(&given, TOML).unwrap_or_default();
            let folder = given
                .parent()
                .filter(|folder| *folder != Path::new(""))
                .unwrap_or(Path::new("."));
            let there = names_in(folder, TOML);
            let there: Vec<&str> = there.iter().map(String::as_str).collect();
            if !word.contains('/') && contents(kind, &name).is_some() {
                bail!("there is no file {word}, but there is a built-in {kind} named {name}");
            }
            bail!("there is no file {word}{}", did_you_mean(&name, &there))
        }
    }
}

/// Finds the files that an argument names: a path, or the files of all kinds with this name.
pub fn find_any(word: &str) -> Result<Vec<PathBuf>> {
    if is_path(word, TOML) {
        return Ok(vec![word.into()]);
    }
    let found = kinds()
        .iter()
        .filter_map(|kind| located(word, (kind.folder(), TOML), None));
    let found: Vec<PathBuf> = found.collect();
    if found.is_empty() {
        let known: BTreeSet<String> = kinds().iter().flat_map(|kind| all_names(*kind)).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        bail!(
            "no scenario file named {word:?}{}; list all files with: squall files",
            did_you_mean(word, &known)
        );
    }
    Ok(found)
}

/// Finds the policy that an argument names: a path, or a name in `scenarios/policies`.
pub fn find_policy(word: &str) -> Result<PathBuf> {
    if is_path(word, POLICIES.1) {
        if built_in(Path::new(word)).is_some() {
            return Ok(word.into());
        }
        return existing(word).map_err(anyhow::Error::msg);
    }
    located(word, POLICIES, None).ok_or_else(|| {
        let known = policies();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        anyhow!(
            "no policy named {word:?}, expected the path of a file or one of {}",
            known.join(", ")
        )
    })
}

/// Whether an argument is a path, not a name.
fn is_path(word: &str, extension: &str) -> bool {
    let path = Path::new(word);
    let has_extension = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case(extension));
    word.contains(['/', '\\']) || has_extension || path.is_file()
}

/// The folders on disk in which a name is looked up, nearest first.
fn folders(folder: &str, beside: Option<&Path>) -> Vec<PathBuf> {
    let here = std::env::current_dir().unwrap_or_default();
    let above = here
        .ancestors()
        .map(|above| above.join(FOLDER).join(folder));
    beside
        .map(Path::to_owned)
        .into_iter()
        .chain(above)
        .collect()
}

/// The file of this name in a folder of `scenarios`, on disk or built in.
fn located(
    name: &str,
    (folder, extension): (&str, &str),
    beside: Option<&Path>,
) -> Option<PathBuf> {
    let file = format!("{name}.{extension}");
    let mut paths = folders(folder, beside)
        .into_iter()
        .map(|folder| folder.join(&file));
    if let Some(path) = paths.find(|path| path.is_file()) {
        // Print the path as a user would type it, so that it can be used in a command.
        let here = std::env::current_dir().unwrap_or_default();
        return Some(path.strip_prefix(&here).map(Path::to_owned).unwrap_or(path));
    }
    Some(Path::new(FOLDER).join(folder).join(file)).filter(|inside| built_in(inside).is_some())
}

fn unknown(word: &str, kind: Kind, beside: Option<&Path>) -> anyhow::Error {
    let mut others = kinds().iter().copied().filter(|other| *other != kind);
    if let Some(other) = others.find(|other| all_names(*other).contains(word)) {
        return anyhow!(
            "no {kind} named {word:?}, but there is a {other} with that name{}",
            where_it_goes(other)
        );
    }
    let mut known = names(kind);
    known.extend(
        folders(kind.folder(), beside)
            .iter()
            .flat_map(|folder| names_in(folder, TOML)),
    );
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let guess = did_you_mean(word, &known);
    let list = if guess.is_empty() {
        format!(
            ", expected the path of a file or one of {}",
            known.join(", ")
        )
    } else {
        guess
    };
    anyhow!("no {kind} named {word:?}{list}")
}

/// Advice on where a file of the given kind can be used.
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

/// The names of the built-in files of the given kind.
pub fn names(kind: Kind) -> BTreeSet<String> {
    built_in_names(kind.folder(), TOML)
}

/// The names of the built-in policies.
pub fn policies() -> BTreeSet<String> {
    built_in_names(POLICIES.0, POLICIES.1)
}

fn built_in_names(folder: &str, extension: &str) -> BTreeSet<String> {
    let files = FILES.get_dir(folder).into_iter().flat_map(Dir::files);
    files
        .filter_map(|file| name_of(file.path(), extension))
        .collect()
}

/// The user's own files of the given kind by name: files on disk that are not copies of built-in
/// ones.
pub fn own(kind: Kind) -> BTreeMap<String, PathBuf> {
    let names = folders(kind.folder(), None)
        .into_iter()
        .flat_map(|folder| names_in(&folder, TOML));
    let found = names.filter_map(|name| Some((located(&name, (kind.folder(), TOML), None)?, name)));
    let is_own = |(path, name): &(PathBuf, String)| {
        std::fs::read(path).ok().as_deref() != contents(kind, name)
    };
    found
        .filter(is_own)
        .map(|(path, name)| (name, path))
        .collect()
}

/// The names of all files of the given kind, on disk and built in.
pub fn all_names(kind: Kind) -> BTreeSet<String> {
    own(kind).into_keys().chain(names(kind)).collect()
}

fn names_in(folder: &Path, extension: &str) -> BTreeSet<String> {
    let files = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(std::result::Result::ok);
    files
        .filter_map(|file| name_of(&file.path(), extension))
        .collect()
}

fn name_of(path: &Path, extension: &str) -> Option<String> {
    let is_wanted = path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case(extension));
    is_wanted.then(|| path.file_stem()?.to_str().map(str::to_owned))?
}

/// Whether a file has the extension `.toml`, in any case.
pub fn is_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("toml"))
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
    let folder = path
        .parent()
        .filter(|folder| *folder != Path::new(""))
        .unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(std::result::Result::ok);
    let there: Vec<String> = files
        .map(|file| file.file_name().to_string_lossy().into_owned())
        .collect();
    let there: Vec<&str> = there.iter().map(String::as_str).collect();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Err(format!(
        "there is no file {word}{}",
        did_you_mean(&name, &there)
    ))
}

/// Parses an argument that names a file of this kind.
pub fn file_of(kind: Kind) -> impl Fn(&str) -> Result<PathBuf> + Clone {
    move |word| find(word, kind)
}
