//! The smallest tree that keeps every rule, and files that break each of them.

use crate::rule::{LINES_MAX, RULES};
use crate::text::joined;
use crate::tree::Tree;
use std::path::PathBuf;

/// The smallest tree that keeps every rule.
pub(crate) fn sound_tree() -> Tree {
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
        (
            "ARCHITECTURE.md",
            "See `sim/src/hull.rs`, `sim/src/hull`, `game::topic`, `order/<agent>`.\n\
             ## Glossary\n| term | meaning |\n|---|---|\n| hull | what floats |\n## End\n| keel | not a term |\n",
        ),
        ("CHANGELOG.md", "## [1.2.3] - unreleased\n"),
        ("DESIGN.md", "| crate | why |\n|---|---|\n| `libm` | bits |\n"),
    ];
    let files = files.map(|(path, text)| (path.to_owned(), text.to_owned()));
    Tree { root: PathBuf::new(), files: files.into() }
}

/// For every rule, files that break it, and what it should say.
pub(crate) fn breakers() -> Vec<(&'static str, &'static str, String, &'static str)> {
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
        (
            rule(9),
            "ARCHITECTURE.md",
            "## Glossary\n| term | |\n|---|---|\n| hull | |\n| set-point | |\n".to_owned(),
            "ARCHITECTURE.md:5: no code has the term \"set-point\"",
        ),
        (rule(9), "ARCHITECTURE.md", "No terms.\n".to_owned(), "has no table below a heading"),
        (rule(10), "sim/clippy.toml", String::new(), "sim/clippy.toml:1: replaces"),
        (rule(10), "sim/Cargo.toml", "[package]\n".to_owned(), "sim/Cargo.toml:1: must end with `[lints]`"),
        (rule(10), "clippy.toml", "too-many-lines-threshold = 700\n".to_owned(), "threshold = 70`"),
        (rule(11), "CHANGELOG.md", "## [1.2.2]\n".to_owned(), "has no section `## [1.2.3]`"),
        (
            rule(12),
            "DESIGN.md",
            "| `libm` in passing | |\n".to_owned(),
            "Cargo.toml:5: DESIGN.md has no table row for `libm`",
        ),
    ]
}
