//! NMEA sentences from boats.

use super::{Target, in_pieces, mutations};
use gateway::nmea::{ACCEPTED_MAX, Counts, EMITTED_MAX, Framer, Sentence, checksum};

/// Sentence addresses that the codec understands; random fields would rarely match one.
const ADDRESSES: [&str; 16] = [
    "PSEAC", "PSEAA", "PSEAB", "PSEAD", "PSEAG", "PSEAR", "OIWPL", "GPGGA", "GPRMC", "GPVTG",
    "GPHDT", "HCHDG", "GPZDA", "VCGLL", "WIMWV", "VWVHW",
];

pub(super) const TARGET: Target = Target {
    name: "nmea",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 20, 2000),
};

/// Sentences from real programs and manuals, separately and together.
fn seeds() -> Vec<Vec<u8>> {
    let list = include_str!("../../../../gateway/tests/nmea/golden.txt");
    let sentences = list
        .lines()
        .filter(|line| line.starts_with(|c: char| c == '$' || c.is_ascii_uppercase()));
    let wire = |sentence: &str| {
        if sentence.starts_with('$') {
            format!("{sentence}\r\n")
        } else {
            framed_body(sentence)
        }
    };
    let one_by_one: Vec<String> = sentences.map(wire).collect();
    let in_a_row = one_by_one.chunks(3).map(<[String]>::concat);
    let probe = "?WATCH={\"enable\":true,\"nmea\":true}\n".to_owned();
    in_a_row
        .chain(one_by_one.clone())
        .chain([probe])
        .map(String::into_bytes)
        .collect()
}

fn framed_body(body: &str) -> String {
    format!("${body}*{:02X}\r\n", checksum(body.as_bytes()))
}

fn check(bytes: &[u8]) {
    stream(bytes);
    for line in bytes.split(|byte| b"\r\n".contains(byte)) {
        repaired(line);
    }
    let text = String::from_utf8_lossy(bytes);
    read(&text);
    let address =
        ADDRESSES[usize::from(bytes.first().copied().unwrap_or_default()) % ADDRESSES.len()];
    read(&format!("{address},{text}"));
}

/// A byte stream yields the same sentences however it is split, and every `$` is counted.
fn stream(bytes: &[u8]) {
    let (whole, counts) = in_pieces(bytes, |size| framed(bytes.chunks(size)));
    let begun = bytes.iter().filter(|byte| **byte == b'$').count() as u64;
    let ended = counts.sentences + counts.bad_checksum + counts.overlong + counts.broken;
    assert!(
        begun == ended || begun == ended + 1,
        "{begun} begun, {counts:?}"
    );
    assert!(counts.garbage <= bytes.len() as u64 - begun);
    assert_eq!(counts.sentences, whole.len() as u64);
    for body in whole {
        assert!(
            body.is_ascii()
                && !body.contains(['$', '*', '\r', '\n'])
                && body.len() + 6 <= ACCEPTED_MAX
        );
        read(&body);
    }
}

/// A line with a correct checksum must be accepted.
fn repaired(line: &[u8]) {
    let plain = |byte: &&u8| (b' '..=b'~').contains(*byte) && !b"$*".contains(*byte);
    let body: Vec<u8> = line
        .iter()
        .filter(plain)
        .take(ACCEPTED_MAX - 6)
        .copied()
        .collect();
    let body = String::from_utf8_lossy(&body).into_owned();
    let (found, counts) = framed([b"noise".as_slice(), framed_body(&body).as_bytes()]);
    assert_eq!(
        counts,
        Counts {
            sentences: 1,
            garbage: 5,
            ..Counts::default()
        }
    );
    assert_eq!(found, [body]);
    read(&found[0]);
}

/// A parsed sentence survives a round trip, after which it no longer changes.
fn read(body: &str) {
    let Ok(sentence) = Sentence::parse(body) else {
        return;
    };
    let Some(again) = reread(&sentence) else {
        return;
    };
    let settled = reread(&again).expect("a written sentence is short");
    assert_eq!(settled.line(), again.line(), "{body}");
}

/// The sentence after a round trip. `None` if a required field was still empty.
fn reread(sentence: &Sentence) -> Option<Sentence> {
    let wire = sentence.line();
    assert!(wire.len() <= EMITTED_MAX, "{} bytes: {wire}", wire.len());
    let (found, counts) = framed([wire.as_bytes()]);
    assert_eq!(
        counts,
        Counts {
            sentences: 1,
            ..Counts::default()
        },
        "{wire}"
    );
    match Sentence::parse(&found[0]) {
        Ok(back) => Some(back),
        Err(_)
            if matches!(
                sentence,
                Sentence::MissionSettings(_) | Sentence::Waypoint(_)
            ) =>
        {
            None
        }
        Err(error) => panic!("cannot read {wire} from {sentence:?}: {error}"),
    }
}

fn framed<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> (Vec<String>, Counts) {
    let mut framer = Framer::new();
    let mut found = Vec::new();
    for piece in pieces {
        framer.push(piece, &mut |body| found.push(body.to_owned()));
    }
    (found, framer.counts())
}
