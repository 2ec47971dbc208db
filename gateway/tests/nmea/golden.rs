//! Checks sentences against their meanings in `golden.txt`, and tests other sentences that we write
//! or reject.

use crate::bodies;
use crate::sentences::values;
use gateway::nmea::{BoatError, Command, Mode, Sentence};

/// The meaning of a sentence: its kind and the fields with a value. Degrees converted from minutes
/// are not round numbers, so numbers are rounded to ten decimal places.
fn meaning(sentence: &Sentence) -> String {
    let mut words = Vec::<String>::new();
    let mut last = String::new();
    for (field, value) in values(sentence) {
        if ["Some", "None", "LatLon", "TimeOfDay", "Date", "Talker"].contains(&value.as_str()) {
            continue;
        }
        let value = match value.parse::<f64>() {
            // The two letters of a talker.
            Ok(letter) if field == "talker" => char::from(letter as u8).to_string(),
            Ok(number) => ((number * 1e10).round() / 1e10).to_string(),
            Err(_) => value,
        };
        match words.last_mut() {
            Some(talker) if field == "talker" && last == field => talker.push_str(&value),
            Some(_) if field.is_empty() => {}
            _ if field.is_empty() => words.push(value),
            _ => words.push(format!("{field}={value}")),
        }
        last = field;
    }
    words.join(" ")
}

/// The errors in one sentence of `golden.txt`, line by line.
fn wrong(golden: &[&str]) -> Option<String> {
    let line = golden[0];
    let found = if line.starts_with('$') {
        bodies(format!("{line}\r\n").as_bytes())
    } else {
        vec![line.to_owned()]
    };
    let [body] = found.as_slice() else {
        return Some(format!("is {} sentences", found.len()));
    };
    let sentence = match Sentence::parse(body) {
        Ok(sentence) => sentence,
        Err(error) => return Some(error.to_string()),
    };
    let got = meaning(&sentence);
    let line_again = sentence.line();
    let is_written = match golden.get(2).map(|want| want.strip_prefix("written ")) {
        None => true,
        Some(Some("alike")) => line_again == format!("{line}\r\n"),
        Some(Some(other)) if other.contains('*') => line_again == format!("{other}\r\n"),
        Some(Some(other)) => line_again.starts_with(&format!("{other}*")),
        Some(None) => false,
    };
    (golden.get(1) != Some(&got.as_str()) || !is_written)
        .then(|| format!("means\n  {got}\n  written {line_again}"))
}

#[test]
fn sentences_mean_what_is_told_and_are_written_to_the_byte() {
    let mut count = 0;
    let mut failures = Vec::new();
    for paragraph in include_str!("golden.txt").split("\n\n") {
        let golden: Vec<&str> = paragraph
            .lines()
            .map(str::trim)
            .filter(|line| !line.starts_with('#'))
            .collect();
        if golden.is_empty() {
            continue;
        }
        count += 1;
        let found =
            wrong(&golden).or((golden.len() > 3).then(|| "has more than three lines".to_owned()));
        failures.extend(found.map(|found| format!("{} {found}", golden[0])));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(count >= 48, "only {count} sentences in golden.txt");
}

#[test]
fn a_wrong_field_or_an_unknown_sentence_is_named() {
    let lines = include_str!("wrong_fields.txt")
        .lines()
        .filter(|line| !line.starts_with('#'));
    let cases: Vec<_> = lines
        .map(|line| line.split_once(" => ").unwrap_or((line, "")))
        .collect();
    assert!(
        cases.len() >= 50,
        "only {} bodies in wrong_fields.txt",
        cases.len()
    );
    for (body, want) in cases {
        let error = Sentence::parse(body).map_err(|error| error.to_string());
        assert_eq!(error, Err(want.to_owned()), "{body}");
    }
}

fn command(mode: Mode, numbers: [Option<f64>; 3], words: &str) -> Sentence {
    let [heading_deg, thrust, difference] = numbers;
    Sentence::Command(Command {
        mode,
        heading_deg,
        thrust,
        difference,
        words: words.to_owned(),
    })
}

#[test]
fn what_we_write_in_our_own_way() {
    for (sentence, want) in [
        (
            command(Mode::Speed, [Some(90.0), Some(1.943_844), None], ""),
            "$PSEAC,G,90,1.944,,*",
        ),
        (
            command(Mode::Speed, [Some(359.96), Some(2.0), Some(0.0)], ""),
            "$PSEAC,G,0,2,0,*",
        ),
        (
            command(Mode::Heading, [Some(270.25), Some(34.6), None], ""),
            "$PSEAC,C,270.2,35,,*",
        ),
        (
            command(Mode::Heading, [Some(-90.0), Some(-0.4), None], ""),
            "$PSEAC,C,270,0,,*",
        ),
        (
            command(Mode::Thruster, [Some(359.5), Some(49.5), Some(-50.5)], ""),
            "$PSEAC,T,0,50,-50,*",
        ),
        (
            command(
                Mode::Thruster,
                [Some(90.0), Some(40.0), Some(14.166_67)],
                "",
            ),
            "$PSEAC,T,90,40,14,*",
        ),
        (
            command(Mode::FileDownload, [None; 3], ""),
            "$PSEAC,F,000,000,000,*",
        ),
        (
            command(Mode::FileDownload, [Some(12.0), None, None], ""),
            "$PSEAC,F,12,000,000,*",
        ),
        (command(Mode::BootLoader, [None; 3], ""), "$PSEAC,!,,,,*"),
        (
            command(Mode::Standby, [Some(0.0); 3], "A,B*00\r\n$PSEAC"),
            "$PSEAC,L,0,0,0,*",
        ),
        (
            command(Mode::Standby, [Some(0.0); 3], "A,B"),
            "$PSEAC,L,0,0,0,*",
        ),
        (
            command(Mode::Standby, [Some(0.0); 3], "A*B"),
            "$PSEAC,L,0,0,0,*",
        ),
        (
            command(Mode::Standby, [Some(0.0); 3], "$A"),
            "$PSEAC,L,0,0,0,*",
        ),
        (
            command(Mode::Standby, [Some(0.0); 3], "A\n"),
            "$PSEAC,L,0,0,0,*",
        ),
        (
            Sentence::BoatError(BoatError {
                code: "Ü".to_owned(),
            }),
            "$PSEAG,*",
        ),
    ] {
        let got = sentence.line();
        assert!(
            got.starts_with(want),
            "{sentence:?} is {got:?}, expected {want:?}"
        );
    }
}

#[test]
fn samples_that_circulate_with_a_wrong_checksum_are_refused() {
    for line in [
        "$PSEAR,0,000,10,0,000*7F",
        "$PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,,26*71",
        "$PSEAD,1.5,T,2.5,0.5*7A",
        "$PSEAC,T,0,20,-10,*23",
        // The checksum is that of a heading of 058.7.
        "$HCHDG,58.7,,,14.5,W*01",
    ] {
        assert_eq!(
            bodies(format!("{line}\r\n").as_bytes()),
            Vec::<String>::new(),
            "{line}"
        );
    }
}
