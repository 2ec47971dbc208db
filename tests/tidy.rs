//! The house rules that a compiler does not check: who imports whom, how long files are, what documents promise.
//!
//! Every rule reads a [`Tree`] of texts and gives its breaches. The first test holds the repository to all
//! of them; the second breaks each in turn, so that a rule which has stopped looking is noticed too.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The longest file a person may have written, lines.
const LINES_MAX: usize = 500;

/// What each crate of ours may depend on, whatever the section. Folders that are planned are in here already.
const MAY_IMPORT: [(&str, &[&str]); 13] = [
    ("game", &[]),
    ("bus", &["game"]),
    ("recording", &["game"]),
    ("sim", &["game", "bus", "recording"]),
    ("agent", &["game", "bus"]),
    ("gateway", &["game", "bus", "recording"]),
    ("gateway/crosscheck", &["game", "gateway"]),
    ("gateway/fuzz", &["game", "gateway"]),
    ("arena", &["game", "sim", "agent"]),
    ("analysis", &["game", "recording"]),
    ("shore", &["game", "bus", "recording"]),
    ("python", &["arena"]),
    ("", &["game", "bus", "recording", "sim", "agent", "gateway", "arena", "analysis", "shore"]),
];

/// Crates whose network shell, `node`, is the only place that may use `bus`; everything else in them is pure.
const SHELLS: [&str; 3] = ["sim", "agent", "gateway"];

/// The files of a repository that rules look at: path from the root (with `/`), and text.
struct Tree {
    root: PathBuf,
    files: BTreeMap<String, String>,
}

/// A breach of a rule: `file:line: what is wrong, what is allowed`.
type Breaches = Vec<String>;

