//! Our codec as a peer of `pynmea2_check.py`: `peer write` writes sentences of every kind with
//! their values, `peer read` prints the values that it reads from each line of its input.
//!
//! The values of a sentence form a line of tab-separated `name=value` pairs, as `Debug` prints
//! them.

#[allow(dead_code, reason = "the tests of the codec use more of it")]
#[path = "../../tests/nmea/sentences.rs"]
mod sentences;

use gateway::nmea::{Command, Framer, Mode, Sentence};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use sentences::{Domain, on_the_globe, sentences};
use std::io::{BufRead, Write};

/// Number of sentences that `write` writes.
const COUNT: u32 = 3200;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("write") => write(),
        Some("read") => read(),
        _ => eprintln!("usage: peer write | peer read"),
    }
}

fn write() {
    let domain = Domain {
        angles: (0.0..359.4).boxed(),
        sizes: (0.0..60.0).boxed(),
        signed: (-50.0..50.0).boxed(),
        texts: "[A-Z_]{0,6}".boxed(),
        places: on_the_globe(),
        years: 2000..2061,
        day_ms: 0..86_400_000,
    };
    let is_download = |s: &Sentence| {
        matches!(
            s,
            Sentence::Command(Command {
                mode: Mode::FileDownload,
                ..
            })
        )
    };
    let sentences =
        sentences(&domain).prop_filter("a download writes None as 0", |s| !is_download(s));
    let mut runner = TestRunner::deterministic();
    let mut out = std::io::stdout().lock();
    for _ in 0..COUNT {
        let sentence = sentences
            .new_tree(&mut runner)
            .expect("most are not downloads")
            .current();
        writeln!(out, "{}\t{}", sentence.line().trim_end(), values(&sentence))
            .expect("standard output is open");
    }
}

fn read() {
    let mut framer = Framer::new();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("the input is lines of text") + "\r\n";
        let mut answer = "not a sentence".to_owned();
        framer.push(line.as_bytes(), &mut |body| {
            answer = Sentence::parse(body)
                .map_or_else(|error| error.to_string(), |sentence| values(&sentence));
        });
        println!("{answer}");
    }
}

fn values(sentence: &Sentence) -> String {
    let pairs = sentences::values(sentence)
        .into_iter()
        .map(|(name, value)| format!("{name}={value}"));
    pairs.collect::<Vec<_>>().join("\t")
}
