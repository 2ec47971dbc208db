//! Memory for examining a recording: a recording twice as long needs no more.

use crate::program;
use std::path::Path;
use std::process::{Child, Stdio};
use std::time::Duration;

/// Allowed growth for the longer recording, because of more events and noise.
const MORE: f64 = 1.2;

/// Records a game of 40 boats at rest for this duration; returns the path.
fn recorded(dir: &Path, duration_s: u32) -> String {
    let game = dir.join(format!("idle_{duration_s}.toml"));
    let base = program::scenario("games/swarm_20v20.toml");
    std::fs::write(
        &game,
        format!("base = \"{base}\"\nduration_s = {duration_s}\n"),
    )
    .unwrap();
    let runs = dir.join(format!("runs_{duration_s}"));
    let idle = program::scenario("strategies/idle.toml");
    let args = [
        "run",
        game.to_str().unwrap(),
        "--in-process",
        "--blue",
        &idle,
        "--red",
        &idle,
        "--record",
    ];
    program::printed(dir, &[&args[..], &[runs.to_str().unwrap()]].concat());
    program::only_file(runs)
}

/// The peak memory of a process so far, kB (proc(5)).
fn peak_kb(child: &Child) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix(" kB")?.parse().ok()
}

/// The peak memory of the program for these arguments, kB: polled until it exits.
fn peak_of(dir: &Path, args: &[&str]) -> u64 {
    let mut command = program::command(dir, args);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts");
    let mut peak = 0;
    loop {
        peak = peak.max(peak_kb(&child).unwrap_or(0));
        if let Some(status) = child.try_wait().expect("it can be waited for") {
            assert!(
                status.success() && peak > 0,
                "{args:?}: {status}, {peak} kB"
            );
            return peak;
        }
        #[expect(
            clippy::disallowed_methods,
            reason = "a process's peak memory can be seen only while it runs"
        )]
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_recording_that_is_twice_as_long_takes_no_more_memory() {
    let dir = tempfile::tempdir().unwrap();
    let files = [200, 400].map(|duration_s| recorded(dir.path(), duration_s));
    for words in [
        &["log"][..],
        &["log", "--json", "summary.json"],
        &["log", "--csv", "frame"],
        &["log", "--csv", "picture/blue"],
        &["log", "--alog", "logs"],
        &["replay", "--check"],
    ] {
        let [short, long] = files
            .each_ref()
            .map(|file| peak_of(dir.path(), &[words, &[file]].concat()));
        assert!(
            long as f64 <= MORE * short as f64,
            "{words:?}: {short} kB, then {long} kB"
        );
    }
}