/// A name, and what finds its breaches.
type Rule = (&'static str, fn(&Tree) -> Breaches);

const RULES: [Rule; 12] = [
    ("crates depend only on what lies below them", dependencies),
    ("only node shells use the bus", bus_in_shells),
    ("only bus names zenoh", zenoh_in_bus),
    ("only game::topic spells a key", keys_in_topic),
    ("files are short and say what they are", files_in_shape),
    ("libraries do not print", quiet_libraries),
    ("nothing is left undone", nothing_undone),
    ("no unwrap outside of tests", no_unwrap),
    ("ARCHITECTURE.md names what exists", architecture),
    ("one clippy.toml, and every crate under the workspace's lints", lints),
    ("CHANGELOG.md has this version", changelog),
    ("DESIGN.md gives a reason for every dependency", reasons),
];

#[test]
fn the_repository_keeps_the_house_rules() {
    let tree = Tree::of(&root());
    assert!(
        tree.files.len() > 50,
        "only {} files under {}: is this the repository?",
        tree.files.len(),
        root().display()
    );
    let breaches: Vec<String> = RULES.iter().flat_map(|(name, rule)| report(name, rule(&tree))).collect();
    assert!(breaches.is_empty(), "\n{}\n", breaches.join("\n"));
}

#[test]
fn every_rule_notices_its_breach() {
    for (rule, path, text, said) in breakers() {
        let mut tree = sound_tree();
        assert_eq!(breaches_of(&tree, rule), Breaches::new(), "the sound tree, by {rule:?}");
        tree.files.insert(path.to_owned(), text);
        let found = breaches_of(&tree, rule).join("\n");
        assert!(found.contains(said), "{rule:?} with this {path} should say {said:?}, but says {found:?}");
    }
    let untested = RULES.iter().find(|(name, _)| breakers().iter().all(|breaker| breaker.0 != *name));
    assert_eq!(untested.map(|(name, _)| name), None, "a rule that no breaker tries");
}

#[test]
fn what_is_allowed_is_not_reported() {
    let mut tree = sound_tree();
    for (path, text) in [
        ("sim/src/node/server.rs", "//! Booth.\nuse bus::Bus;\n".to_owned()),
        ("agent/src/node.rs", "//! Node.\nuse bus::Bus;\n".to_owned()),
        ("sim/src/tide.rs", format!("//! Tide, not {}.\nfn f() {{}} // {}\n", joined(["zen", "oh::"]), "x.unwrap()")),
        ("sim/src/wave.rs", "//! Waves.\n#[cfg(test)]\nmod tests {\n    fn f() { g().unwrap() }\n}\n".to_owned()),
        ("sim/tests/wave.rs", "//! Waves.\nfn f() { g().unwrap() }\n".to_owned()),
        ("benches/lockstep.rs", format!("//! Bench.\nuse {}Session;\n", joined(["zen", "oh::"]))),
        ("src/main.rs", "//! Squall.\nfn main() { println!(\"ahoy\") }\n".to_owned()),
    ] {
        tree.files.insert(path.to_owned(), text);
    }
    for (name, rule) in RULES {
        assert_eq!(rule(&tree), Breaches::new(), "{name}");
    }
}

fn dependencies(tree: &Tree) -> Breaches {
    let mut breaches = Breaches::new();
    for (path, text) in tree.manifests() {
        let folder = path.strip_suffix("Cargo.toml").unwrap_or(path).trim_end_matches('/');
        let Some((_, allowed)) = MAY_IMPORT.iter().find(|(name, _)| *name == folder) else {
            breaches.push(format!("{path}:1: no rule for this crate: say in tests/tidy.rs what it may import"));
            continue;
        };
        // What the root only offers, nobody imports yet.
        let entries = manifest_entries(text).into_iter().filter(|(_, section, _)| section != "workspace.dependencies");
        for (number, section, name) in entries {
            let place = format!("{path}:{number}");
            let of_ours =
                MAY_IMPORT.iter().any(|(ours, _)| !ours.is_empty() && *ours == name) || name.starts_with("squall");
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

fn bus_in_shells(tree: &Tree) -> Breaches {
    let in_shell = |path: &str, krate: &str| {
        path.starts_with(&format!("{krate}/src/node/")) || path == format!("{krate}/src/node.rs")
    };
    let is_core = |path: &str| SHELLS.iter().any(|k| path.starts_with(&format!("{k}/src/")) && !in_shell(path, k));
    tree.find(is_core, |line| names(line, "bus::"), "bus is used in a pure core; only its node may")
}

fn zenoh_in_bus(tree: &Tree) -> Breaches {
    let elsewhere = |path: &str| !path.starts_with("bus/src/") && !path.starts_with("benches/");
    let word = joined(["zen", "oh::"]);
    tree.find(elsewhere, |line| names(line, &word), "zenoh is named; allowed in bus/src and benches")
}

fn keys_in_topic(tree: &Tree) -> Breaches {
    let elsewhere = |path: &str| path != "game/src/topic.rs";
    let key = joined(["\"squ", "all/"]);
    tree.find(elsewhere, |line| line.contains(&key), "a key is spelt; allowed in game/src/topic.rs")
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
    let library = |path: &str| path.contains("/src/") && !path.starts_with("src/");
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
        section == "workspace.dependencies" && !MAY_IMPORT.iter().any(|(ours, _)| ours == name)
    };
    let entries = manifest_entries(manifest).into_iter().filter(foreign);
    let unexplained = entries.filter(|(_, _, name)| !named(name));
    unexplained
        .map(|(number, _, name)| format!("Cargo.toml:{number}: DESIGN.md has no table row for `{name}`"))
        .collect()
}

impl Tree {
    fn of(root: &Path) -> Tree {
        let mut tree = Tree { root: root.to_owned(), files: BTreeMap::new() };
        tree.add(root, "");
        tree
    }

    fn add(&mut self, folder: &Path, path: &str) {
        // Cargo marks its output folders, wherever they are.
        if folder.join("CACHEDIR.TAG").exists() {
            return;
        }
        let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        for entry in entries.map(|entry| entry.expect("a folder can be read to its end")) {
            let name = entry.file_name().to_string_lossy().into_owned();
            let (at, path) = (entry.path(), if path.is_empty() { name.clone() } else { format!("{path}/{name}") });
            let is_text = [".rs", ".toml", ".md"].iter().any(|end| name.ends_with(end));
            if at.is_dir() && !name.starts_with('.') && path != "runs" {
                self.add(&at, &path);
            } else if at.is_file() && is_text {
                let text = fs::read_to_string(&at).unwrap_or_else(|e| panic!("{path}: {e}"));
                self.files.insert(path, text);
            }
        }
    }

    fn sources(&self) -> impl Iterator<Item = (&String, &String)> {
        self.files.iter().filter(|(path, _)| path.ends_with(".rs"))
    }

    fn manifests(&self) -> impl Iterator<Item = (&String, &String)> {
        self.files.iter().filter(|(path, _)| *path == "Cargo.toml" || path.ends_with("/Cargo.toml"))
    }

    /// Whether a path exists, as a file, a folder, or a module named without its ending.
    fn has(&self, path: &str) -> bool {
        let path = path.trim_end_matches('/');
        let known = |path: &str| {
            self.files.contains_key(path) || (!self.root.as_os_str().is_empty() && self.root.join(path).exists())
        };
        known(path) || known(&format!("{path}.rs"))
    }

    /// The lines of code, tests left out, in which `wrong` finds something.
    fn find(&self, look: impl Fn(&str) -> bool, wrong: impl Fn(&str) -> bool, said: &str) -> Breaches {
        let mut breaches = Breaches::new();
        for (path, text) in self.sources().filter(|(path, _)| look(path)) {
            let breach = |(number, line): (usize, &str)| format!("{path}:{number}: {said}: {}", line.trim());
            breaches.extend(code_of(text).filter(|(_, line)| wrong(line)).map(breach));
        }
        breaches
    }
}

/// Numbered lines without comments, up to the tests at the end of the file.
fn code_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines: Vec<&str> = text.lines().collect();
    let opens_tests = |two: &[&str]| two[0] == "#[cfg(test)]" && two[1].starts_with("mod ") && two[1].ends_with('{');
    let end = lines.windows(2).position(opens_tests).unwrap_or(lines.len());
    let numbered = lines.into_iter().take(end).enumerate();
    numbered.map(|(i, line)| (i + 1, without_comment(line)))
}

/// The line up to a `//` that begins a comment (and not the slashes of an address such as `http://`).
fn without_comment(line: &str) -> &str {
    let comment =
        line.match_indices("//").find(|(at, _)| line[..*at].chars().next_back().is_none_or(char::is_whitespace));
    comment.map_or(line, |(at, _)| &line[..at])
}

/// Whether `word` stands in the line on its own, not as the end of a longer name.
fn names(line: &str, word: &str) -> bool {
    let alone = |(at, _): (usize, &str)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    line.match_indices(word).any(alone)
}

/// Line number, section and name of everything in a manifest's dependency sections.
fn manifest_entries(text: &str) -> Vec<(usize, String, String)> {
    let mut section = String::new();
    let mut entries = Vec::new();
    for (number, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())) {
        if let Some(header) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            section = header.to_owned();
            // `[dependencies.name]` is an entry by itself.
            if let Some((of, name)) = header.rsplit_once("dependencies.") {
                entries.push((number, format!("{of}dependencies"), name.to_owned()));
            }
            continue;
        }
        let name: String = line.chars().take_while(|c| c.is_alphanumeric() || *c == '-' || *c == '_').collect();
        if section.ends_with("dependencies") && !name.is_empty() {
            entries.push((number, section.clone(), package_of(line).unwrap_or(name)));
        }
    }
    entries
}

