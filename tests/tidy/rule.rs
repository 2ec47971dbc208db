//! The rules, each of which finds its breaches in a tree. These files are checked too, so words
//! that must not occur are joined from halves.

use crate::language::{language, links};
use crate::shown_by::shown_by;
use crate::text::{is_path, manifest_entries, names, quoted};
use crate::tree::Tree;

/// Maximum length of a hand-written file, lines.
pub(crate) const LINES_MAX: usize = 650;

/// The allowed dependencies of each of our crates, in any section, including planned folders.
const MAY_IMPORT: [(&str, &[&str]); 26] = [
    ("onnx", &[]),
    ("primitives", &[]),
    // `scenario` for tests only: scenes are judged by the shipped rules files.
    ("rules", &["primitives", "scenario"]),
    ("scenario", &["onnx", "primitives", "rules"]),
    ("messages", &["primitives", "rules", "scenario"]),
    ("bus", &["primitives", "scenario", "messages"]),
    // For tests only: not linked by any program.
    (
        "simulated_network",
        &["primitives", "scenario", "messages", "bus"],
    ),
    (
        "recording",
        &["primitives", "rules", "scenario", "messages"],
    ),
    (
        "sim",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "recording",
        ],
    ),
    (
        "agent",
        &["onnx", "primitives", "rules", "scenario", "messages", "bus"],
    ),
    (
        "gateway",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "recording",
            "agent",
        ],
    ),
    (
        "command_line",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "recording",
        ],
    ),
    // No web server, player or trainer: the program that drives a boat is reviewed separately.
    (
        "gateway/cli",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "recording",
            "gateway",
            "command-line",
        ],
    ),
    ("gateway/crosscheck", &["primitives", "gateway"]),
    ("fuzz", ALL),
    // `analysis` for examples: statistics of games in one process.
    (
        "arena",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "sim",
            "agent",
            "analysis",
        ],
    ),
    (
        "analysis",
        &["primitives", "rules", "scenario", "messages", "recording"],
    ),
    (
        "trial",
        &["primitives", "rules", "scenario", "messages", "sim"],
    ),
    // `gateway` for the protocols and the map of the field, `trial` for its tables.
    (
        "import",
        &[
            "primitives",
            "scenario",
            "messages",
            "recording",
            "gateway",
            "trial",
        ],
    ),
    // `analysis` for the curves below the timeline of a replay.
    (
        "shore",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "recording",
            "analysis",
        ],
    ),
    // `gateway` for the map of the field, `analysis` for the text of node reports.
    (
        "moos",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "agent",
            "gateway",
            "analysis",
        ],
    ),
    // `gateway` only for latitudes and longitudes of the field.
    (
        "ros",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "bus",
            "agent",
            "gateway",
        ],
    ),
    (
        "learn",
        &[
            "onnx",
            "primitives",
            "rules",
            "scenario",
            "messages",
            "sim",
            "agent",
            "arena",
            "recording",
        ],
    ),
    (
        "experiment",
        &[
            "primitives",
            "rules",
            "scenario",
            "messages",
            "sim",
            "agent",
            "analysis",
            "arena",
        ],
    ),
    ("python", &["scenario", "experiment", "learn"]),
    ("", ALL),
];

const ALL: &[&str] = &["all of the workspace"];

/// Crates outside the workspace, which none may import.
const OUTSIDE: [&str; 3] = ["fuzz", "gateway-crosscheck", "python"];

/// Crates whose network shell, `node`, is the only part that may use `bus`; everything else in them
/// is pure.
const SHELLS: [&str; 3] = ["sim", "agent", "gateway"];

/// The file with the readers' questions.
const QUESTIONS: &str = "tests/tidy/questions.txt";

/// A breach of a rule: `file:line: what is wrong, what is allowed`.
pub(crate) type Breaches = Vec<String>;

