//! Every reader of recordings returns a result or an error, whatever a recording contains and
//! however it is damaged.

use analysis::table::TableError;
use analysis::{Comparison, GameSeries, Summary, alog, table};
use messages::external::{FailsafeReport, GatewayStatus, LinkBytes};
use messages::input::Input;
use messages::picture::{FlagView, Nav, OwnBoat};
use messages::water::Water;
use messages::{EventRecord, Frame, GameInfo, Message, Order, Picture, Stamp, VehicleTruth};
use primitives::{SimTime, VehicleId};
use proptest::prelude::*;
use recording::{Decision, Ending, Entry, Header, Recording, Writer};
use rules::event::EventCursor;
use scenario::Scenario;
use serde_json::Value;
use shore::page::replay::Recorded;
use sim::Contest;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

/// A shipped game.
fn shipped(game: &str) -> Scenario {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenarios/games")
        .join(game);
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// A recording of these decisions, followed by a line from a link and a gateway's status.
fn bytes_of(decisions: Vec<Decision>) -> Vec<u8> {
    bytes_of_game(shipped("pav01_vs_pav01.toml"), decisions)
}

fn bytes_of_game(scenario: Scenario, decisions: Vec<Decision>) -> Vec<u8> {
    let header = Header {
        commit: "c0ffee".to_owned(),
        game: "pav01-1".to_owned(),
        began_utc_ns: 1_700_000_000_000_000_000,
        info: GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario,
        },
        water: Water { waves: vec![] },
    };
    let message = |topic: &str, schema, bytes| Entry::Message {
        topic: topic.to_owned(),
        schema,
        bytes,
        at: SimTime(1),
    };
    let stamp = Stamp {
        version: LinkBytes::VERSION,
        ..Stamp::default()
    };
    let link = LinkBytes {
        stamp,
        vehicle: VehicleId(0),
        outward: false,
        data: b"$GPRMC,1*00\r\n$PSE".to_vec(),
    };
    let failsafes = vec![FailsafeReport {
        at_s: 1.0,
        cause: "link down".to_owned(),
    }];
    let status = GatewayStatus {
        failsafes,
        ..GatewayStatus::default()
    };
    let entries = decisions
        .into_iter()
        .map(|decision| Entry::Decision(Box::new(decision)))
        .chain([
            message(
                "link/blue_one",
                Some(LinkBytes::SCHEMA),
                primitives::codec::encode(&link),
            ),
            message(
                "status/blue_one",
                None,
                serde_json::to_vec(&status).expect("JSON"),
            ),
        ]);
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening()).expect("it begins");
    entries.for_each(|entry| writer.write(&entry, 1_000_000_000).expect("it is written"));
    writer
        .end(Ending::default().facts())
        .expect("it ends")
        .into_inner()
}

/// Numbers that a sim never sends.
fn odd_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(-1e300),
        0.0..100.0_f64
    ]
}

prop_compose! {
    fn odd_nav()(a in proptest::array::uniform6(odd_number())) -> Nav {
        Nav { north_m: a[0], east_m: a[1], psi_rad: a[2], surge_m_s: a[3], sway_m_s: a[4], yaw_rate_rad_s: a[5] }
    }
}

fn odd_event() -> impl Strategy<Value = EventRecord> {
    (any::<u64>(), any::<i64>(), 0..30_u8, -2..12_i32, -2..12_i32).prop_map(
        |(tick, at, kind, subject, object)| EventRecord {
            tick,
            at_ns: SimTime(at),
            kind,
            subject,
            object,
        },
    )
}

fn odd_input() -> impl Strategy<Value = Input> {
    let vehicle = (0..9_u16).prop_map(VehicleId);
    let ordered =
        (vehicle.clone(), odd_number()).prop_map(|(vehicle, heading_rad)| Input::Ordered {
            vehicle,
            order: Order::Steer {
                heading_rad,
                speed_m_s: heading_rad,
            },
            given_at: SimTime::ZERO,
        });
    let reported =
        (vehicle.clone(), odd_nav(), any::<i64>()).prop_map(|(vehicle, nav, at)| Input::Reported {
            vehicle,
            nav,
            fix_at: SimTime(at),
            valid: true,
        });
    prop_oneof![
        ordered,
        reported,
        vehicle.prop_map(Input::Held),
        Just(Input::Played)
    ]
}

prop_compose! {
    /// A decision that no sim would send: any numbers of boats, flags and teams, any time, any
    /// event.
    fn odd_decision()(
        (at, seq) in prop_oneof![(any::<i64>(), any::<u64>()), (0..5_i64, 0..5_u64)],
        navs in proptest::collection::vec((odd_nav(), -2..9_i16), 0..6),
        flags in proptest::collection::vec(any::<i32>(), 0..4),
        score in proptest::collection::vec(any::<u32>(), 0..4),
        events in proptest::collection::vec(odd_event(), 0..4),
        inputs in proptest::collection::vec(odd_input(), 0..4),
        seen in proptest::collection::vec((0..9_u16, odd_nav(), any::<i16>()), 0..3),
    ) -> Decision {
        let stamp = |version| Stamp { valid_ns: SimTime(at), seq, version };
        let truth = |(nav, carrying): &(Nav, i16)| VehicleTruth { nav: *nav, carrying: *carrying, ..VehicleTruth::default() };
        let flags: Vec<FlagView> = flags.iter().map(|carrier| FlagView { carrier: *carrier }).collect();
        let time = SimTime(at);
        let own = |(vehicle, nav, carrying): &(u16, Nav, i16)| OwnBoat {
            fix_ns: time,
            carrying: *carrying,
            tag_ready_ns: time,
            ..OwnBoat::new(VehicleId(*vehicle), *nav)
        };
        let own = seen.iter().map(own).collect();
        let picture =
            Picture { stamp: stamp(Picture::VERSION), own, flags: flags.clone(), score: score.clone(), ..Picture::default() };
        let vehicles = navs.iter().map(truth).collect();
        let frame = Frame { stamp: stamp(Frame::VERSION), vehicles, flags, score, events, ..Frame::default() }.into();
        Decision { frame, pictures: vec![picture], inputs }
    }
}

