//! Tests the NMEA framer under noise: it loses no sentence, invents none, and uses bounded memory.

use crate::bodies;
use gateway::nmea::{ACCEPTED_MAX, Counts, Framer, checksum, with_checksum};
use proptest::prelude::*;

const GGA: &str = "$GPGGA,150502.00,4221.50616,N,07105.24688,W,2,11,0.98,5.5,M,-33.2,M,,*62\r\n";
const COMMAND: &str = "$PSEAC,T,0,20,-10,*22\r\n";

/// The expected result of a framer, computed from the whole stream: split at every `$`, then check
/// each part.
fn model(bytes: &[u8]) -> (Vec<String>, Counts) {
    let mut found = Vec::new();
    let mut counts = Counts::default();
    let noise = |bytes: &[u8]| bytes.iter().filter(|byte| !b"\r\n".contains(byte)).count() as u64;
    let mut parts = bytes.split(|byte| *byte == b'$').peekable();
    counts.garbage += noise(parts.next().expect("a split has a first part"));
    while let Some(part) = parts.next() {
        // NULs and tabs after a whole checksum are padding.
        let part = part.iter().fold(Vec::new(), |mut kept: Vec<u8>, byte| {
            kept.extend((!b"\0\t".contains(byte) || !is_whole(&kept)).then_some(*byte));
            kept
        });
        let end = part
            .iter()
            .position(|byte| !(b' '..=b'~').contains(byte))
            .unwrap_or(part.len());
        let (content, rest) = part.split_at(end.min(ACCEPTED_MAX - 3));
        counts.garbage += noise(rest);
        match rest.first() {
            None if parts.peek().is_some() => judge(content, &mut found, &mut counts),
            None => {}
            Some(b'\r' | b'\n') => judge(content, &mut found, &mut counts),
            Some(b' '..=b'~') => counts.overlong += 1,
            Some(_) => counts.broken += 1,
        }
    }
    (found, counts)
}

/// Whether text ends with a checksum.
fn is_whole(content: &[u8]) -> bool {
    let mut counts = Counts::default();
    if content.iter().all(|byte| (b' '..=b'~').contains(byte)) && content.len() <= ACCEPTED_MAX - 3
    {
        judge(content, &mut vec![], &mut counts);
    }
    counts.sentences + counts.bad_checksum > 0
}

fn judge(content: &[u8], found: &mut Vec<String>, counts: &mut Counts) {
    let text = String::from_utf8(content.to_vec()).expect("only ASCII is left");
    let text = text.trim_end_matches(' ');
    let stated = text
        .split_once('*')
        .filter(|(_, digits)| digits.len() == 2 && !digits.contains('+'));
    match stated.and_then(|(body, digits)| Some((body, u8::from_str_radix(digits, 16).ok()?))) {
        None => counts.broken += 1,
        Some((body, sum)) if sum != checksum(body.as_bytes()) => counts.bad_checksum += 1,
        Some((body, _)) => {
            counts.sentences += 1;
            found.push(body.to_owned());
        }
    }
}

/// A valid sentence of `length` bytes.
fn long(length: usize) -> String {
    with_checksum(&"A".repeat(length - 6))
}

fn framed(pieces: impl IntoIterator<Item = impl AsRef<[u8]>>) -> (Vec<String>, Counts) {
    let mut framer = Framer::new();
    let mut found = Vec::new();
    for piece in pieces {
        framer.push(piece.as_ref(), &mut |body| found.push(body.to_owned()));
    }
    (found, framer.counts())
}

/// Streams of sentences, fragments and noise.
fn stream() -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        4 => Just(GGA.as_bytes().to_vec()),
        4 => Just(COMMAND.as_bytes().to_vec()),
        2 => (6..400_usize).prop_map(|length| long(length).into_bytes()),
        2 => prop::collection::vec(prop::sample::select(b"$*,\r\n0AaF~ \x00\x7f\x80+".to_vec()), 0..12),
        1 => prop::collection::vec(any::<u8>(), 0..40),
        2 => (any::<prop::sample::Index>(), any::<u8>()).prop_map(|(at, byte)| {
            let mut line = GGA.as_bytes().to_vec();
            let at = at.index(line.len());
            line[at] = byte;
            line
        }),
        1 => (0..GGA.len()).prop_map(|end| GGA.as_bytes()[..end].to_vec()),
    ];
    prop::collection::vec(piece, 0..8).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_byte_is_accounted_for(bytes in stream()) {
        let (found, counts) = framed([&bytes]);
        prop_assert_eq!((found, counts), model(&bytes));
        let begun = bytes.iter().filter(|byte| **byte == b'$').count() as u64;
        let ended = counts.sentences + counts.bad_checksum + counts.overlong + counts.broken;
        prop_assert!(begun == ended || begun == ended + 1, "{begun} begun, {ended} ended");
    }

    #[test]
    fn arbitrary_bytes_are_accounted_for_too(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        prop_assert_eq!(framed([&bytes]), model(&bytes));
    }

    #[test]
    fn it_does_not_matter_how_a_stream_is_cut(bytes in stream(), sizes in prop::collection::vec(0..50_usize, 1..20)) {
        let mut rest = bytes.as_slice();
        let mut pieces = Vec::new();
        for size in sizes.iter().cycle().take(2000) {
            let (piece, later) = rest.split_at(rest.len().min(*size));
            pieces.push(piece);
            rest = later;
        }
        pieces.push(rest);
        prop_assert_eq!(framed(pieces), framed([&bytes]));
        prop_assert_eq!(framed(bytes.chunks(1)), framed([&bytes]));
    }

    #[test]
    fn after_any_noise_the_next_sentence_is_found(noise in prop::collection::vec(any::<u8>(), 0..600)) {
        let bytes = [noise.as_slice(), COMMAND.as_bytes()].concat();
        let found = bodies(&bytes);
        prop_assert_eq!(found.last().map(String::as_str), Some("PSEAC,T,0,20,-10,"));
    }

    #[test]
    fn one_flipped_byte_never_makes_another_sentence(at in 1..COMMAND.len() - 2, byte in any::<u8>()) {
        let mut line = COMMAND.as_bytes().to_vec();
        line[at] = byte;
        for body in bodies(&line) {
            prop_assert_eq!(body, "PSEAC,T,0,20,-10,");
        }
    }
}

