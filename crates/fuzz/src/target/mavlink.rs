//! MAVLink frames from boats and ground stations.

use super::{Target, in_pieces, mutations};
use gateway::config::{BoatProtocol, Gateway};
use gateway::emulator::{ArduPilot, FrontSeat};
use gateway::mavlink::{Counts, FRAME_MAX, Framer, Received, Writer};
use gateway::protocol::Protocol;
use primitives::SimTime;

pub(super) const TARGET: Target = Target {
    name: "mavlink",
    seeds,
    change: mutations,
    check,
    allocated_max: (1 << 24, 20_000),
};

/// Frames from a different program, separately and together.
fn seeds() -> Vec<Vec<u8>> {
    let list = include_str!("../../../../gateway/tests/mavlink/golden.txt");
    let lines = list
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter(|(name, _)| *name != "#");
    let bytes = |hex: &str| {
        let digits = hex
            .as_bytes()
            .chunks(2)
            .filter_map(|two| std::str::from_utf8(two).ok());
        digits
            .filter_map(|two| u8::from_str_radix(two, 16).ok())
            .collect::<Vec<u8>>()
    };
    let one_by_one: Vec<Vec<u8>> = lines.map(|(_, hex)| bytes(hex)).collect();
    [one_by_one.concat()]
        .into_iter()
        .chain(one_by_one)
        .collect()
}

fn check(bytes: &[u8]) {
    let (whole, counts) = in_pieces(bytes, |size| framed(bytes.chunks(size)));
    assert_eq!(counts.messages, whole.len() as u64);
    assert!(counts.garbage <= bytes.len() as u64);
    repaired(bytes);
}

fn framed<'a>(pieces: impl IntoIterator<Item = &'a [u8]>) -> (Vec<String>, Counts) {
    let mut framer = Framer::new();
    let mut received = Vec::new();
    // Compared as strings, because NaN does not equal itself.
    pieces
        .into_iter()
        .for_each(|piece| framer.push(piece, &mut |message| received.push(format!("{message:?}"))));
    (received, framer.counts().clone())
}

/// Valid frames with arbitrary payloads of every supported message, all of which boat and ground
/// station must accept.
fn repaired(bytes: &[u8]) {
    let gateway = Gateway {
        protocol: BoatProtocol::Mavlink,
        ..gateway::config::default_gateway()
    };
    let mut protocol = Protocol::new(&gateway);
    let mut boat = ArduPilot::new(
        primitives::LatLon {
            lat_deg: 42.0,
            lon_deg: -71.0,
        },
        None,
    );
    let mut messages = Vec::new();
    let mut framer = Framer::new();
    let now = SimTime::from_s(1.0);
    framer.push(bytes, &mut |Received { message, .. }| {
        messages.push(message)
    });
    let mut out = Vec::new();
    let mut to_boat = Writer::new(255, 190);
    let mut to_us = Writer::new(1, 1);
    for message in &messages {
        out.clear();
        to_boat.write(message, &mut out);
        assert!(out.len() <= FRAME_MAX);
        boat.receive(now, &out);
        out.clear();
        to_us.write(message, &mut out);
        protocol.read(now, &out, &mut |_| {});
    }
    out.clear();
    boat.order(now)
        .check()
        .expect("the order is valid for any message");
    boat.telemetry(now, &mut out);
    protocol.keep_up(now, &mut out);
}
