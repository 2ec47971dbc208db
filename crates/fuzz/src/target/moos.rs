//! Packets of MOOS clients and datagrams of pShare: a stream may be split anywhere, decoded
//! messages survive a round trip, and a database handles any of them.

use super::{Target, in_pieces, mutations};
use moos::database::Database;
use moos::wire::{self, Framer, Kind, Malformed, Msg};

pub(super) const TARGET: Target = Target {
    name: "moos",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 20, 2000),
};

/// Messages of each kind that a database processes, separately and together.
fn seeds() -> Vec<Vec<u8>> {
    let patterns = "AppPattern=p*,VarPattern=NAV_?,Interval=0.1";
    let messages = [
        Msg::number(Kind::TIMING, "_async_timing", 0.0, 1e9),
        Msg::text(Kind::NOTIFY, "DEPLOY", "true", 1e9),
        Msg::number(Kind::NOTIFY, "NAV_X", -7.25, 1e9),
        Msg::number(Kind::REGISTER, "NAV_X", 0.5, 1e9),
        Msg::number(Kind::UNREGISTER, "NAV_X", 0.0, 1e9),
        Msg::text(Kind::WILDCARD, "pHelmIvP", patterns, 1e9),
        Msg::text(Kind::WILDCARD_END, "pHelmIvP", patterns, 1e9),
        Msg::text(Kind::REQUEST, "ALL", "", 1e9),
        Msg::text(Kind::REQUEST, "VAR_SUMMARY", "", 1e9),
    ];
    let one_by_one = messages
        .iter()
        .map(|msg| wire::packet_of(std::slice::from_ref(msg)));
    let datagram = wire::packet_of(&messages[1..2])[9..].to_vec();
    let in_a_row: Vec<u8> = one_by_one.clone().flatten().collect();
    one_by_one
        .chain([wire::packet_of(&messages), in_a_row, datagram])
        .collect()
}

fn check(bytes: &[u8]) {
    let mut database = Database::new("blue_one", ["DEPLOY".to_owned()].into(), 1e9);
    let (_, mail) = database
        .admit(&Msg::text(Kind::DATA, "", "pFuzz", 1e9), 1e9)
        .expect("a name that is free");
    // Compared as strings, because NaN does not equal itself.
    let (_, packets) = in_pieces(bytes, |size| {
        let (packets, end) = framed(bytes.chunks(size));
        (format!("{packets:?} {end:?}"), packets.len())
    });
    let (read, _) = framed([bytes]);
    assert_eq!(read.len(), packets);
    for messages in read {
        let written = wire::packet_of(&messages);
        let (again, end) = framed([written.as_slice()]);
        assert_eq!(
            (format!("{again:?}"), end),
            (format!("[{messages:?}]"), None)
        );
        database.receive("pFuzz", messages, 1e9);
    }
    if let Some(packet) = mail.visit(|mail| mail.take_packet(None)) {
        assert_eq!(framed([packet.as_slice()]).1, None, "its own mail");
    }
    if let Ok(msg) = wire::decode(bytes) {
        let mut written = Vec::new();
        wire::encode(&msg, &mut written);
        assert_eq!(
            format!("{:?}", wire::decode(&written)),
            format!("{:?}", Ok::<_, Malformed>(msg))
        );
    }
}

/// The packets in chunks of a stream, up to the first malformed one.
fn framed<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> (Vec<Vec<Msg>>, Option<Malformed>) {
    let mut framer = Framer::default();
    let mut packets = Vec::new();
    for piece in pieces {
        framer.push(piece);
        loop {
            match framer.next_packet() {
                Ok(Some(packet)) => packets.push(packet),
                Ok(None) => break,
                Err(error) => return (packets, Some(error)),
            }
        }
    }
    (packets, None)
}
