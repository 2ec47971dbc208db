//! Embeds the commit that a program was built from, both in `squall` and in `squall-gateway`, whose
//! package is in a subfolder.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The programs' sources.
const SOURCES: [&str; 9] = [
    "Cargo.toml",
    "Cargo.lock",
    "build.rs",
    "src",
    "scenarios",
    "crates",
    "sim",
    "agent",
    "gateway",
];

fn main() {
    let root = root();
    let commit = commit(&root);
    println!(
        "cargo::rustc-env=SQUALL_COMMIT={}",
        commit.as_deref().unwrap_or("unknown")
    );
    // HEAD's log changes with each commit; an edit to any of these files may change whether the
    // sources match it.
    let watched = ["HEAD", "logs/HEAD"]
        .into_iter()
        .filter_map(|file| git(&root, &["rev-parse", "--git-path", file]));
    let watched = watched
        .map(|path| root.join(path))
        .filter(|path| path.exists());
    for path in watched.chain(SOURCES.map(|path| root.join(path))) {
        println!("cargo::rerun-if-changed={}", path.display());
    }
}

/// The root of the workspace: the parent folder of the package that has the lock file.
fn root() -> PathBuf {
    let package = PathBuf::from(std::env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let root = package
        .ancestors()
        .find(|folder| folder.join("Cargo.lock").exists())
        .map(Path::to_owned);
    root.unwrap_or(package)
}

/// The commit, marked if the sources differ from it; `None` outside our repository.
fn commit(root: &Path) -> Option<String> {
    // A packed copy inside another repository is not part of it.
    git(root, &["ls-files", "--error-unmatch", "build.rs"])?;
    let commit = git(root, &["rev-parse", "--short=12", "HEAD"])?;
    let is_clean = git(
        root,
        &[&["diff", "--quiet", "HEAD", "--"], &SOURCES[..]].concat(),
    )
    .is_some();
    Some(if is_clean {
        commit
    } else {
        format!("{commit}-dirty")
    })
}

/// The output of git run in this folder, if it succeeds.
fn git(root: &Path, args: &[&str]) -> Option<String> {
    let command = Command::new("git").current_dir(root).args(args).output();
    let output = command.ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
