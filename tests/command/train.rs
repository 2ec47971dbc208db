//! `squall train` from the command line: the same bytes on any number of threads and after
//! resuming, and complete tables.

use crate::program::{command, printed, refusal, scenario};
use std::collections::BTreeSet;
use std::fs::DirEntry;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A folder with the file `short.toml` of a training run with two short stages.
fn training() -> TempDir {
    let [game, rewards, idle, pav01] = [
        "games/pav01_afloat.toml",
        "rewards/bold.toml",
        "strategies/idle.toml",
        "strategies/pav01.toml",
    ]
    .map(scenario);
    // Not on disk here, so the built-in one is used.
    let policy = "scenarios/strategies/policy.toml";
    let stage = |name: &str, opponent: &str, samples: u32| {
        format!(
            "[[stage]]\nname = {name:?}\ngame = {game:?}\nrewards = {rewards:?}\nopponent = [{{ strategy = {opponent:?} }}]\n\
             strategies = 1\npast_selves = 1\nstarts = 8\nepisode_max_s = 20\nsamples = {samples}\n"
        )
    };
    let text = format!(
        "observation = {{ kind = \"squall\", mates = 1, enemies = 2 }}\ngames = 8\n[network]\nhidden = [16]\n\
         [ppo]\nsteps = 32\nminibatch = 256\n[league]\nevery_samples = 1000\nmost = 2\n\
         [evaluation]\nevery_samples = 3000\ngames = 2\nopponents = [{pav01:?}]\n{}{}",
        stage("alone", &idle, 4_000),
        stage("against", &pav01, 8_000) + &format!("helm = {policy:?}\n")
    );
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("short.toml"), text).unwrap();
    dir
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The lines of a table without their last cells, and those cells.
fn split(table: &str) -> (Vec<&str>, Vec<&str>) {
    table
        .lines()
        .map(|line| line.rsplit_once(',').unwrap())
        .unzip()
}

#[test]
fn a_training_leaves_the_same_files_on_any_number_of_threads() {
    let dir = training();
    let here = dir.path();
    let told = printed(
        here,
        &["train", "short.toml", "--out", "one", "--jobs", "1"],
    );
    assert!(
        told.contains("stage alone")
            && told.contains("stage against")
            && told.contains("best after"),
        "{told}"
    );
    printed(
        here,
        &["train", "short.toml", "--out", "three", "--jobs", "3"],
    );
    let [one, three] = ["one", "three"].map(|folder| here.join(folder));
    for name in [
        "best.onnx",
        "last.onnx",
        "state.bin",
        "updates.csv",
        "evaluations.csv",
        "episodes.csv",
        "digest.txt",
    ] {
        assert!(
            read(&one, name) == read(&three, name),
            "{name} depends on the number of threads"
        );
    }

    // The table contains all samples.
    let updates = String::from_utf8(read(&one, "updates.csv")).unwrap();
    let last: u64 = updates
        .lines()
        .last()
        .unwrap()
        .split(',')
        .next()
        .unwrap()
        .parse()
        .unwrap();
    assert!((12_000..14_000).contains(&last), "{updates}");

    // A finished training run is not started again, and its output is a policy.
    let why = refusal(here, &["train", "short.toml", "--out", "one"]);
    assert!(why.contains("continue it with --resume"), "{why}");
    let text = printed(here, &["policy", "one/best.onnx"]);
    assert!(
        text.contains("squall, version") && text.contains("logits (17)"),
        "{text}"
    );
    let game = scenario("games/surveyor_2v2.toml");
    let result = printed(
        here,
        &[
            "run",
            &game,
            "--in-process",
            "--blue",
            "one/best.toml",
            "--no-record",
        ],
    );
    assert!(result.contains("after 600 s"), "{result}");
}

