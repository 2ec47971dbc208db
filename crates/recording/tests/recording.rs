//! Recordings: round trips, even of a truncated file, and rejection of other files.

use messages::helm::HelmQuestion;
use messages::input::{Input, Inputs};
use messages::picture::Nav;
use messages::water::{PlaneWave, Water};
use messages::{Frame, GameInfo, Message, Order, Orders, Picture, Stamp, VehicleTruth};
use primitives::{SimTime, VehicleId};
use recording::{
    Decision, Ending, Entry, Header, NewFile, Recorder, Recording, RecordingError, Writer,
};
use scenario::Outcome;
use std::io::Cursor;
use std::path::Path;

fn header() -> Header {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
    let wave = PlaneWave {
        amplitude_m: 0.1,
        wavenumber_rad_m: 0.3,
        ..PlaneWave::default()
    };
    Header {
        commit: "c0ffee".to_owned(),
        game: "pav01-1".to_owned(),
        began_utc_ns: 1_700_000_000_000_000_000,
        info: GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario,
        },
        water: Water { waves: vec![wave] },
    }
}

fn ending() -> Ending {
    let outcome = Outcome {
        seed: 1,
        digest: "ab".to_owned(),
        duration_s: 1.0,
        ticks: 20,
        ..Outcome::default()
    };
    Ending {
        outcome,
        run: serde_json::json!({"pace": "lockstep"}),
        dropped: 0,
    }
}

/// The decision `seq`, with the first boat at `north_m`.
fn decision(seq: u64, north_m: f64) -> Decision {
    let at = |seq: u64, version| Stamp {
        valid_ns: SimTime(seq as i64 * 100_000_000),
        seq,
        version,
    };
    let nav = Nav {
        north_m,
        ..Nav::default()
    };
    let vehicles = vec![
        VehicleTruth {
            nav,
            ..VehicleTruth::default()
        };
        4
    ];
    let frame = Frame {
        stamp: at(seq, Frame::VERSION),
        vehicles,
        score: vec![0, 0],
        ..Frame::default()
    }
    .into();
    let Some(before) = seq.checked_sub(1) else {
        return Decision {
            frame,
            ..Decision::default()
        };
    };
    let picture = |team| Picture {
        stamp: at(before, Picture::VERSION),
        team,
        ..Picture::default()
    };
    let order = Order::Steer {
        heading_rad: north_m,
        speed_m_s: 1.0 / 3.0,
    };
    let inputs = vec![
        Input::Pictured,
        Input::Ordered {
            vehicle: VehicleId(1),
            order,
            given_at: SimTime(7),
        },
    ];
    Decision {
        frame,
        pictures: vec![picture(0), picture(1)],
        inputs,
    }
}

fn status() -> Entry {
    let bytes = serde_json::to_vec(&HelmQuestion { functions: true }).expect("JSON");
    Entry::Message {
        topic: "status/blue_one".to_owned(),
        schema: None,
        bytes,
        at: SimTime(50_000_000),
    }
}

/// A recording of a few decisions; `north_m` are the positions of the first boat.
fn recorded(north_m: &[f64]) -> Vec<u8> {
    let mut writer =
        Writer::begin(Cursor::new(Vec::new()), &header().opening()).expect("it begins");
    for (seq, north_m) in north_m.iter().enumerate() {
        writer
            .write(
                &Entry::Decision(Box::new(decision(seq as u64, *north_m))),
                7 + seq as u64,
            )
            .expect("it is written");
        if seq == 1 {
            writer.write(&status(), 8).expect("it is written");
        }
        if seq % 3 == 2 {
            writer.flush().expect("it is flushed");
        }
    }
    writer.end(ending().facts()).expect("it ends").into_inner()
}

