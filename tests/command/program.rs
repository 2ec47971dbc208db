//! Runs the program and captures its output.

use std::path::Path;
use std::process::{Command, Output};

/// The root folder of the project.
pub(crate) fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The path of a shipped scenario file, as an argument.
pub(crate) fn scenario(file: &str) -> String {
    project().join("scenarios").join(file).display().to_string()
}

/// The path of the only file in a folder.
pub(crate) fn only_file(dir: impl AsRef<Path>) -> String {
    let files: Vec<_> = std::fs::read_dir(dir)
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    assert_eq!(files.len(), 1, "{files:?}");
    files[0].display().to_string()
}

/// The arguments in a command line without quotes.
pub(crate) fn words(line: &str) -> Vec<&str> {
    line.split(' ').collect()
}

/// A command that runs the program in a folder.
pub(crate) fn command(dir: impl AsRef<Path>, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_squall"));
    command.current_dir(dir).args(args);
    command
}

/// Runs the program to its end.
pub(crate) fn squall(dir: impl AsRef<Path>, args: &[&str]) -> Output {
    command(dir, args).output().expect("the program starts")
}

/// Runs the program, which must succeed; returns its standard output.
pub(crate) fn printed(dir: impl AsRef<Path>, args: &[&str]) -> String {
    let output = squall(dir, args);
    assert!(
        output.status.success(),
        "{args:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the program, which must fail; returns its error output.
pub(crate) fn refusal(dir: impl AsRef<Path>, args: &[&str]) -> String {
    let output = squall(dir, args);
    assert!(!output.status.success(), "{args:?} is accepted");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(!text.contains("panicked"), "{text}");
    text
}