/// A rule: its name and the function that finds its breaches.
type Rule = (&'static str, fn(&Tree) -> Breaches);

pub(crate) const RULES: [Rule; 17] = [
    ("crates depend only on what lies below them", dependencies),
    ("only node shells use the bus", bus_in_shells),
    ("only bus names zenoh", zenoh_in_bus),
    ("only messages::topic spells a key", keys_in_topic),
    ("files are short and say what they are", files_in_shape),
    ("libraries do not print", quiet_libraries),
    ("nothing is left undone", nothing_undone),
    ("no unwrap outside of tests", no_unwrap),
    ("documents for developers name what exists", architecture),
    ("readers find answers where they look first", questions),
    ("the glossary's terms are in the code", glossary),
    (
        "one clippy.toml, and every crate under the workspace's lints",
        lints,
    ),
    ("CHANGELOG.md has this version", changelog),
    ("every dependency has its reason in Cargo.toml", reasons),
    ("tables of what is tested name tests that exist", shown_by),
    ("documents are in plain English", language),
    ("links in documents lead somewhere", links),
];

fn dependencies(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.manifests() {
        let folder = path
            .strip_suffix("Cargo.toml")
            .unwrap_or(path)
            .trim_end_matches('/');
        let folder = folder.strip_prefix("crates/").unwrap_or(folder);
        let Some((_, allowed)) = MAY_IMPORT.iter().find(|(name, _)| *name == folder) else {
            breaches.push(format!(
                "{path}:1: no rule for this crate: state in tests/tidy/rule.rs what it may import"
            ));
            continue;
        };
        // The root only offers these dependencies; no crate imports them yet.
        let entries = manifest_entries(text)
            .into_iter()
            .filter(|(_, section, _)| section != "workspace.dependencies");
        for (number, section, name) in entries {
            let place = format!("{path}:{number}");
            let is_known = MAY_IMPORT
                .iter()
                .any(|(folder, _)| dependency(folder) == name);
            let is_allowed = match *allowed == ALL {
                true => is_known && !OUTSIDE.contains(&name.as_str()),
                false => allowed.contains(&name.as_str()),
            };
            if (is_known || name.starts_with("squall")) && !is_allowed {
                let allowed = if allowed.is_empty() {
                    "nothing of ours".to_owned()
                } else {
                    allowed.join(", ")
                };
                breaches.push(format!(
                    "{place}: {folder} depends on {name}, allowed: {allowed}"
                ));
            }
            let baseline = folder.is_empty() && section == "dev-dependencies";
            if name.starts_with("zenoh") && folder != "bus" && !baseline {
                breaches
                    .push(format!("{place}: {name} belongs to bus (and to the root's dev-dependencies, for benches)"));
            }
            let line = text.lines().nth(number - 1).unwrap_or_default();
            if name == "bus" && SHELLS.contains(&folder) && !line.contains("optional = true") {
                breaches.push(format!(
                    "{place}: bus must be optional here (feature `net`): arena links no network"
                ));
            }
        }
    }
    breaches
}

/// The name of a folder's crate in manifests: `gateway-cli` for `gateway/cli`.
fn dependency(folder: &str) -> String {
    folder.replace(['/', '_'], "-")
}

fn bus_in_shells(tree: &Tree) -> Breaches {
    let in_shell = |path: &str, krate: &str| {
        path.starts_with(&format!("{krate}/src/node/")) || path == format!("{krate}/src/node.rs")
    };
    let is_core = |path: &str| {
        SHELLS
            .iter()
            .any(|k| path.starts_with(&format!("{k}/src/")) && !in_shell(path, k))
    };
    tree.find(
        is_core,
        |line| names(line, "bus::"),
        "bus is used in a pure core; only its node may",
    )
}

fn zenoh_in_bus(tree: &Tree) -> Breaches {
    // The intruders in these tests use zenoh's own API.
    let allowed = ["crates/bus/src/", "benches/", "tests/adversary/"];
    let elsewhere = |path: &str| !allowed.iter().any(|folder| path.starts_with(folder));
    let word = concat!("zen", "oh::");
    tree.find(
        elsewhere,
        |line| names(line, word),
        "zenoh is named; allowed in crates/bus/src, benches and tests/adversary",
    )
}

fn keys_in_topic(tree: &Tree) -> Breaches {
    let elsewhere = |path: &str| path != "crates/messages/src/topic.rs";
    let key = concat!("\"squ", "all/");
    tree.find(
        elsewhere,
        |line| line.contains(key),
        "a key is spelled out; allowed in crates/messages/src/topic.rs",
    )
}

fn files_in_shape(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.sources() {
        let lines = text.lines().count();
        if lines > LINES_MAX {
            breaches
                .push(format!("{path}:{lines}: {lines} lines, allowed: {LINES_MAX}; which part should have its own \
                    file?"));
        }
        if !text.starts_with("//! ") {
            breaches.push(format!(
                "{path}:1: must begin with `//! ` and a sentence that says what the file is"
            ));
        }
    }
    breaches
}

fn quiet_libraries(tree: &Tree) -> Breaches {
    let library = |path: &str| {
        path.contains("/src/") && !path.starts_with("src/") && path != "crates/fuzz/src/main.rs"
    };
    let prints = |line: &str| {
        ["print!", "println!", "eprint!", "eprintln!"]
            .iter()
            .any(|word| names(line, word))
    };
    let mut breaches = tree.find(
        library,
        prints,
        "a library prints; allowed in src/, tests and benches",
    );
    breaches.extend(tree.find(
        |_| true,
        |line| names(line, concat!("db", "g!")),
        "left from debugging",
    ));
    breaches
}

fn nothing_undone(tree: &Tree) -> Breaches {
    let words = [concat!("to", "do!"), concat!("unimpl", "emented!")];
    let mut breaches = tree.find(
        |_| true,
        |line| words.iter().any(|w| names(line, w)),
        "code that is not there yet",
    );
    let marks = [concat!("TO", "DO"), concat!("FIX", "ME")];
    for (path, text) in tree.sources() {
        for (number, line) in text.lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark)) {
                breaches.push(format!(
                    "{path}:{}: a note to self; do it, or write an issue: {}",
                    number + 1,
                    line.trim()
                ));
            }
        }
    }
    breaches
}

