//! Tests that a replay exactly reproduces its recording, complete or truncated.

use crate::script::played;
use gateway::bridge::Event;
use gateway::record::{StepEncoder, opening};
use gateway::replay::{Replay, replay};
use primitives::SimTime;
use recording::{Bag, Facts, Kind, Opening, RecordingError, Writer};
use std::io::Cursor;

/// A drive with unrounded orders, a failsafe, a link failure, and re-arming.
const DRIVE: &str =
    "boat\norder steer 33.333333333333336 1.1\nrun 1\noperator arm\nrun 5\norder none\nrun 3
order steer 200 0.7\nrun 1\nlink down\nrun 1\nlink up\nrun 2\noperator arm\nrun 2";

/// A recording of the drive.
fn recording(end_well: bool) -> (Vec<u8>, usize, usize) {
    let rig = played(DRIVE);
    let opening = opening(
        &crate::rig::plan("surveyor.toml"),
        1_700_000_000_000_000_000,
        "c0ffee",
    );
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &opening).expect("memory");
    let mut encoder = StepEncoder::new("blue_one");
    let mut entries = Vec::new();
    rig.turns
        .iter()
        .for_each(|(at, input, out)| entries.extend(encoder.step(*at, SimTime::ZERO, input, out)));
    entries.push(StepEncoder::event(
        rig.now,
        Event::Remark("the end".to_owned()),
    ));
    entries.iter().for_each(|entry| {
        writer
            .write(entry, 1_700_000_000_000_000_000)
            .expect("memory")
    });
    let mut file = writer.end(Facts::new()).expect("memory").into_inner();
    if !end_well {
        // Keep all messages and nothing after them.
        let end = file
            .windows(7)
            .rposition(|window| window == b"the end")
            .expect("it is there");
        file.truncate(end + b"the end\"}}\0".len());
    }
    (file, rig.turns.len(), rig.events.len())
}

fn replayed(file: &[u8]) -> Result<Replay, RecordingError> {
    Bag::of(file.to_vec()).and_then(|bag| replay(&bag))
}

#[test]
fn a_recording_plays_again_byte_for_byte() {
    for end_well in [true, false] {
        let (file, turns, events) = recording(end_well);
        let replay = replayed(&file).expect("it is one");
        assert_eq!(replay.difference, None);
        assert_eq!(
            (replay.inputs as usize, replay.events.len(), replay.is_cut),
            (turns, events, !end_well)
        );
        assert_eq!(replay.status.state, "armed");
        assert!(
            replay.bytes_in > 10_000 && replay.bytes_out > 1_000,
            "{replay:?}"
        );
    }
}

#[test]
fn a_recording_that_is_cut_plays_up_to_the_cut() {
    let (file, ..) = recording(true);
    let mut inputs = 0;
    let header = (0..file.len())
        .find(|cut| Bag::of(file[..*cut].to_vec()).is_ok())
        .expect("it opens in the end");
    for cut in (header..file.len()).step_by(997) {
        let replay = replayed(&file[..cut]).unwrap_or_else(|e| panic!("truncated at {cut}: {e}"));
        assert_eq!(replay.difference, None, "cut at {cut}");
        assert!(replay.inputs >= inputs);
        inputs = replay.inputs;
    }
    assert!(inputs > 1000, "{inputs}");
}

#[test]
fn a_recording_that_says_something_else_is_found_out() {
    let (mut file, ..) = recording(true);
    let place = file
        .windows(12)
        .rposition(|window| window == b"$PSEAC,T,0,3")
        .expect("it was driven");
    file[place + 9] = b'1';
    let difference = replayed(&file)
        .expect("still one")
        .difference
        .expect("it is another");
    assert!(
        difference.recorded.contains("PSEAC,T,1") && difference.replayed.contains("PSEAC,T,0"),
        "{difference:?}"
    );
}

#[test]
fn what_is_no_recording_is_refused() {
    assert!(matches!(
        replayed(b"$GPGGA,,"),
        Err(RecordingError::Foreign(_))
    ));
    let opening = opening(&crate::rig::plan("surveyor.toml"), 0, "c0ffee");
    let refused = |change: fn(&mut Opening)| {
        let mut opening = opening.clone();
        change(&mut opening);
        let writer = Writer::begin(Cursor::new(Vec::new()), &opening).expect("memory");
        let file = writer.end(Facts::new()).expect("memory").into_inner();
        replayed(&file)
            .map(|replay| replay.inputs)
            .expect_err("it is refused")
            .to_string()
    };
    let version = |opening: &mut Opening| {
        drop(
            opening
                .facts
                .insert("version".to_owned(), "9.1.0".to_owned()),
        )
    };
    assert!(refused(version).contains("recorded by Squall 9.1.0"));
    assert!(
        refused(|opening| opening.kind = Kind::Game)
            .contains("not a recording of a gateway: it is a recording of a game")
    );
    assert!(refused(|opening| opening.facts.clear()).contains("cannot parse its plan"));
    // Headers had no checksum before gateways recorded bags.
    let mut writer = mcap::Writer::new(Cursor::new(Vec::new())).expect("memory");
    let metadata = [("version".to_owned(), primitives::VERSION.to_owned())].into();
    writer
        .write_metadata(&mcap::records::Metadata {
            name: "gateway".to_owned(),
            metadata,
        })
        .expect("memory");
    writer.finish().expect("memory");
    let error = replayed(writer.into_inner().get_ref())
        .expect_err("an old one")
        .to_string();
    assert!(
        error.contains("it is a gateway's recording in an old format"),
        "{error}"
    );
}
