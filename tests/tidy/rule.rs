//! The rules, and what each finds wrong with a tree.

use crate::shown_by::shown_by;
use crate::text::{is_path, joined, manifest_entries, names, quoted};
use crate::tree::Tree;

/// The longest file a person may have written, lines.
pub(crate) const LINES_MAX: usize = 500;

/// What each crate of ours may depend on, whatever the section. Folders that are planned are in here already.
const MAY_IMPORT: [(&str, &[&str]); 18] = [
    ("onnx", &[]),
    ("game", &["onnx"]),
    ("bus", &["game"]),
    ("recording", &["game"]),
    ("sim", &["game", "bus", "recording"]),
    ("agent", &["onnx", "game", "bus"]),
    ("gateway", &["game", "bus", "recording", "agent"]),
    ("command_line", &["game", "bus", "recording"]),
    // Neither a web server nor anything that plays or learns: what drives a boat is read by itself.
    ("gateway/cli", &["game", "bus", "recording", "gateway", "command-line"]),
    ("gateway/crosscheck", &["game", "gateway"]),
    ("fuzz", &["onnx", "game", "bus", "recording", "sim", "agent", "gateway", "arena", "analysis", "shore"]),
    // `analysis` for examples: what games in one process tell.
    ("arena", &["game", "sim", "agent", "analysis"]),
    ("analysis", &["game", "recording"]),
    // `analysis` for the curves below the time line of a replay.
    ("shore", &["game", "bus", "recording", "analysis"]),
    ("learn", &["onnx", "game", "sim", "agent", "arena", "recording"]),
    ("sweep", &["game", "sim", "agent", "analysis", "arena"]),
    ("python", &["arena", "game", "learn", "sweep"]),
    (
        "",
        &[
            "onnx",
            "game",
            "bus",
            "recording",
            "sim",
            "agent",
            "gateway",
            "gateway-cli",
            "command-line",
            "arena",
            "analysis",
            "learn",
            "shore",
            "sweep",
        ],
    ),
];

/// Crates whose network shell, `node`, is the only place that may use `bus`; everything else in them is pure.
const SHELLS: [&str; 3] = ["sim", "agent", "gateway"];

/// A breach of a rule: `file:line: what is wrong, what is allowed`.
pub(crate) type Breaches = Vec<String>;

