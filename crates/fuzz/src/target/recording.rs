//! Recordings of games and gateways (MCAP): every reader, viewer, replay and analysis accepts or
//! rejects them.

use super::{Change, Target, check_shown, page};
use crate::Dice;
use crate::change::change as mutated;
use crate::played::{self, mixed, played};
use analysis::table::{self, TableError};
use analysis::{Comparison, GameSeries, Summary, alog};
use gateway::bridge::{Bridge, Input, Output, Plan, Preflight, Site};
use gateway::record::StepEncoder;
use messages::external::{FailsafeReport, GatewayStatus, LinkBytes};
use messages::input::Inputs;
use messages::{Message, Stamp};
use primitives::{SimTime, VehicleId, codec};
use recording::{Bag, Entry, FRAME, INPUTS, Kind, Recording, RecordingError, Writer};
use scenario::Scenario;
use std::collections::BTreeMap;
use std::io::Cursor;
use std::sync::LazyLock;

pub(super) const TARGET: Target = Target {
    name: "recording",
    seeds,
    change,
    check,
    allocated_max: (1 << 30, 2000),
};

/// The recorded games.
static SCENARIOS: LazyLock<[Scenario; 2]> =
    LazyLock::new(|| ["attack_1v1", "pav01_popolopen"].map(played::scenario));

/// The magic bytes of MCAP files.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Opcodes of the records parsed in this file.
const CHUNK: u8 = 6;
const METADATA: u8 = 12;
const DATA_END: u8 = 15;

fn seeds() -> Vec<Vec<u8>> {
    let stamp = Stamp {
        version: LinkBytes::VERSION,
        ..Stamp::default()
    };
    let data = b"$GPRMC,1*00\r\n$PSEAC,T,0,20,-10,*22\r\n$PSE".to_vec();
    let link = LinkBytes {
        stamp,
        vehicle: VehicleId(0),
        outward: false,
        data,
    };
    let failsafes = vec![FailsafeReport {
        at_s: 1.0,
        cause: "link down".to_owned(),
    }];
    let status = GatewayStatus {
        failsafes,
        ..GatewayStatus::default()
    };
    let message = |topic: &str, schema, bytes| {
        let topic = topic.to_owned();
        let at = SimTime(1_000_000);
        Entry::Message {
            topic,
            schema,
            bytes,
            at,
        }
    };
    let others = [
        message(
            "link/blue_one",
            Some(LinkBytes::SCHEMA),
            codec::encode(&link),
        ),
        message(
            "status/blue_one",
            None,
            serde_json::to_vec(&status).expect("JSON"),
        ),
        message("control", None, br#"{"control":"halt"}"#.to_vec()),
    ];
    vec![
        played(SCENARIOS[0].clone(), 8).recording(&others),
        played(SCENARIOS[1].clone(), 3).recording(&[]),
        gateway_recording(),
    ]
}

fn gateway_recording() -> Vec<u8> {
    let scenario = mixed();
    let vehicle = "blue_one".to_owned();
    let gateway = gateway::config::default_gateway();
    let field = scenario.field.clone();
    let site = Some(Site {
        field,
        length_m: 2.0,
        declination_rad: 0.1,
        coasting: None,
    });
    let plan = Plan {
        vehicle,
        gateway,
        site,
        arms_itself: true,
        dry_run: false,
        preflight: Preflight::NotRequired,
    };
    let began_utc_ns = 1_700_000_000_000_000_000;
    let opening = gateway::record::opening(&plan, began_utc_ns, "c0ffee");
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &opening).expect("memory");
    let mut encoder = StepEncoder::new(&plan.vehicle);
    let mut bridge = Bridge::new(plan);
    let rmc = b"$GPRMC,123519,A,4807.038,N,01131.000,E,002.4,084.4,230394,003.1,W*6A\r\n".to_vec();
    let inputs = [
        Input::LinkUp,
        Input::Bytes(rmc),
        Input::Joined,
        Input::Tick,
        Input::LinkDown,
    ];
    for (i, input) in inputs.iter().enumerate() {
        let at = SimTime::from_s(i as f64);
        let mut out = Output::default();
        bridge.process(at, input, &mut out);
        for entry in encoder.step(at, SimTime::ZERO, input, &out) {
            writer.write(&entry, began_utc_ns).expect("memory");
        }
    }
    writer.end(BTreeMap::new()).expect("memory").into_inner()
}

