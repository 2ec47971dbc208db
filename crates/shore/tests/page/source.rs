//! A synthetic recording.

use messages::external::{FailsafeReport, GatewayStatus};
use messages::helm::HelmReport;
use messages::picture::{FlagView, Nav, OwnBoat, Picture};
use messages::water::Water;
use messages::{EventRecord, Frame, GameInfo, Message, Stamp, VehicleTruth};
use primitives::{SimTime, VehicleId};
use recording::{Decision, Entry, Header, Recording, Writer};
use rules::event::{Event, Logged};
use scenario::Scenario;
use serde_json::json;
use shore::page::HelmAnswer;
use shore::page::replay::{Helms, Recorded};
use std::io::Cursor;
use std::sync::{Arc, OnceLock};

pub(crate) fn scenario(file: &str) -> Scenario {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scenarios/games")
        .join(file);
    scenario::load(&file).unwrap_or_else(|e| panic!("{e}"))
}

/// The frame of a decision in a game with ten decisions per second.
pub(crate) fn frame(scenario: &Scenario, seq: u64) -> Frame {
    Frame {
        stamp: Stamp {
            valid_ns: SimTime(100_000_000 * seq as i64),
            seq,
            version: Frame::VERSION,
        },
        vehicles: vec![VehicleTruth::default(); scenario.vehicles.len()],
        flags: vec![FlagView { carrier: -1 }; scenario.field.flags.len()],
        score: vec![0; scenario.teams.len()],
        ..Frame::default()
    }
}

/// The decision of an encoded frame.
pub(crate) fn seq_of(wire: &[u8]) -> u64 {
    primitives::codec::decode::<Frame>(&wire[1..])
        .expect("frames are CDR")
        .stamp
        .seq
}

pub(crate) fn own_boat(vehicle: VehicleId) -> OwnBoat {
    let nav = Nav {
        north_m: 3.0,
        east_m: 4.0,
        psi_rad: std::f64::consts::FRAC_PI_2,
        surge_m_s: 1.5,
        ..Nav::default()
    };
    OwnBoat::new(vehicle, nav)
}

pub(crate) fn report(vehicle: VehicleId) -> HelmReport {
    let report = json!({"vehicle": vehicle, "at": SimTime::ZERO, "program": "made_up", "mode": "sailing",
        "courses": 2, "speeds": 2, "speed_max_m_s": 2.0, "behaviours": [], "variables": [], "functions": []});
    serde_json::from_value(report).expect("a report")
}

pub(crate) fn two_minutes() -> Arc<Recorded> {
    static RECORDED: OnceLock<Arc<Recorded>> = OnceLock::new();
    Arc::clone(RECORDED.get_or_init(|| recorded(1201)))
}

/// A recording of `frames` frames without an end record. The eleventh frame has an event; there is
/// one set of pictures and a failsafe.
pub(crate) fn recorded(frames: u64) -> Arc<Recorded> {
    recorded_in(bytes_of_recording(frames))
}

pub(crate) fn recorded_in(bytes: Vec<u8>) -> Arc<Recorded> {
    let recording = Recording::of(bytes).expect("a recording");
    Arc::new(Recorded::new(
        Arc::new(recording),
        "made_up.mcap".to_owned(),
    ))
}

pub(crate) fn bytes_of_recording(frames: u64) -> Vec<u8> {
    let scenario = scenario("pav01_vs_pav01.toml");
    let picture = |team: u8| {
        let boats = (0..scenario.vehicles.len()).map(VehicleId::at);
        let own = boats
            .filter(|boat| scenario.team_of(*boat).0 == team)
            .map(own_boat)
            .collect();
        Picture {
            stamp: Stamp {
                version: Picture::VERSION,
                ..Stamp::default()
            },
            team,
            own,
            ..Picture::default()
        }
    };
    let decision = |seq: u64| {
        let mut frame = frame(&scenario, seq);
        let untagged = Event::Untagged(VehicleId(0));
        let logged = Logged {
            tick: 2 * seq,
            at: frame.stamp.valid_ns,
            event: untagged,
        };
        frame
            .events
            .extend((seq == 10).then(|| EventRecord::from(logged)));
        let pictures = if seq == 0 {
            vec![picture(0), picture(1)]
        } else {
            vec![]
        };
        Entry::Decision(Box::new(Decision {
            frame: frame.into(),
            pictures,
            inputs: vec![],
        }))
    };
    let failsafes = vec![FailsafeReport {
        at_s: 3.0,
        cause: "link down".to_owned(),
    }];
    let status = GatewayStatus {
        failsafes,
        ..GatewayStatus::default()
    };
    let status = Entry::Message {
        topic: "status/blue_one".to_owned(),
        schema: None,
        bytes: serde_json::to_vec(&status).expect("JSON"),
        at: SimTime::from_s(3.0),
    };
    let header = Header {
        commit: "c0ffee".to_owned(),
        game: "made_up".to_owned(),
        began_utc_ns: 1_700_000_000_000_000_000,
        info: GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario: scenario.clone(),
        },
        water: Water::default(),
    };
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening())
        .expect("the recording can be written");
    (0..frames).map(decision).chain([status]).for_each(|entry| {
        writer
            .write(&entry, 1)
            .expect("the recording can be written")
    });
    writer
        .end(recording::Facts::new())
        .expect("the recording can be written")
        .into_inner()
}

/// Helms that report only the decision asked for.
pub(crate) struct Rememberer;

impl Helms for Rememberer {
    fn report(&mut self, vehicle: VehicleId, decision: u64, _: bool) -> HelmAnswer {
        let mode = format!("sailing:{decision}");
        let report = Some(HelmReport {
            mode,
            ..report(vehicle)
        });
        HelmAnswer {
            report,
            reason: None,
            computed: true,
            agrees: Some(true),
        }
    }

    fn modes(&mut self, decision: u64) -> Vec<Option<String>> {
        vec![Some(format!("sailing:{decision}")), None]
    }
}
