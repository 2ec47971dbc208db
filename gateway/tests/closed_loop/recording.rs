//! What is recorded plays again just so, whole or cut.

use crate::rig::{Rig, steer};
use game::external::OperatorCommand;
use gateway::bridge::Event;
use gateway::record::{Moment, Recorder};
use gateway::replay::{ReplayError, replay};
use std::io::Cursor;

/// A recording of a trip with orders of odd numbers, a trip, a mission and a cut of the link.
fn recording(end_well: bool) -> (Vec<u8>, usize, usize) {
    let mut rig = Rig::new("surveyor.toml", None);
    rig.order = Some(steer(100.0 / 3.0, 1.1));
    rig.run(1.0);
    rig.operate(OperatorCommand::Arm);
    rig.run(5.0);
    rig.order = None;
    rig.run(3.0);
    rig.order = Some(steer(200.0, 0.7));
    rig.run(1.0);
    rig.link(false);
    rig.run(1.0);
    rig.link(true);
    rig.run(2.0);
    rig.operate(OperatorCommand::Arm);
    rig.run(2.0);
    let mut bytes = Cursor::new(Vec::new());
    let mut recorder = Recorder::begin(&mut bytes, &crate::rig::plan("surveyor.toml", false)).expect("memory");
    for (at, input, out) in &rig.turns {
        let moment = Moment { at: *at, utc_ns: 1_700_000_000_000_000_000 + at.0 as u64 };
        recorder.turn(moment, input, out).expect("memory");
    }
    let moment = Moment { at: rig.now, utc_ns: 1_700_000_000_000_000_000 };
    recorder.remark(moment, &Event::Remark("the end".to_owned())).expect("memory");
    if end_well {
        recorder.end().expect("memory");
    } else {
        std::mem::forget(recorder);
    }
    (bytes.into_inner(), rig.turns.len(), rig.events.len())
}

#[test]
fn a_recording_plays_again_byte_for_byte() {
    for end_well in [true, false] {
        let (file, turns, events) = recording(end_well);
        let replay = replay(&file).expect("it is one");
        assert_eq!(replay.difference, None);
        assert_eq!((replay.inputs as usize, replay.events.len(), replay.is_cut), (turns, events, !end_well));
        assert_eq!(replay.status.state, "armed");
        assert!(replay.bytes_in > 10_000 && replay.bytes_out > 1_000, "{replay:?}");
    }
}

#[test]
fn a_recording_that_is_cut_plays_up_to_the_cut() {
    let (file, ..) = recording(true);
    let mut inputs = 0;
    for cut in (5000..file.len()).step_by(997) {
        let replay = replay(&file[..cut]).unwrap_or_else(|e| panic!("cut at {cut}: {e}"));
        assert_eq!(replay.difference, None, "cut at {cut}");
        assert!(replay.inputs >= inputs);
        inputs = replay.inputs;
    }
    assert!(inputs > 1000, "{inputs}");
}

#[test]
fn a_recording_that_says_something_else_is_found_out() {
    let (mut file, ..) = recording(true);
    let place = file.windows(12).rposition(|window| window == b"$PSEAC,T,0,3").expect("it was driven");
    file[place + 9] = b'1';
    let difference = replay(&file).expect("still one").difference.expect("it is another");
    assert!(difference.recorded.contains("PSEAC,T,1") && difference.replayed.contains("PSEAC,T,0"), "{difference:?}");
}

#[test]
fn what_is_no_recording_is_refused() {
    assert!(matches!(replay(b"$GPGGA,,"), Err(ReplayError::Foreign(_))));
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = mcap::Writer::new(&mut bytes).expect("memory");
    writer.finish().expect("memory");
    drop(writer);
    let error = replay(&bytes.into_inner()).expect_err("another's");
    assert!(error.to_string().contains("no metadata \"gateway\""), "{error}");
    let (mut file, ..) = recording(true);
    let place = file.windows(5).position(|window| window == b"0.1.0").expect("the version");
    file[place] = b'9';
    assert!(matches!(replay(&file), Err(ReplayError::Version { found }) if found == "9.1.0"));
}