fn check(bytes: &[u8]) {
    let bag = match Bag::of(bytes.to_vec()) {
        Ok(bag) => bag,
        Err(error) => return check_shown(&error),
    };
    assert!(bag.messages().len() == bag.topics().values().sum::<usize>());
    match bag.kind {
        Kind::Gateway => match gateway::replay::replay(&bag) {
            Ok(replay) => drop(analysis::gateway_of(&bag, &replay.plan.vehicle)),
            Err(error) => check_shown(&error),
        },
        Kind::Game => match Recording::of_bag(bag) {
            Ok(recording) => look_at_all_of(recording, bytes),
            Err(error) => check_shown(&error),
        },
    }
}

/// Runs every reader on a game's recording.
fn look_at_all_of(recording: Recording, bytes: &[u8]) {
    let series = GameSeries::of(&recording);
    serde_json::to_string(&Summary::of(&recording)).expect("a summary is JSON");
    for topic in table::topics(recording.bag()) {
        match table::write(
            recording.bag(),
            Some(recording.scenario()),
            &topic,
            &mut |_| Ok(()),
        ) {
            Ok(_) => {}
            Err(error @ TableError::Strange { .. }) => check_shown(&error),
            Err(error) => panic!("{topic}: {error}"),
        }
    }
    alog::write(&recording, true, &mut |_| Ok(Box::new(std::io::sink())))
        .expect("a sink accepts everything");
    if let Err(error) = Comparison::of([recording.header(); 2], [&series; 2], 0.0) {
        check_shown(&error);
    }
    play_again(&recording);
    page::look_around(Recording::of(bytes.to_vec()).expect("the recording is valid"));
}

/// Replays the game from its inputs, as `squall replay --check` does.
fn play_again(recording: &Recording) {
    // The numbers of a scenario are trusted, so only inputs are mutated here.
    if !SCENARIOS.contains(recording.scenario()) {
        return;
    }
    let Ok(mut contest) = sim::Contest::new(recording.scenario(), recording.scenario().seed) else {
        return;
    };
    let given: Result<Vec<Inputs>, RecordingError> = recording
        .bag()
        .on(INPUTS)
        .take(10)
        .map(|m| m.read())
        .collect();
    for input in given
        .unwrap_or_default()
        .iter()
        .flat_map(|inputs| inputs.of(recording.scenario()))
        .flatten()
        .take(100)
    {
        contest.give(input);
    }
    drop(contest.frame(&mut rules::event::EventCursor::default()));
    assert_eq!(
        recording.bag().places(FRAME).count(),
        recording.frame_count()
    );
}

/// An MCAP record: opcode and body.
type Record = (u8, Vec<u8>);

/// Mutates individual records, or the file as a whole.
fn change(seeds: Vec<Vec<u8>>) -> Change {
    let files: Vec<Vec<Record>> = seeds
        .iter()
        .map(|seed| records(&seed[MAGIC.len()..]))
        .collect();
    let pools: Vec<Vec<Vec<u8>>> = files
        .iter()
        .map(|file| file.iter().map(|(_, body)| body.clone()).collect())
        .collect();
    let facts: Vec<Vec<u8>> = files
        .iter()
        .flatten()
        .filter_map(facts_of)
        .flat_map(|(_, facts)| facts.into_values())
        .collect();
    Box::new(move |dice| {
        let which = dice.roll(files.len());
        if dice.roll(4) == 0 {
            return mutated(&seeds[which], &seeds, dice);
        }
        let mut file = files[which].clone();
        for _ in 0..=dice.roll(3) {
            change_record(&mut file, &pools[which], &facts, dice);
        }
        written(&file)
    })
}