fn no_unwrap(tree: &Tree) -> Breaches {
    let is_test = |path: &str| {
        path.split('/')
            .any(|folder| folder == "tests" || folder == "benches")
    };
    let call = concat!(".unw", "rap()");
    tree.find(
        |path| !is_test(path),
        |line| line.contains(call),
        "unwrap; allowed in tests and benches. Elsewhere handle it, or `expect` the reason why it cannot fail",
    )
}

/// Whether a document is for developers and therefore names source files.
fn is_for_developers(path: &str) -> bool {
    ["ARCHITECTURE.md", "docs/estop.md"].contains(&path) || path.starts_with("docs/decisions/")
}

fn architecture(tree: &Tree) -> Breaches {
    let documents: Vec<_> = tree
        .files
        .iter()
        .filter(|(path, _)| is_for_developers(path))
        .collect();
    if !documents.iter().any(|(path, _)| *path == "ARCHITECTURE.md") {
        return vec!["ARCHITECTURE.md: is missing".to_owned()];
    }
    let missing = |document: &str, (number, path): (usize, String)| {
        (!tree.has(&path)).then(|| format!("{document}:{number}: `{path}` does not exist"))
    };
    let paths_in = |text: &str| {
        quoted(text)
            .filter(|(_, word)| is_path(word))
            .collect::<Vec<_>>()
    };
    let breaches = |(document, text): (&String, &String)| {
        paths_in(text)
            .into_iter()
            .filter_map(|path| missing(document, path))
            .collect::<Breaches>()
    };
    documents.into_iter().flat_map(breaches).collect()
}

/// Readers' questions, each with the file in which readers look first and a string that it must
/// contain. This detects a file that is renamed or no longer covers its subject.
fn questions(tree: &Tree) -> Breaches {
    let Some(text) = tree.text(QUESTIONS) else {
        return vec![format!("{QUESTIONS}: is missing")];
    };
    let guesses = text
        .lines()
        .enumerate()
        .filter(|(_, line)| line.starts_with(' '));
    let wrong = |(i, line): (usize, &str)| {
        let Some((path, item)) = line.trim().split_once(": ") else {
            return Some(format!(
                "{QUESTIONS}:{}: expected `file: text`, found {:?}",
                i + 1,
                line.trim()
            ));
        };
        match tree.text(path) {
            None => Some(format!("{QUESTIONS}:{}: {path} does not exist", i + 1)),
            Some(file) if file.contains(item) => None,
            Some(_) => Some(format!(
                "{QUESTIONS}:{}: {path} does not contain {item:?}",
                i + 1
            )),
        }
    };
    guesses.filter_map(wrong).collect()
}

