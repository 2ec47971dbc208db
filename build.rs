//! Says which commit the program is built from.

use std::path::Path;
use std::process::Command;

/// What the program is made of.
const SOURCES: [&str; 9] =
    ["Cargo.toml", "Cargo.lock", "build.rs", "src", "scenarios", "crates", "sim", "agent", "gateway"];

fn main() {
    let commit = commit();
    println!("cargo::rustc-env=SQUALL_COMMIT={}", commit.as_deref().unwrap_or("unknown"));
    // Of a new commit HEAD's log tells; whether the sources are as committed may change with any of them.
    let watched = ["HEAD", "logs/HEAD"].into_iter().filter_map(|file| git(&["rev-parse", "--git-path", file]));
    let watched = watched.filter(|path| Path::new(path).exists());
    for path in watched.chain(SOURCES.map(str::to_owned)) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// The commit, marked if what is built is not what was committed; none outside of our repository.
fn commit() -> Option<String> {
    // A packed copy inside of somebody else's repository is not theirs.
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let is_clean = git(&[&["diff", "--quiet", "HEAD", "--"], &SOURCES[..]].concat()).is_some();
    Some(if is_clean { commit } else { format!("{commit}-dirty") })
}

/// What git says, if all is well.
fn git(args: &[&str]) -> Option<String> {
    let output = Command::new("git").args(args).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