fn change_record(file: &mut Vec<Record>, pool: &[Vec<u8>], all_facts: &[Vec<u8>], dice: &mut Dice) {
    if file.is_empty() {
        return;
    }
    let headers: Vec<usize> = (0..file.len()).filter(|i| file[*i].0 == METADATA).collect();
    let at = if headers.is_empty() || dice.roll(2) == 0 {
        dice.roll(file.len())
    } else {
        *dice.one_of(&headers)
    };
    match dice.roll(8) {
        0 => drop(file.remove(at)),
        1 => file.insert(at, file[at].clone()),
        2 => {
            let other = dice.roll(file.len());
            file.swap(at, other);
        }
        3 => {
            let body = &pool[dice.roll(pool.len())];
            file[at].1 = mutated(body, pool, dice);
        }
        _ => match facts_of(&file[at]) {
            Some((name, mut facts)) if !facts.is_empty() => {
                let key = facts
                    .keys()
                    .nth(dice.roll(facts.len()))
                    .cloned()
                    .unwrap_or_default();
                let changed = mutated(&facts[&key], all_facts, dice);
                facts.insert(key, changed);
                file[at].1 = metadata(&name, &facts);
            }
            _ => file[at].1 = mutated(&file[at].1, pool, dice),
        },
    }
}

/// The records of a file, including those inside chunks.
fn records(mut bytes: &[u8]) -> Vec<Record> {
    let mut records = Vec::new();
    while let Some((opcode, length, rest)) = prefix(bytes) {
        let Some((body, rest)) = rest.split_at_checked(length) else {
            break;
        };
        match opcode {
            // Skip two times, a size, a checksum, the empty compression name, and the content's
            // length.
            CHUNK => records.extend(self::records(
                body.get(8 + 8 + 8 + 4 + 4 + 8..).unwrap_or_default(),
            )),
            DATA_END => break,
            _ => records.push((opcode, body.to_vec())),
        }
        bytes = rest;
    }
    records
}

fn prefix(bytes: &[u8]) -> Option<(u8, usize, &[u8])> {
    let (opcode, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    Some((
        *opcode,
        usize::try_from(u64::from_le_bytes(*length)).ok()?,
        rest,
    ))
}

/// A file of these records, without chunks, and without checksums other than the header's.
fn written(records: &[Record]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let end = (DATA_END, vec![0; 4]);
    for (opcode, body) in records.iter().chain([&end]) {
        bytes.push(*opcode);
        bytes.extend((body.len() as u64).to_le_bytes());
        bytes.extend(body);
    }
    bytes.extend(MAGIC);
    bytes
}

/// The name and key-value pairs of a metadata record.
fn facts_of((opcode, body): &Record) -> Option<(Vec<u8>, BTreeMap<String, Vec<u8>>)> {
    let (name, rest) = text(body).filter(|_| *opcode == METADATA)?;
    let (mut list, _) = text(rest)?;
    let mut facts = BTreeMap::new();
    while !list.is_empty() {
        let (key, rest) = text(list)?;
        let (value, rest) = text(rest)?;
        facts.insert(String::from_utf8_lossy(key).into_owned(), value.to_vec());
        list = rest;
    }
    Some((name.to_vec(), facts))
}

fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    rest.split_at_checked(usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

fn metadata(name: &[u8], facts: &BTreeMap<String, Vec<u8>>) -> Vec<u8> {
    let with_length = |text: &[u8]| [&(text.len() as u32).to_le_bytes()[..], text].concat();
    let mut facts = facts.clone();
    if let Some(checksum) = facts.get_mut("checksum") {
        *checksum = Vec::new();
        let sum = checksum_of(&facts);
        facts.insert("checksum".to_owned(), sum.into_bytes());
    }
    let list: Vec<u8> = facts
        .iter()
        .flat_map(|(key, value)| [with_length(key.as_bytes()), with_length(value)].concat())
        .collect();
    [with_length(name), with_length(&list)].concat()
}

/// The checksum of a header's other key-value pairs, as computed by the recorder.
fn checksum_of(facts: &BTreeMap<String, Vec<u8>>) -> String {
    let mut hasher = crc32fast::Hasher::new();
    for (key, value) in facts.iter().filter(|(key, _)| *key != "checksum") {
        [key.as_bytes(), b"\0", value, b"\0"]
            .iter()
            .for_each(|bytes| hasher.update(bytes));
    }
    hasher.finalize().to_string()
}