#[test]
fn what_is_recorded_is_read_again() {
    let recording =
        Recording::of(recorded(&[1.0, 2.0, 3.0, 4.0])).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(recording.header(), &header());
    assert_eq!(recording.ending(), Some(&ending()));
    assert!(!recording.is_cut());
    let frames: Vec<Frame> = recording
        .frames()
        .collect::<Result<_, _>>()
        .unwrap_or_else(|e| panic!("{e}"));
    let want: Vec<Frame> = (0..4)
        .map(|seq| Frame::clone(&decision(seq, seq as f64 + 1.0).frame))
        .collect();
    assert_eq!(frames, want);
    let message = recording.frame(2);
    assert_eq!(
        (message.topic, message.number, message.at, message.utc_ns),
        ("frame", 2, SimTime(200_000_000), 9)
    );
    assert_eq!(message.schema, Some("squall_msgs/msg/Frame"));
    let inputs: Vec<Inputs> = recording
        .bag()
        .on("inputs")
        .map(|message| message.read().expect("inputs"))
        .collect();
    let given = |inputs: &Inputs| {
        inputs
            .inputs
            .iter()
            .map(|record| record.input().expect("known"))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        inputs
            .iter()
            .map(|inputs| inputs.stamp.seq)
            .collect::<Vec<_>>(),
        [0, 1, 2, 3]
    );
    assert_eq!(given(&inputs[2]), decision(2, 3.0).inputs);
    let topics: Vec<(&str, usize)> = recording.bag().topics().into_iter().collect();
    let want = [
        ("frame", 4),
        ("inputs", 4),
        ("picture/blue", 3),
        ("picture/red", 3),
        ("status/blue_one", 1),
    ];
    assert_eq!(topics, want);
    let Entry::Message { bytes, .. } = status() else {
        panic!("it is a message")
    };
    let message = recording
        .bag()
        .on("status/blue_one")
        .next()
        .expect("it is there");
    assert_eq!((&message.bytes, message.schema), (&bytes, None));
    assert!(matches!(
        message.read::<Orders>(),
        Err(RecordingError::Damaged { .. })
    ));
    assert_eq!(recording.bag().on("whales").count(), 0);
}

#[test]
fn the_file_is_one_that_the_library_reads() {
    let bytes = recorded(&[1.0, 2.0, 3.0, 4.0]);
    let summary = mcap::Summary::read(&bytes)
        .expect("a summary")
        .expect("a summary");
    assert!(
        summary.chunk_indexes.len() > 1
            && summary
                .stats
                .as_ref()
                .is_some_and(|stats| stats.message_count == 15)
    );
    let mut count = 0;
    for message in mcap::MessageStream::new(&bytes).expect("it is MCAP") {
        let message = message.expect("a message");
        count += 1;
        let schema = message.channel.schema.as_ref().expect("each has a schema");
        let encodings = (
            message.channel.message_encoding.as_str(),
            schema.encoding.as_str(),
        );
        assert_eq!(
            encodings,
            ("cdr", "ros2msg"),
            "the profile ros2 has no others"
        );
        assert!(
            !schema.data.is_empty()
                && message
                    .channel
                    .metadata
                    .contains_key("offered_qos_profiles")
        );
    }
    assert_eq!(count, 15);
}

/// Topic, number and content of every message.
fn all_of(recording: &Recording) -> Vec<(String, u32, Vec<u8>)> {
    recording
        .bag()
        .messages()
        .map(|message| (message.topic.to_owned(), message.number, message.bytes))
        .collect()
}

#[test]
fn any_message_of_many_is_found_in_any_order() {
    let mut writer =
        Writer::begin(Cursor::new(Vec::new()), &header().opening()).expect("it begins");
    for seq in 0..900 {
        writer
            .write(&Entry::Decision(Box::new(decision(seq, seq as f64))), seq)
            .expect("it is written");
        // A chunk of a thousand messages, then small ones, then one of more than a thousand.
        if (300..500).contains(&seq) {
            writer.flush().expect("it is flushed");
        }
    }
    let bytes = writer.end(ending().facts()).expect("it ends").into_inner();
    let recording = Recording::of(bytes.clone()).unwrap_or_else(|e| panic!("{e}"));
    let want: Vec<(String, u32, Vec<u8>)> = mcap::MessageStream::new(&bytes)
        .expect("it is MCAP")
        .map(|message| message.expect("a message"))
        .map(|message| {
            (
                message.channel.topic.clone(),
                message.sequence,
                message.data.to_vec(),
            )
        })
        .collect();
    assert_eq!(
        (want.len(), recording.bag().span_utc_ns()),
        (4 * 900 - 2, 899)
    );
    assert!(
        all_of(&recording) == want,
        "read one after the other, they differ from those that the library reads"
    );
    // 1013 is coprime to the number of messages, so each message occurs once.
    for i in 0..want.len() {
        let place = i * 1013 % want.len();
        let message = recording.bag().message(place);
        assert_eq!(
            (message.topic, message.number, &message.bytes),
            (&*want[place].0, want[place].1, &want[place].2)
        );
    }
    for seq in [899, 0, 450, 451, 2] {
        assert_eq!(recording.frame(seq).at, SimTime(seq as i64 * 100_000_000));
    }
}

