//! Tests the MAVLink framer with frames from a different program, split anywhere or corrupted, and
//! with frames that must be rejected.

use gateway::mavlink::dialect::{
    GpsFixType, HEARTBEAT_DATA, MavMessage, MavModeFlag, MavType, PARAM_VALUE_DATA,
};
use gateway::mavlink::{FRAME_MAX, Framer, Received, Writer};
use proptest::prelude::*;
use std::collections::BTreeMap;

fn golden() -> BTreeMap<&'static str, Vec<u8>> {
    let lines = include_str!("golden.txt")
        .lines()
        .filter(|line| !line.starts_with('#'));
    let bytes = |hex: &str| {
        (0..hex.len() / 2)
            .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).expect("two digits"))
            .collect()
    };
    lines
        .map(|line| line.split_once(' ').expect("name and frame"))
        .map(|(name, hex)| (name, bytes(hex)))
        .collect()
}

fn read(framer: &mut Framer, bytes: &[u8]) -> Vec<Received> {
    let mut received = Vec::new();
    framer.push(bytes, &mut |message| received.push(message));
    received
}

#[test]
fn frames_of_pymavlink_are_read_with_every_field() {
    for (name, frame) in golden() {
        let mut framer = Framer::new();
        let received = read(&mut framer, &frame);
        let [
            Received {
                system: 1,
                component: 1,
                message,
            },
        ] = &received[..]
        else {
            panic!("{name}: {received:?}")
        };
        match (name.trim_end_matches("_v1"), message) {
            ("heartbeat", MavMessage::HEARTBEAT(heartbeat)) => {
                assert_eq!(
                    (heartbeat.custom_mode, heartbeat.mavtype),
                    (15, MavType::MAV_TYPE_SURFACE_BOAT)
                );
                assert!(
                    heartbeat
                        .base_mode
                        .contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED)
                );
            }
            ("global_position_int", MavMessage::GLOBAL_POSITION_INT(position)) => {
                assert_eq!(
                    (position.lat, position.lon, position.time_boot_ms),
                    (423_584_360, -710_874_480, 123_456)
                );
                assert_eq!((position.vx, position.vy, position.hdg), (123, -45, 9000));
            }
            ("gps_raw_int", MavMessage::GPS_RAW_INT(gps)) => {
                assert_eq!(
                    (gps.fix_type, gps.eph),
                    (GpsFixType::GPS_FIX_TYPE_RTK_FIXED, 98)
                );
                assert_eq!(gps.satellites_visible, 11);
            }
            ("attitude", MavMessage::ATTITUDE(attitude)) => {
                assert_eq!((attitude.yaw, attitude.yawspeed), (1.5, -0.25));
            }
            ("statustext", MavMessage::STATUSTEXT(status)) => {
                assert_eq!(status.text.to_str(), Ok("PreArm: Compass not calibrated"));
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn what_is_written_is_pymavlinks_frame() {
    let mut writer = Writer::new(1, 1);
    let (golden, heartbeat) = (golden(), {
        let mut framer = Framer::new();
        read(&mut framer, &self::golden()["heartbeat"])
            .remove(0)
            .message
    });
    let mut out = Vec::new();
    for _ in 0..8 {
        out.clear();
        writer.write(&heartbeat, &mut out);
    }
    assert_eq!(out, golden["heartbeat"], "the eighth has the number 7");
}

#[test]
fn a_frame_that_a_wrong_length_covers_is_found() {
    let golden = golden();
    let mut damaged = golden["attitude"].clone();
    damaged[1] = 200;
    let mut framer = Framer::new();
    let stream = [
        &damaged[..],
        &golden["heartbeat"],
        &golden["gps_raw_int"],
        &[0; FRAME_MAX],
    ]
    .concat();
    let received = read(&mut framer, &stream);
    assert_eq!(received.len(), 2, "{received:?}");
    assert_eq!(
        (framer.counts().messages, framer.counts().bad_checksum),
        (2, 1)
    );
}

#[test]
fn unknown_messages_and_values_are_counted_and_left() {
    let golden = golden();
    let mut unknown = golden["attitude"].clone();
    unknown[7] = 163;
    let mut framer = Framer::new();
    assert_eq!(
        read(&mut framer, &[&unknown[..], &golden["heartbeat"]].concat()).len(),
        1
    );
    assert_eq!(framer.counts().unknown, [(163, 1)].into());
    // An unknown flag may change the frame's layout, so the frame is rejected.
    let mut flagged = golden["heartbeat"].clone();
    flagged[2] = 2;
    let mut framer = Framer::new();
    assert_eq!(
        read(&mut framer, &[&flagged[..], &golden["heartbeat"]].concat()).len(),
        1
    );
    assert_eq!(framer.counts().bad_checksum, 0);
}

/// Bytes that begin like a frame of an unknown message with a stated length of 267 bytes.
const FALSE_START: [u8; 10] = [0xFD, 0xFF, 0, 0, 1, 1, 1, 0xAA, 0xAA, 0xAA];

#[test]
fn noise_like_the_header_of_an_unknown_message_swallows_and_delays_no_frame() {
    let heartbeat = golden()["heartbeat"].clone();
    // Try noise of any length, so that the first frame lies within the stated length, across its
    // end, or after it.
    for noise in 0..=FRAME_MAX {
        let stream = [&FALSE_START[..], &vec![0xAA; noise], &heartbeat, &heartbeat].concat();
        for piece in [1, stream.len()] {
            let mut framer = Framer::new();
            let count: usize = stream
                .chunks(piece)
                .map(|piece| read(&mut framer, piece).len())
                .sum();
            assert_eq!(
                count,
                2,
                "{noise} bytes of noise in pieces of {piece}: {:?}",
                framer.counts()
            );
            // Noise that ends where the next frame begins passes for an unknown message.
            if FALSE_START.len() + noise != 267 {
                assert_eq!(framer.counts().garbage, (FALSE_START.len() + noise) as u64);
            }
        }
        let first = [&FALSE_START[..], &vec![0xAA; noise], &heartbeat].concat();
        assert_eq!(
            read(&mut Framer::new(), &first).len(),
            1,
            "at once, after {noise} bytes of noise"
        );
    }
}

proptest! {
    #[test]
    fn any_split_and_any_noise_between_frames_changes_nothing(
        cuts in proptest::collection::vec(1_usize..40, 1..40),
        noise in proptest::collection::vec(0_u8..0xFD, 0..30),
    ) {
        let frames = golden();
        let mut stream = Vec::new();
        for frame in frames.values() {
            stream.extend(&noise);
            stream.extend(frame);
        }
        let mut framer = Framer::new();
        let mut count = 0;
        let mut rest = &stream[..];
        for cut in cuts.iter().cycle() {
            let (piece, after) = rest.split_at((*cut).min(rest.len()));
            count += read(&mut framer, piece).len();
            rest = after;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(count, frames.len());
        prop_assert_eq!(framer.counts().garbage, (noise.len() * frames.len()) as u64);
    }

    #[test]
    fn no_bytes_are_too_much_and_the_next_frames_are_read(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        let mut framer = Framer::new();
        read(&mut framer, &bytes);
        framer.interrupt();
        let heartbeat = golden()["heartbeat"].clone();
        prop_assert_eq!(read(&mut framer, &heartbeat).len(), 1);
    }

    #[test]
    fn what_is_written_is_read_again(value in any::<f32>().prop_filter("it equals itself", |x| !x.is_nan()), mode in any::<u32>()) {
        let messages = [
            MavMessage::HEARTBEAT(HEARTBEAT_DATA { custom_mode: mode, ..HEARTBEAT_DATA::default() }),
            MavMessage::PARAM_VALUE(PARAM_VALUE_DATA { param_value: value, ..PARAM_VALUE_DATA::default() }),
        ];
        let mut writer = Writer::new(9, 8);
        let mut framer = Framer::new();
        let mut out = Vec::new();
        messages.iter().for_each(|message| writer.write(message, &mut out));
        let received = read(&mut framer, &out);
        prop_assert!(received.iter().all(|received| (received.system, received.component) == (9, 8)));
        let got: Vec<MavMessage> = received.into_iter().map(|received| received.message).collect();
        prop_assert_eq!(&got[..], &messages[..]);
    }
}
