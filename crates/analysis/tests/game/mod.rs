//! A small synthetic game and its recording.

use messages::external::{FailsafeReport, GatewayStatus, LinkBytes};
use messages::input::Input;
use messages::picture::{Contact, FlagView, Nav, OwnBoat};
use messages::water::Water;
use messages::{Frame, GameInfo, Message, Order, Picture, Stamp, VehicleTruth};
use primitives::{FlagId, SimTime, TeamId, VehicleId};
use recording::{Decision, Ending, Entry, Header, Recording, Writer};
use rules::event::{Event, Logged};
use scenario::Outcome;
use std::io::Cursor;
use std::path::Path;

pub(crate) fn header() -> Header {
    let file =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    let scenario = scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
    Header {
        commit: "c0ffee".to_owned(),
        game: "pav01-1".to_owned(),
        began_utc_ns: 1_700_000_000_000_000_000,
        info: GameInfo {
            version: primitives::VERSION.to_owned(),
            pace: "lockstep".to_owned(),
            scenario,
        },
        water: Water { waves: vec![] },
    }
}

pub(crate) fn ending() -> Ending {
    let outcome = Outcome {
        digest: "ab".to_owned(),
        winner: Some("blue".to_owned()),
        ..Outcome::default()
    };
    Ending {
        outcome,
        run: serde_json::json!({"pace": "lockstep"}),
        dropped: 3,
    }
}

/// The decision `seq`: the first boat drives north at 2 m/s and estimates its position 3 m too far
/// north and 4 m too far east. It carries a flag at the third frame.
pub(crate) fn decision(seq: u64) -> Decision {
    let at = |seq: u64, version| Stamp {
        valid_ns: SimTime(seq as i64 * 100_000_000),
        seq,
        version,
    };
    let nav = |seq: u64| Nav {
        north_m: 10.0 + 0.2 * seq as f64,
        surge_m_s: 2.0,
        ..Nav::default()
    };
    let has_flag = seq >= 2;
    let carrying = if has_flag { 1 } else { -1 };
    let moored = VehicleTruth {
        carrying: -1,
        ..VehicleTruth::default()
    };
    let mut vehicles = vec![moored; 4];
    vehicles[0].nav = nav(seq);
    vehicles[0].carrying = carrying;
    let grabbed = Logged {
        tick: 3,
        at: SimTime(150_000_000),
        event: Event::Grabbed {
            vehicle: VehicleId(0),
            flag: FlagId(1),
        },
    };
    let events = (seq == 2).then(|| grabbed.into());
    let flags = vec![
        FlagView { carrier: -1 },
        FlagView {
            carrier: if has_flag { 0 } else { -1 },
        },
    ];
    let score = vec![u32::from(has_flag), 0];
    let stamp = at(seq, Frame::VERSION);
    let frame = Frame {
        stamp,
        vehicles,
        score: score.clone(),
        flags: flags.clone(),
        events: events.into_iter().collect(),
        ..Frame::default()
    }
    .into();
    let Some(before) = seq.checked_sub(1) else {
        return Decision {
            frame,
            ..Decision::default()
        };
    };
    let believed = Nav {
        north_m: nav(before).north_m + 3.0,
        east_m: 4.0,
        ..nav(before)
    };
    let own = OwnBoat::new(VehicleId(0), believed);
    let contact = Contact {
        vehicle: VehicleId(2),
        team: TeamId(1),
        seen_ns: SimTime(50_000_000),
        north_m: 1.0,
        east_m: 2.0,
        psi_rad: 0.5,
        velocity_north_m_s: 0.25,
        velocity_east_m_s: 0.0,
        tagged: true,
        carrying: -1,
    };
    let stamp = at(before, Picture::VERSION);
    let picture = Picture {
        stamp,
        own: vec![own],
        contacts: vec![contact],
        flags,
        score,
        ..Picture::default()
    };
    let order = Order::Steer {
        heading_rad: 0.0,
        speed_m_s: 2.5,
    };
    let inputs = vec![
        Input::Pictured,
        Input::Ordered {
            vehicle: VehicleId(0),
            order,
            given_at: SimTime::ZERO,
        },
        Input::Played,
    ];
    Decision {
        frame,
        pictures: vec![picture],
        inputs,
    }
}

pub(crate) fn link(outward: bool, data: &[u8]) -> Entry {
    let stamp = Stamp {
        version: LinkBytes::VERSION,
        ..Stamp::default()
    };
    let bytes = LinkBytes {
        stamp,
        vehicle: VehicleId(0),
        outward,
        data: data.to_vec(),
    };
    let bytes = primitives::codec::encode(&bytes);
    Entry::Message {
        topic: "link/blue_one".to_owned(),
        schema: Some(LinkBytes::SCHEMA),
        bytes,
        at: SimTime(250_000_000),
    }
}

pub(crate) fn status(failsafes: &[&str]) -> Entry {
    let failsafe = |cause: &&str| FailsafeReport {
        at_s: 1.0,
        cause: (*cause).to_owned(),
    };
    let failsafes = failsafes.iter().map(failsafe).collect();
    let status = GatewayStatus {
        state: "armed".to_owned(),
        failsafes,
        ..GatewayStatus::default()
    };
    let bytes = serde_json::to_vec(&status).expect("JSON");
    Entry::Message {
        topic: "status/blue_one".to_owned(),
        schema: None,
        bytes,
        at: SimTime(200_000_000),
    }
}

pub(crate) fn bytes_of(header: &Header, decisions: u64) -> Vec<u8> {
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &header.opening()).expect("it begins");
    let mut note = |note: &Entry, utc_ns| writer.write(note, utc_ns).expect("it is written");
    (0..decisions).for_each(|seq| {
        note(
            &Entry::Decision(Box::new(decision(seq))),
            1_000_000_000 * (1 + seq),
        )
    });
    note(&link(false, b"$GPRMC,1*00\r\n$PSE"), 1_000_000_000);
    note(&link(true, b"$PSEAC,T,0*0D\r\n"), 1_000_000_000);
    note(&link(false, b"AA,2*11\r\n"), 1_000_000_000);
    note(&status(&[]), 1_000_000_000);
    note(&status(&["link down"]), 1_000_000_000);
    note(&status(&["link down", "no orders"]), 1_000_000_000);
    writer.end(ending().facts()).expect("it ends").into_inner()
}

pub(crate) fn recording() -> Recording {
    Recording::of(bytes_of(&header(), 4)).unwrap_or_else(|e| panic!("{e}"))
}