#[test]
fn a_file_cut_at_any_byte_opens_up_to_the_cut() {
    let whole = recorded(&[1.0, 2.0, 3.0, 4.0]);
    let all = all_of(&Recording::of(whole.clone()).unwrap_or_else(|e| panic!("{e}")));
    // A message ends exactly where its bytes end, except that a string is followed by a NUL.
    let mut from = 0;
    let mut ends = Vec::new();
    for (topic, number, bytes) in &all {
        let place = whole[from..]
            .windows(bytes.len())
            .position(|window| window == bytes);
        let nul = usize::from(topic.starts_with("status/"));
        from += place.unwrap_or_else(|| panic!("{topic} {number} is there")) + bytes.len() + nul;
        ends.push(from);
    }
    let first = (0..whole.len())
        .find(|cut| Recording::of(whole[..*cut].to_vec()).is_ok())
        .expect("it opens in the end");
    assert!(first < ends[0], "the beginning opens on its own");
    for cut in 0..whole.len() {
        match Recording::of(whole[..cut].to_vec()) {
            Err(RecordingError::Foreign(_)) => assert!(cut < first, "cut at {cut}"),
            Err(e) => panic!("truncated at {cut}: {e}"),
            Ok(recording) => {
                let count = ends.iter().filter(|end| **end <= cut).count();
                assert_eq!(all_of(&recording), all[..count], "cut at {cut}");
                assert!(recording.is_cut() || count == all.len(), "cut at {cut}");
            }
        }
    }
}

#[test]
fn other_files_are_refused_with_the_reason() {
    let reason = |bytes: &[u8]| {
        Recording::of(bytes.to_vec())
            .expect_err("it is refused")
            .to_string()
    };
    assert!(
        reason(b"ahoy").contains("it is not an MCAP file"),
        "{}",
        reason(b"ahoy")
    );
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).expect("it begins");
    writer.finish().expect("it ends");
    let message = reason(writer.into_inner().get_ref());
    assert!(
        message.contains("it has neither the metadata \"squall\" nor \"gateway\""),
        "{message}"
    );
    let mut header = header();
    header.info.version = "0.0.1".to_owned();
    let other = Writer::begin(Cursor::new(Vec::new()), &header.opening())
        .and_then(|writer| writer.end(ending().facts()));
    let message = reason(other.expect("a file").get_ref());
    assert!(
        message.contains("recorded by Squall 0.0.1; this program is"),
        "{message}"
    );
    let missing = Recording::open(Path::new("/nowhere/at.mcap"))
        .expect_err("there is none")
        .to_string();
    assert!(missing.contains("/nowhere/at.mcap"), "{missing}");
}