/// Applies every reader and analysis to the recording.
fn look_at_all_of(recording: Recording) -> Recorded {
    let series = GameSeries::of(&recording);
    serde_json::to_string(&Summary::of(&recording)).expect("a summary is JSON");
    for topic in table::topics(recording.bag()) {
        match table::write(
            recording.bag(),
            Some(recording.scenario()),
            &topic,
            &mut |_| Ok(()),
        ) {
            Ok(_) | Err(TableError::Strange { .. }) => {}
            Err(e) => panic!("{topic}: {e}"),
        }
    }
    alog::write(&recording, true, &mut |_| Ok(Box::new(std::io::sink())))
        .expect("writing to a sink cannot fail");
    // There may be nothing to compare.
    Comparison::of([recording.header(); 2], [&series; 2], 0.0).ok();
    let recorded = Recorded::new(Arc::new(recording), "odd.mcap".to_owned());
    for frame in 0..recorded.frame_times.len() {
        let _ = recorded.estimate(VehicleId(0), frame);
        let _ = recorded.status(VehicleId(0), recorded.frame_times[frame]);
    }
    recorded
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn recordings_with_any_content_can_be_viewed(decisions in proptest::collection::vec(odd_decision(), 0..5)) {
        let recording = Recording::of(bytes_of(decisions)).expect("it is a recording");
        assert_eq!(look_at_all_of(recording).damaged.count, 0, "its messages are sound");
    }

    #[test]
    fn damaged_files_never_panic(
        decisions in proptest::collection::vec(odd_decision(), 0..5),
        place in 0.0..1.0_f64,
        byte in any::<u8>(),
    ) {
        let mut bytes = bytes_of(decisions);
        let place = (place * bytes.len() as f64) as usize;
        bytes[place] = byte;
        if let Ok(recording) = Recording::of(bytes) {
            look_at_all_of(recording);
        }
    }

    /// A file in a state that a power cut may leave: its length is written, but some blocks are
    /// not.
    #[test]
    fn files_with_zeros_never_panic(
        decisions in proptest::collection::vec(odd_decision(), 0..5),
        ends in proptest::array::uniform2(0.0..1.0_f64),
        is_to_the_end in any::<bool>(),
    ) {
        let mut bytes = bytes_of(decisions);
        let [one, other] = ends.map(|end| (end * bytes.len() as f64) as usize);
        let last = if is_to_the_end { bytes.len() } else { one.max(other) };
        bytes[one.min(other)..last].fill(0);
        if let Ok(recording) = Recording::of(bytes) {
            look_at_all_of(recording);
        }
    }
}

/// The JSON pointers of all numbers below a value.
fn numbers(value: &Value, at: &str, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at.to_owned()),
        Value::Array(items) => {
            items
                .iter()
                .take(3)
                .enumerate()
                .for_each(|(i, item)| numbers(item, &format!("{at}/{i}"), found));
        }
        Value::Object(items) => items
            .iter()
            .for_each(|(key, item)| numbers(item, &format!("{at}/{key}"), found)),
        _ => {}
    }
}

#[test]
fn a_game_with_impossible_numbers_is_refused_or_played_again() {
    let sound = serde_json::to_value(
        shipped("surveyor_2v2.toml")
            .of_seed(1)
            .expect("it is drawn"),
    )
    .expect("JSON");
    let mut places = vec![];
    numbers(&sound, "", &mut places);
    assert!(places.len() > 300, "{}", places.len());
    let mut panicked = vec![];
    for place in places {
        for number in [
            serde_json::json!(0),
            serde_json::json!(65_535),
            serde_json::json!(-1e300),
        ] {
            let mut value = sound.clone();
            *value.pointer_mut(&place).expect("it is there") = number.clone();
            let Ok(scenario) = serde_json::from_value::<Scenario>(value) else {
                continue;
            };
            let bytes = bytes_of_game(scenario, vec![]);
            let done = std::panic::catch_unwind(|| {
                let Ok(recording) = Recording::of(bytes) else {
                    return;
                };
                let scenario = recording.scenario().clone();
                look_at_all_of(recording);
                // As `replay --check` does.
                let Ok(mut contest) = Contest::new(&scenario, scenario.seed) else {
                    return;
                };
                (0..3).for_each(|_| contest.give(Input::Played));
                contest.frame(&mut EventCursor::default());
            });
            if done.is_err() {
                panicked.push(format!("{place} = {number}"));
            }
        }
    }
    assert!(panicked.is_empty(), "{panicked:#?}");
}