/// The package behind an entry that was given another name, without our prefix.
fn package_of(line: &str) -> Option<String> {
    let package = line.split("package = \"").nth(1)?.split('"').next()?;
    Some(package.strip_prefix("squall-").unwrap_or(package).to_owned())
}

/// Everything in single backticks outside of fenced blocks, with its line.
fn quoted(text: &str) -> Vec<(usize, String)> {
    let mut fenced = false;
    let mut words = Vec::new();
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            words.extend(line.split('`').skip(1).step_by(2).map(|word| (i + 1, word.to_owned())));
        }
    }
    words
}

/// Whether a word in backticks is a path of this repository: it has a folder or a file's ending, and nothing
/// that belongs to commands, keys or Rust.
fn is_path(word: &str) -> bool {
    let foreign = word.starts_with(['/', '-', '.', '~']) && !word.starts_with(".ci/")
        || word.starts_with(&joined(["squ", "all/"]));
    let odd = word.contains("::") || word.contains([' ', '<', '>', '*', ':', '(', '=', '|', '{', '$']);
    let ending = [".rs", ".toml", ".md", ".msg", ".json"].iter().any(|end| word.ends_with(end));
    !foreign && !odd && (ending || word.contains('/'))
}

/// Two halves of a word that must not stand here whole, since this file is looked at too.
fn joined(halves: [&str; 2]) -> String {
    halves.concat()
}

fn report(rule: &str, breaches: Breaches) -> Breaches {
    breaches.into_iter().map(|breach| format!("{breach}\n    rule: {rule}")).collect()
}

fn breaches_of(tree: &Tree, rule: &str) -> Breaches {
    let (_, find) = RULES.iter().find(|(name, _)| *name == rule).unwrap_or_else(|| panic!("no rule {rule:?}"));
    find(tree)
}

fn root() -> PathBuf {
    let told = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    told.or_else(|| option_env!("CARGO_MANIFEST_DIR").map(PathBuf::from)).unwrap_or_else(|| PathBuf::from("."))
}