#[test]
#[expect(
    clippy::disallowed_methods,
    reason = "a file is checked repeatedly, with a limit"
)]
fn a_recorder_writes_beside_the_game_and_can_be_read_meanwhile() {
    let dir = tempfile::tempdir().expect("a directory");
    let path = dir.path().join("game.mcap");
    let blank = || NewFile::create(&path);
    drop(blank().unwrap_or_else(|e| panic!("{e}")));
    assert!(!path.exists(), "a game that never began has no recording");
    let recorder = Recorder::begin(
        blank().unwrap_or_else(|e| panic!("{e}")),
        &header().opening(),
    );
    let recorder = recorder.unwrap_or_else(|e| panic!("{e}"));
    (0..50).for_each(|seq| recorder.record(Entry::Decision(Box::new(decision(seq, seq as f64)))));
    let mut frames = 0;
    for _ in 0..3000 {
        frames = Recording::open(&path)
            .unwrap_or_else(|e| panic!("{e}"))
            .frame_count();
        if frames == 50 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert_eq!(
        frames, 50,
        "what was recorded is on the disk although the recording was not ended"
    );
    assert!(blank().is_err(), "nothing is overwritten");
    let state = recorder.end(ending().facts());
    assert_eq!((state.dropped, state.failed), (0, None));
    assert_eq!(
        state.bytes,
        std::fs::metadata(&path).expect("it is there").len()
    );
    let recording = Recording::open(&path).unwrap_or_else(|e| panic!("{e}"));
    assert!(!recording.is_cut() && recording.frame_count() == 50);
}

/// A file that starts with this record.
fn with_record(opcode: u8, content: &[u8]) -> Vec<u8> {
    let mut bytes = recorded(&[1.0]);
    let length = (content.len() as u64).to_le_bytes();
    let record = [&[opcode][..], &length, content].concat();
    bytes.splice(mcap::MAGIC.len()..mcap::MAGIC.len(), record);
    bytes
}

#[test]
fn records_that_say_they_are_longer_than_they_are_do_no_harm() {
    let attachment = Recording::of(with_record(9, &[0; 32])).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(
        attachment.frame_count(),
        1,
        "an attachment does not matter, however damaged"
    );
    let huge = [&[1, 0][..], &u32::MAX.to_le_bytes()].concat();
    for (opcode, content) in [
        (3, huge.clone()),
        (4, [&huge[..2], &huge].concat()),
        (12, huge[2..].to_vec()),
    ] {
        let refused = Recording::of(with_record(opcode, &content))
            .expect_err("it is damaged")
            .to_string();
        assert!(
            refused.contains("a string in it is longer than the record"),
            "{opcode}: {refused}"
        );
    }
}

/// The first position of `part` in `bytes`.
fn place_of(part: &[u8], bytes: &[u8]) -> usize {
    bytes
        .windows(part.len())
        .position(|window| window == part)
        .expect("it is there")
}

/// The position of the first schema, in the first chunk. The header comes before it; a file without
/// a header cannot be opened.
fn first_schema(bytes: &[u8]) -> usize {
    place_of(b"ros2msg", bytes)
}

#[test]
fn a_byte_that_is_another_is_noticed_and_its_chunk_named() {
    let whole = recorded(&[1.0]);
    let opened = Recording::of(whole.clone()).unwrap_or_else(|e| panic!("{e}"));
    assert!(opened.bag().damage.is_empty(), "nothing is");
    let all = all_of(&opened);
    let schema = first_schema(&whole);
    for place in schema - 60..whole.len() {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x10;
        let Ok(recording) = Recording::of(bytes) else {
            continue;
        };
        let is_noticed = recording.is_cut() || !recording.bag().damage.is_empty();
        assert!(
            is_noticed || all_of(&recording) == all,
            "byte {place} was changed without an error"
        );
    }
    let mut bytes = whole;
    bytes[schema] ^= 0x10;
    let damaged = Recording::of(bytes).unwrap_or_else(|e| panic!("{e}"));
    let [range] = &damaged.bag().damage[..] else {
        panic!("{:?}", damaged.bag().damage)
    };
    let schema = schema as u64;
    assert!(
        (schema - 60..schema).contains(&range.start) && range.end > schema,
        "{range:?} of the schema at {schema}"
    );
}

#[test]
fn a_damaged_header_is_refused_also_in_a_file_that_is_cut() {
    let mut bytes = recorded(&[1.0]);
    let seed = place_of(b"\"seed\":", &bytes) + "\"seed\":".len();
    bytes[seed] ^= 1;
    for end in [bytes.len(), first_schema(&bytes)] {
        let refused = Recording::of(bytes[..end].to_vec())
            .expect_err("it is damaged")
            .to_string();
        assert!(refused.ends_with("its header is damaged"), "{refused}");
    }
}

#[test]
fn a_header_that_refers_to_nothing_is_refused() {
    let refused = |change: fn(&mut scenario::Scenario)| {
        let mut header = header();
        change(&mut header.info.scenario);
        let writer = Writer::begin(Cursor::new(Vec::new()), &header.opening()).expect("it begins");
        let bytes = writer.end(ending().facts()).expect("it ends").into_inner();
        Recording::of(bytes).expect_err("it is refused").to_string()
    };
    for (message, part) in [
        (
            refused(|scenario| scenario.vehicles[0].boat = 7),
            "the boat of blue_one is 7, expected less than 1",
        ),
        (
            refused(|scenario| scenario.vehicles[0].strategy = 9),
            "the strategy of blue_one is 9",
        ),
        (
            refused(|scenario| scenario.vehicles[2].team = primitives::TeamId(2)),
            "the team of red_one is 2, expected less than 2",
        ),
        (
            refused(|scenario| scenario.field.flags[1].team = primitives::TeamId(5)),
            "the team of flag 1 is 5",
        ),
        (
            refused(|scenario| scenario.vehicles[1].name = "../x".to_owned()),
            "\"../x\" is not a valid name",
        ),
    ] {
        assert!(
            message.contains("its scenario cannot be parsed") && message.contains(part),
            "{message}"
        );
    }
}