#[test]
fn lines_end_with_cr_or_lf_or_both() {
    for end in ["\r\n", "\n", "\r", "\n\r", "\r\n\r\n"] {
        let stream = format!("$PSEAG,N*22{end}$PSEAG,N*22{end}");
        assert_eq!(
            framed([&stream]).1,
            Counts {
                sentences: 2,
                ..Counts::default()
            },
            "{end:?}"
        );
    }
    assert_eq!(
        framed(["$PSEAG,N*22"]).1,
        Counts::default(),
        "a line without its end is still incomplete"
    );
    assert_eq!(
        bodies(b"$PSEAC,T,0,20,-10,THR_ON*5f\r\n").len(),
        0,
        "a wrong checksum in lower case"
    );
    assert_eq!(
        bodies(b"$HCHDG,58.7,,,,*78\r\n"),
        ["HCHDG,58.7,,,,"],
        "a right one"
    );
}

#[test]
fn each_fault_has_its_count() {
    let overlong = format!("${}{COMMAND}", "x".repeat(1000));
    // The command that gpsd sends to identify the device.
    let probes =
        b"$PGRMCE*0E\r\n$PSRF100,0,4800,8,1,0*0F\r\n\xb5\x62\x06\x8e\x00\x00\xff\xb5\x62\x0a\x04\x00\x00\x0e\x34";
    let probes = [probes.as_slice(), COMMAND.as_bytes()].concat();
    // Counts of sentences, wrong checksums, overlong sentences, broken ones, and bytes of garbage.
    let cases: [(&[u8], [u64; 5]); 16] = [
        (b"$PSEAG,N*23\r\n", [0, 1, 0, 0, 0]),
        (b"$PSEAG,N\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG,N*2\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG,N*222\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG,N*2G\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG,N*+2\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG*N*22\r\n", [0, 0, 0, 1, 0]),
        (b"$PSEAG,N*22\x00x\r\n", [0, 0, 0, 1, 0]),
        (b"$\r\n", [0, 0, 0, 1, 0]),
        (b"$PSE$PSEAG,N*22\r\n", [1, 0, 0, 1, 0]),
        (b"$PSE\x00AG,N*22\r\n", [0, 0, 0, 1, 8]),
        (b"$PSEAG,\xc3\x9c*22\r\n", [0, 0, 0, 1, 5]),
        (b"\r\n\n\r", [0, 0, 0, 0, 0]),
        (b"!AIVDM,1\r\n$PSEAG,N*22\r\n\x8e", [1, 0, 0, 0, 9]),
        (&probes, [3, 0, 0, 0, 14]),
        (overlong.as_bytes(), [1, 0, 1, 0, 1000 - 253]),
    ];
    for (bytes, [sentences, bad_checksum, overlong, broken, garbage]) in cases {
        let want = Counts {
            sentences,
            bad_checksum,
            overlong,
            garbage,
            broken,
        };
        let (found, counts) = framed([bytes]);
        assert_eq!(counts, want, "{}", bytes.escape_ascii());
        assert_eq!((found, counts), model(bytes), "{}", bytes.escape_ascii());
    }
}

#[test]
fn padding_after_the_checksum_and_a_missing_line_end_do_no_harm() {
    for end in [" \r\n", "\0\r\n", "\t\0\0 \n", "", " ", "\0"] {
        let stream = format!("$PSEAG,N*22{end}$PSEAG,N*22{end}$");
        assert_eq!(
            framed([&stream]),
            framed(["$PSEAG,N*22\r\n$PSEAG,N*22\r\n$"]),
            "{end:?}"
        );
        assert_eq!(framed([&stream]).1.sentences, 2, "{end:?}");
    }
}

#[test]
fn the_last_rejected_line_is_kept_with_the_reason() {
    for (stream, line, why) in [
        ("$PSEAG,N\r\n$PSEAG,N*22\r\n", "$PSEAG,N", "has no checksum"),
        ("$PSEAG,N*2$", "$PSEAG,N*2", "has no checksum"),
        ("$PSEAG,N*23\r\n", "$PSEAG,N*23", "has a wrong checksum"),
        (
            "$PSE\0AG,N*22\r\n",
            "$PSE",
            "is interrupted by a non-text byte",
        ),
    ] {
        let mut framer = Framer::new();
        framer.push(stream.as_bytes(), &mut |_| {});
        let rejected = framer.rejected().expect("a line was rejected");
        assert_eq!((rejected.line.as_str(), rejected.why), (line, why));
    }
}

#[test]
fn a_sentence_of_256_bytes_is_read_and_one_of_257_is_not() {
    for (length, want) in [
        (ACCEPTED_MAX, (1, 0)),
        (ACCEPTED_MAX + 1, (0, 1)),
        (100_000, (0, 1)),
    ] {
        let (found, counts) = framed([&long(length)]);
        assert_eq!((counts.sentences, counts.overlong), want, "{length} bytes");
        assert_eq!(found.len() as u64, counts.sentences);
    }
}