#[test]
fn a_training_that_stops_within_an_update_says_where_it_continues() {
    let dir = training();
    let file = dir.path().join("short.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    // An update of half a million samples.
    std::fs::write(&file, text.replace("steps = 32", "steps = 65536")).unwrap();
    let mut process = command(&dir, &["train", "short.toml", "--out", "one"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut output = BufReader::new(process.stdout.take().unwrap());
    let mut said = String::new();
    while !said.contains("model of") && output.read_line(&mut said).unwrap() > 0 {}
    let killed = Command::new("kill")
        .args(["-INT", &process.id().to_string()])
        .status();
    assert!(killed.unwrap().success());
    let mut error = process.stderr.take().unwrap();
    error.read_to_string(&mut said).unwrap();
    assert_eq!(process.wait().unwrap().code(), Some(130), "{said}");
    assert!(
        said.contains("stopped during an update; saved 0 samples\n"),
        "{said}"
    );
}

#[test]
fn a_training_goes_on_from_its_state_as_if_it_had_not_stopped() {
    let dir = training();
    let here = dir.path();
    printed(here, &["train", "short.toml", "--out", "whole"]);
    // Simulate a power cut after the first state: the files have later lines, but the state does
    // not.
    let why = refusal(here, &["train", "short.toml", "--out", "cut", "--resume"]);
    assert!(why.contains("state.bin"), "{why}");
    let cut = here.join("cut");
    let mut child = command(here, &["train", "short.toml", "--out", "cut"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    while !cut.join("state.bin").exists() && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // Then stop twice between two states: all work is kept, and the tables keep their lines.
    let samples = || {
        let updates = String::from_utf8(read(&cut, "updates.csv")).unwrap();
        updates
            .lines()
            .skip(1)
            .last()
            .map(|line| line.split(',').next().unwrap().parse().unwrap())
            .unwrap_or(0_u64)
    };
    for _ in 0..2 {
        let until = (samples() + 500).to_string();
        printed(
            here,
            &[
                "train",
                "short.toml",
                "--out",
                "cut",
                "--resume",
                "--until",
                &until,
            ],
        );
        let stopped = samples();
        let told = printed(
            here,
            &[
                "train",
                "short.toml",
                "--out",
                "cut",
                "--resume",
                "--until",
                "0",
            ],
        );
        assert!(
            told.contains(&format!("resuming after {stopped} samples")),
            "{told}"
        );
        assert_eq!(samples(), stopped);
    }
    printed(here, &["train", "short.toml", "--out", "cut", "--resume"]);
    for name in [
        "best.onnx",
        "last.onnx",
        "state.bin",
        "updates.csv",
        "evaluations.csv",
        "episodes.csv",
    ] {
        assert!(
            read(&here.join("whole"), name) == read(&cut, name),
            "{name} differs after --resume"
        );
    }

    // Every changed file is named, and nothing is played.
    for name in [
        "state.bin",
        "updates.csv",
        "evaluations.csv",
        "episodes.csv",
        "sums.csv",
    ] {
        let sound = read(&cut, name);
        let mut flipped = sound.clone();
        let middle = flipped.len() / 2;
        flipped[middle] ^= 1;
        for damaged in [flipped, sound[..middle].to_vec(), vec![]] {
            // Checksums of earlier states are not needed.
            if name == "sums.csv" && damaged.len() == sound.len() {
                continue;
            }
            std::fs::write(cut.join(name), damaged).unwrap();
            let why = refusal(here, &["train", "short.toml", "--out", "cut", "--resume"]);
            assert!(why.contains(name), "{name}: {why}");
        }
        std::fs::write(cut.join(name), sound).unwrap();
    }
}

#[test]
fn each_nth_episode_of_a_training_is_recorded_and_can_be_replayed() {
    let dir = training();
    let here = dir.path();
    printed(here, &["train", "short.toml", "--out", "plain"]);
    printed(
        here,
        &[
            "train",
            "short.toml",
            "--out",
            "seen",
            "--record-every",
            "7",
        ],
    );
    let [plain, seen] = ["plain", "seen"].map(|folder| here.join(folder));
    for name in [
        "best.onnx",
        "last.onnx",
        "state.bin",
        "updates.csv",
        "digest.txt",
    ] {
        assert!(
            read(&plain, name) == read(&seen, name),
            "{name} depends on what is recorded"
        );
    }

    // Both tables list the same episodes, and the second one names a recording for every seventh.
    let [plain, episodes] =
        [&plain, &seen].map(|folder| String::from_utf8(read(folder, "episodes.csv")).unwrap());
    let (of_plain, no_files) = split(&plain);
    let (of_seen, seen_files) = split(&episodes);
    assert_eq!(of_plain, of_seen);
    assert!(
        no_files[1..].iter().all(|file| file.is_empty()) && seen_files[0] == "recording",
        "{episodes}"
    );
    let of_file = of_seen
        .iter()
        .zip(&seen_files)
        .filter(|(_, file)| file.ends_with(".mcap"));
    let named: Vec<(&str, &str)> = of_file
        .map(|(episode, file)| (episode.split(',').nth(2).unwrap(), *file))
        .collect();
    let count = of_seen.len() - 1;
    assert!(
        (count / 10..=count / 4).contains(&named.len()),
        "{} of {count}",
        named.len()
    );
    let file = |entry: std::io::Result<DirEntry>| {
        format!("games/{}", entry.unwrap().file_name().display())
    };
    let files: BTreeSet<String> = std::fs::read_dir(seen.join("games"))
        .unwrap()
        .map(file)
        .collect();
    let told: BTreeSet<String> = named.iter().map(|(_, file)| (*file).to_owned()).collect();
    assert!(
        files == told && told.len() == named.len(),
        "a file for each episode that ended, and no others"
    );
    for (seed, file) in [named[0], named[named.len() - 1]] {
        assert!(
            file.starts_with(&format!("games/{seed}_")),
            "{file} is of seed {seed}"
        );
        let checked = printed(here, &["replay", &format!("seen/{file}"), "--check"]);
        assert!(
            checked.contains("identical: 201 frames to 20.0 s"),
            "{checked}"
        );
    }
}