/// The terms are the first cells of the table below the heading `Glossary`. Code spells `set-point`
/// as `set_point` or `SetPoint`, so case and separators do not count.
fn glossary(tree: &Tree) -> Breaches {
    let text = tree
        .files
        .get("docs/glossary.md")
        .map_or("", String::as_str);
    let lines = text
        .lines()
        .enumerate()
        .skip_while(|(_, line)| *line != "## Glossary")
        .skip(1);
    let rows = lines
        .take_while(|(_, line)| !line.starts_with("## "))
        .filter(|(_, line)| line.starts_with('|'));
    // Skip the heading of the table and the line below it.
    let terms = rows
        .skip(2)
        .filter_map(|(i, line)| Some((i + 1, line.split('|').nth(1)?.trim())));
    let plain = |text: &str| text.to_lowercase().replace(['_', '-', ' ', '`'], "");
    let code: String = tree
        .sources()
        .filter(|(path, _)| path.contains("src/"))
        .map(|(_, text)| plain(text))
        .collect();
    let found: Vec<(usize, &str)> = terms.collect();
    if found.is_empty() {
        return vec!["docs/glossary.md:1: has no table below a heading `## Glossary`".to_owned()];
    }
    let missing = found
        .into_iter()
        .filter(|(_, term)| !code.contains(&plain(term)));
    missing
        .map(|(number, term)| format!("docs/glossary.md:{number}: no code has the term {term:?}"))
        .collect()
}

fn lints(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for path in tree.files.keys() {
        let name = path.rsplit('/').next().unwrap_or(path);
        if name.ends_with("clippy.toml") && path != "clippy.toml" {
            breaches.push(format!(
                "{path}:1: replaces the root's clippy.toml for its crate; allowed: one, at the root"
            ));
        }
    }
    let at_root = tree.files.get("clippy.toml").map_or("", String::as_str);
    if !at_root
        .lines()
        .any(|line| line == "too-many-lines-threshold = 100")
    {
        breaches.push("clippy.toml:1: must say `too-many-lines-threshold = 100`".to_owned());
    }
    for (path, text) in tree.manifests() {
        let lines: Vec<&str> = text.lines().collect();
        if !lines
            .windows(2)
            .any(|two| two == ["[lints]", "workspace = true"])
        {
            breaches.push(format!(
                "{path}:{}: must end with `[lints]` and `workspace = true`",
                lines.len()
            ));
        }
    }
    breaches
}

fn changelog(tree: &Tree) -> Breaches {
    let manifest = tree.files.get("Cargo.toml").map_or("", String::as_str);
    let package = manifest
        .split("[workspace.package]")
        .nth(1)
        .unwrap_or_default();
    let version = package
        .lines()
        .find_map(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
    let Some(version) = version else {
        return vec!["Cargo.toml:1: [workspace.package] has no version".to_owned()];
    };
    let heading = format!("## [{version}]");
    let text = tree.files.get("CHANGELOG.md").map_or("", String::as_str);
    if text.lines().any(|line| line.starts_with(&heading)) {
        return Breaches::new();
    }
    vec![format!(
        "CHANGELOG.md:1: has no section `{heading}`, the version in Cargo.toml"
    )]
}

/// A reason is a comment on the entry's line or on the line above; our own crates need none.
fn reasons(tree: &Tree) -> Breaches {
    let manifest = tree.files.get("Cargo.toml").map_or("", String::as_str);
    let lines: Vec<&str> = manifest.lines().map(str::trim).collect();
    let explained = |number: usize| {
        let above = number.checked_sub(2).map_or("", |above| lines[above]);
        above
            .strip_prefix("# ")
            .is_some_and(|reason| !reason.is_empty())
            || lines[number - 1].contains(" # ")
    };
    let foreign = |(_, section, name): &(usize, String, String)| {
        section == "workspace.dependencies"
            && !MAY_IMPORT
                .iter()
                .any(|(folder, _)| dependency(folder) == *name)
    };
    let entries = manifest_entries(manifest).into_iter().filter(foreign);
    let unexplained = entries.filter(|(number, _, _)| !explained(*number));
    unexplained
        .map(|(number, _, name)| {
            format!("Cargo.toml:{number}: no comment says why `{name}` is here")
        })
        .collect()
}
