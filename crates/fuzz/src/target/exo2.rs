//! The conversation between a sonde and its clients: it gives the same measurements however it is
//! split, and every number has a name.

use super::{Target, in_pieces, mutations};
use gateway::payload::exo2::{Conversation, Measurement, Sonde};

pub(super) const TARGET: Target = Target {
    name: "exo2",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 20, 2000),
};

/// Separates the turns of the conversation.
const TURN: u8 = b'\x1e';

/// Conversations in lines, with echo and prompt, and over HTTP 1.0 and 1.1.
fn seeds() -> Vec<Vec<u8>> {
    let lines = "para\r|para\r\n1 18 212\r\n# |data\r|data\r\n20.5 -7.25 8\r\n# |data\r|data\r20.5 7.25 -99999\r# ";
    let post = "POST /data HTTP/1.1\r\nHost: sonde\r\nContent-Length: 4\r\n\r\npara";
    let get = "GET /data HTTP/1.1\r\nHost: sonde\r\n\r\n";
    let answer = |text: &str| {
        format!(
            "HTTP/1.1 200 OK\r\nContent-Length: {}\r\n\r\n{text}",
            text.len()
        )
    };
    let http = [post, &answer("1 12"), get, &answer("20.5 35.25")].join("|");
    let old = [
        post,
        "HTTP/1.0 200 OK\n\n1 12\n",
        get,
        "HTTP/1.0 200 OK\nDate: 1\n\n20.5 35.25",
    ]
    .join("|");
    let chunked = [
        get,
        "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n4\r\n1 12\r\n0\r\n\r\n",
    ]
    .join("|");
    let all = [lines.to_owned(), http, old, chunked];
    all.into_iter()
        .map(|text| text.replace('|', "\x1e").into_bytes())
        .collect()
}

fn check(bytes: &[u8]) {
    let (whole, sonde) = in_pieces(bytes, |size| measured(bytes, size));
    assert_eq!(whole.len() as u64, sonde.measured);
    assert!(whole.is_empty() || sonde.told > 0);
    for value in whole.iter().flat_map(|measurement| &measurement.values) {
        assert!(
            value.value.is_finite() && value.code > 0 && !value.name.is_empty(),
            "{value:?}"
        );
    }
}

/// The measurements from the turns, each split into pieces of this size.
fn measured(bytes: &[u8], size: usize) -> (Vec<Measurement>, Sonde) {
    let mut sonde = Sonde::default();
    let mut conversation = Conversation::default();
    let mut all = vec![];
    for (i, turn) in bytes.split(|byte| *byte == TURN).enumerate() {
        for piece in turn.chunks(size) {
            all.extend(conversation.read_bytes(i % 2 == 0, piece, &mut sonde));
        }
    }
    all.extend(conversation.end(false, &mut sonde));
    (all, sonde)
}