/// A name, and what finds its breaches.
type Rule = (&'static str, fn(&Tree) -> Breaches);

pub(crate) const RULES: [Rule; 14] = [
    ("crates depend only on what lies below them", dependencies),
    ("only node shells use the bus", bus_in_shells),
    ("only bus names zenoh", zenoh_in_bus),
    ("only game::topic spells a key", keys_in_topic),
    ("files are short and say what they are", files_in_shape),
    ("libraries do not print", quiet_libraries),
    ("nothing is left undone", nothing_undone),
    ("no unwrap outside of tests", no_unwrap),
    ("ARCHITECTURE.md names what exists", architecture),
    ("the glossary's terms are in the code", glossary),
    ("one clippy.toml, and every crate under the workspace's lints", lints),
    ("CHANGELOG.md has this version", changelog),
    ("DESIGN.md gives a reason for every dependency", reasons),
    ("tables of what is tested name tests that exist", shown_by),
];

fn dependencies(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.manifests() {
        let folder = path.strip_suffix("Cargo.toml").unwrap_or(path).trim_end_matches('/');
        let folder = folder.strip_prefix("crates/").unwrap_or(folder);
        let Some((_, allowed)) = MAY_IMPORT.iter().find(|(name, _)| *name == folder) else {
            breaches.push(format!("{path}:1: no rule for this crate: say in tests/tidy.rs what it may import"));
            continue;
        };
        // What the root only offers, nobody imports yet.
        let entries = manifest_entries(text).into_iter().filter(|(_, section, _)| section != "workspace.dependencies");
        for (number, section, name) in entries {
            let place = format!("{path}:{number}");
            let of_ours = MAY_IMPORT.iter().any(|(folder, _)| dependency(folder) == name) || name.starts_with("squall");
            if of_ours && !allowed.contains(&name.as_str()) {
                let allowed = if allowed.is_empty() { "nothing of ours".to_owned() } else { allowed.join(", ") };
                breaches.push(format!("{place}: {folder} depends on {name}, allowed: {allowed}"));
            }
            let baseline = folder.is_empty() && section == "dev-dependencies";
            if name.starts_with("zenoh") && folder != "bus" && !baseline {
                breaches
                    .push(format!("{place}: {name} belongs to bus (and to the root's dev-dependencies, for benches)"));
            }
            let line = text.lines().nth(number - 1).unwrap_or_default();
            if name == "bus" && SHELLS.contains(&folder) && !line.contains("optional = true") {
                breaches.push(format!("{place}: bus must be optional here (feature `net`): arena links no network"));
            }
        }
    }
    breaches
}

/// What manifests call the crate in a folder: `gateway-cli` that in `gateway/cli`.
fn dependency(folder: &str) -> String {
    folder.replace(['/', '_'], "-")
}

fn bus_in_shells(tree: &Tree) -> Breaches {
    let in_shell = |path: &str, krate: &str| {
        path.starts_with(&format!("{krate}/src/node/")) || path == format!("{krate}/src/node.rs")
    };
    let is_core = |path: &str| SHELLS.iter().any(|k| path.starts_with(&format!("{k}/src/")) && !in_shell(path, k));
    tree.find(is_core, |line| names(line, "bus::"), "bus is used in a pure core; only its node may")
}

fn zenoh_in_bus(tree: &Tree) -> Breaches {
    // Whoever breaks in does so by zenoh's own interface.
    let allowed = ["crates/bus/src/", "benches/", "tests/adversary/"];
    let elsewhere = |path: &str| !allowed.iter().any(|folder| path.starts_with(folder));
    let word = joined(["zen", "oh::"]);
    tree.find(
        elsewhere,
        |line| names(line, &word),
        "zenoh is named; allowed in crates/bus/src, benches and tests/adversary",
    )
}

fn keys_in_topic(tree: &Tree) -> Breaches {
    let elsewhere = |path: &str| path != "crates/game/src/topic.rs";
    let key = joined(["\"squ", "all/"]);
    tree.find(elsewhere, |line| line.contains(&key), "a key is spelt; allowed in crates/game/src/topic.rs")
}

fn files_in_shape(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.sources() {
        let lines = text.lines().count();
        if lines > LINES_MAX {
            breaches
                .push(format!("{path}:{lines}: {lines} lines, allowed: {LINES_MAX}; which noun wants its own file?"));
        }
        if !text.starts_with("//! ") {
            breaches.push(format!("{path}:1: must begin with `//! ` and a sentence that says what the file is"));
        }
    }
    breaches
}

fn quiet_libraries(tree: &Tree) -> Breaches {
    let library = |path: &str| path.contains("/src/") && !path.starts_with("src/") && path != "crates/fuzz/src/main.rs";
    let prints = |line: &str| ["print!", "println!", "eprint!", "eprintln!"].iter().any(|word| names(line, word));
    let mut breaches = tree.find(library, prints, "a library prints; allowed in src/, tests and benches");
    breaches.extend(tree.find(|_| true, |line| names(line, &joined(["db", "g!"])), "left from debugging"));
    breaches
}

fn nothing_undone(tree: &Tree) -> Breaches {
    let words = [["to", "do!"], ["unimpl", "emented!"]].map(joined);
    let mut breaches = tree.find(|_| true, |line| words.iter().any(|w| names(line, w)), "code that is not there yet");
    let marks = [["TO", "DO"], ["FIX", "ME"]].map(joined);
    for (path, text) in tree.sources() {
        for (number, line) in text.lines().enumerate() {
            if marks.iter().any(|mark| line.contains(mark.as_str())) {
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
    let is_test = |path: &str| path.split('/').any(|folder| folder == "tests" || folder == "benches");
    let call = joined([".unw", "rap()"]);
    tree.find(
        |path| !is_test(path),
        |line| line.contains(&call),
        "unwrap; allowed in tests and benches. Elsewhere handle it, or `expect` the reason why it cannot fail",
    )
}

fn architecture(tree: &Tree) -> Breaches {
    let Some(text) = tree.files.get("ARCHITECTURE.md") else { return vec!["ARCHITECTURE.md: is missing".to_owned()] };
    let missing = |(number, path): (usize, String)| {
        (!tree.has(&path)).then(|| format!("ARCHITECTURE.md:{number}: `{path}` does not exist"))
    };
    let paths = quoted(text).into_iter().filter(|(_, word)| is_path(word));
    paths.filter_map(missing).collect()
}

/// The terms are the first cells of the table below the heading `Glossary`. Code spells `set-point` as `set_point` or
/// `SetPoint`, so case and separators do not count.
fn glossary(tree: &Tree) -> Breaches {
    let text = tree.files.get("ARCHITECTURE.md").map_or("", String::as_str);
    let lines = text.lines().enumerate().skip_while(|(_, line)| *line != "## Glossary").skip(1);
    let rows = lines.take_while(|(_, line)| !line.starts_with("## ")).filter(|(_, line)| line.starts_with('|'));
    // The heading of the table and the line below it are no terms.
    let terms = rows.skip(2).filter_map(|(i, line)| Some((i + 1, line.split('|').nth(1)?.trim())));
    let plain = |text: &str| text.to_lowercase().replace(['_', '-', ' ', '`'], "");
    let code: String = tree.sources().filter(|(path, _)| path.contains("src/")).map(|(_, text)| plain(text)).collect();
    let found: Vec<(usize, &str)> = terms.collect();
    if found.is_empty() {
        return vec!["ARCHITECTURE.md:1: has no table below a heading `## Glossary`".to_owned()];
    }
    let missing = found.into_iter().filter(|(_, term)| !code.contains(&plain(term)));
    missing.map(|(number, term)| format!("ARCHITECTURE.md:{number}: no code has the term {term:?}")).collect()
}

fn lints(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for path in tree.files.keys() {
        let name = path.rsplit('/').next().unwrap_or(path);
        if name.ends_with("clippy.toml") && path != "clippy.toml" {
            breaches
                .push(format!("{path}:1: replaces the root's clippy.toml for its crate; allowed: one, at the root"));
        }
    }
    let at_root = tree.files.get("clippy.toml").map_or("", String::as_str);
    if !at_root.lines().any(|line| line == "too-many-lines-threshold = 70") {
        breaches.push("clippy.toml:1: must say `too-many-lines-threshold = 70`".to_owned());
    }
    for (path, text) in tree.manifests() {
        let lines: Vec<&str> = text.lines().collect();
        if !lines.windows(2).any(|two| two == ["[lints]", "workspace = true"]) {
            breaches.push(format!("{path}:{}: must end with `[lints]` and `workspace = true`", lines.len()));
        }
    }
    breaches
}

fn changelog(tree: &Tree) -> Breaches {
    let manifest = tree.files.get("Cargo.toml").map_or("", String::as_str);
    let package = manifest.split("[workspace.package]").nth(1).unwrap_or_default();
    let version = package.lines().find_map(|line| line.strip_prefix("version = \"")?.strip_suffix('"'));
    let Some(version) = version else { return vec!["Cargo.toml:1: [workspace.package] has no version".to_owned()] };
    let heading = format!("## [{version}]");
    let text = tree.files.get("CHANGELOG.md").map_or("", String::as_str);
    if text.lines().any(|line| line.starts_with(&heading)) {
        return Breaches::new();
    }
    vec![format!("CHANGELOG.md:1: has no section `{heading}`, the version in Cargo.toml")]
}

fn reasons(tree: &Tree) -> Breaches {
    let manifest = tree.files.get("Cargo.toml").map_or("", String::as_str);
    let design = tree.files.get("DESIGN.md").map_or("", String::as_str);
    let rows: Vec<&str> = design.lines().filter(|line| line.starts_with('|')).collect();
    let cells: Vec<&str> = rows.iter().filter_map(|row| row.split('|').nth(1)).map(str::trim).collect();
    let named = |name: &str| cells.contains(&format!("`{name}`").as_str());
    let foreign = |(_, section, name): &(usize, String, String)| {
        section == "workspace.dependencies" && !MAY_IMPORT.iter().any(|(folder, _)| dependency(folder) == *name)
    };
    let entries = manifest_entries(manifest).into_iter().filter(foreign);
    let unexplained = entries.filter(|(_, _, name)| !named(name));
    unexplained
        .map(|(number, _, name)| format!("Cargo.toml:{number}: DESIGN.md has no table row for `{name}`"))
        .collect()
}