/// The smallest tree that keeps every rule.
fn sound_tree() -> Tree {
    let files = [
        (
            "Cargo.toml",
            "[workspace.package]\nversion = \"1.2.3\"\n[workspace.dependencies]\n\
             game = { package = \"squall-game\", path = \"game\" }\nlibm = \"0.2\"\n\
             [dependencies]\ngame.workspace = true\n[lints]\nworkspace = true\n",
        ),
        ("sim/Cargo.toml", "[dependencies]\ngame.workspace = true\n[lints]\nworkspace = true\n"),
        ("sim/src/hull.rs", "//! A hull.\n"),
        ("game/src/topic.rs", "//! Keys.\n"),
        ("clippy.toml", "too-many-lines-threshold = 70\n"),
        ("ARCHITECTURE.md", "See `sim/src/hull.rs`, `sim/src/hull`, `game::topic`, `order/<agent>`.\n"),
        ("CHANGELOG.md", "## [1.2.3] - unreleased\n"),
        ("DESIGN.md", "| crate | why |\n|---|---|\n| `libm` | bits |\n"),
    ];
    let files = files.map(|(path, text)| (path.to_owned(), text.to_owned()));
    Tree { root: PathBuf::new(), files: files.into() }
}

/// For every rule, files that break it, and what it should say.
fn breakers() -> Vec<(&'static str, &'static str, String, &'static str)> {
    let lints = "[lints]\nworkspace = true\n";
    let rule = |i: usize| RULES[i].0;
    let code = |line: &str| format!("//! A file.\nfn f() {{ {line} }}\n");
    let deps = |entry: &str| format!("[dependencies]\n{entry}\n{lints}");
    vec![
        (
            rule(0),
            "agent/Cargo.toml",
            deps("sim.workspace = true"),
            "agent/Cargo.toml:2: agent depends on sim, allowed: game, bus",
        ),
        (
            rule(0),
            "agent/Cargo.toml",
            deps("world = { package = \"squall-sim\", path = \"../sim\" }"),
            "agent depends on sim",
        ),
        (
            rule(0),
            "agent/Cargo.toml",
            format!("[dev-dependencies.sim]\npath = \"../sim\"\n{lints}"),
            "agent depends on sim",
        ),
        (rule(0), "game/Cargo.toml", deps("bus.workspace = true"), "allowed: nothing of ours"),
        (rule(0), "sim/Cargo.toml", deps("zenoh.workspace = true"), "sim/Cargo.toml:2: zenoh belongs to bus"),
        (rule(0), "sim/Cargo.toml", deps("bus.workspace = true"), "bus must be optional"),
        (rule(0), "radar/Cargo.toml", deps(""), "no rule for this crate"),
        (rule(1), "sim/src/world.rs", code("bus::inbox(1)"), "sim/src/world.rs:2: bus is used in a pure core"),
        (rule(2), "sim/src/node/mod.rs", code(&joined(["zen", "oh::open()"])), "sim/src/node/mod.rs:2: zenoh is named"),
        (rule(3), "tests/net.rs", code(&joined(["\"squ", "all/x\""])), "tests/net.rs:2: a key is spelt"),
        (rule(4), "sim/src/long.rs", format!("//! Long.\n{}", "\n".repeat(LINES_MAX)), "501 lines, allowed: 500"),
        (rule(4), "sim/src/dumb.rs", "use game::Ned;\n".to_owned(), "sim/src/dumb.rs:1: must begin with"),
        (rule(5), "game/src/angle.rs", code("println!(\"x\")"), "game/src/angle.rs:2: a library prints"),
        (rule(5), "src/main.rs", code(&joined(["db", "g!(1)"])), "left from debugging"),
        (rule(6), "game/src/angle.rs", code(&joined(["to", "do!()"])), "game/src/angle.rs:2: code that is not there"),
        (rule(6), "game/src/angle.rs", format!("//! Angles.\n// {}: wrap\n", joined(["TO", "DO"])), "a note to self"),
        (rule(7), "src/main.rs", code(&joined(["x.unw", "rap()"])), "src/main.rs:2: unwrap"),
        (
            rule(8),
            "ARCHITECTURE.md",
            "one\nSee `sim/src/keel.rs`.\n".to_owned(),
            "ARCHITECTURE.md:2: `sim/src/keel.rs` does not exist",
        ),
        (rule(9), "sim/clippy.toml", String::new(), "sim/clippy.toml:1: replaces"),
        (rule(9), "sim/Cargo.toml", "[package]\n".to_owned(), "sim/Cargo.toml:1: must end with `[lints]`"),
        (rule(9), "clippy.toml", "too-many-lines-threshold = 700\n".to_owned(), "threshold = 70`"),
        (rule(10), "CHANGELOG.md", "## [1.2.2]\n".to_owned(), "has no section `## [1.2.3]`"),
        (
            rule(11),
            "DESIGN.md",
            "| `libm` in passing | |\n".to_owned(),
            "Cargo.toml:5: DESIGN.md has no table row for `libm`",
        ),
    ]
}
