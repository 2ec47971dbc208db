//! Messages match their `.msg` files, survive a round trip, and are rejected when corrupted.

use messages::external::{ExternalOrder, LinkBytes, NavReport};
use messages::input::Inputs;
use messages::picture::{Contact, FlagView, Imu, Nav, OwnBoat};
use messages::{
    EventRecord, Frame, Message, Order, Orders, Picture, PolicyProposal, Say, Stamp, VehicleOrder,
    VehicleTruth, Word,
};
use primitives::codec::{DecodeError, decode, encode};
use primitives::{FlagId, SimTime, TeamId, VehicleId};
use proptest::prelude::*;
use rules::event::{Event, Logged, TagCause};
use serde_reflection::{ContainerFormat, Format, Registry, Samples, Tracer, TracerConfig};
use std::path::Path;

/// Traces a message's format; returns its schema.
fn traced<M: Message + serde::de::DeserializeOwned>(tracer: &mut Tracer) -> &'static str {
    tracer
        .trace_type::<M>(&Samples::new())
        .expect("a plain struct");
    M::SCHEMA
}

/// The formats of all messages, and their schemas.
fn registry() -> (Registry, [&'static str; 9]) {
    let mut tracer = Tracer::new(TracerConfig::default());
    let schemas = [
        traced::<Picture>(&mut tracer),
        traced::<Frame>(&mut tracer),
        traced::<Orders>(&mut tracer),
        traced::<Say>(&mut tracer),
        traced::<PolicyProposal>(&mut tracer),
        traced::<NavReport>(&mut tracer),
        traced::<ExternalOrder>(&mut tracer),
        traced::<Inputs>(&mut tracer),
        traced::<LinkBytes>(&mut tracer),
    ];
    (tracer.registry().expect("all is known"), schemas)
}

/// The ROS 2 name of a field's type.
fn ros_type(format: &Format) -> String {
    match format {
        Format::Bool => "bool".into(),
        Format::I8 => "int8".into(),
        Format::I16 => "int16".into(),
        Format::I32 => "int32".into(),
        Format::I64 => "int64".into(),
        Format::U8 => "uint8".into(),
        Format::U16 => "uint16".into(),
        Format::U32 => "uint32".into(),
        Format::U64 => "uint64".into(),
        Format::F64 => "float64".into(),
        Format::Str => "string".into(),
        Format::Seq(item) => format!("{}[]", ros_type(item)),
        Format::TypeName(name) => format!("squall_msgs/{name}"),
        other => panic!("ROS 2 cannot express {other:?}"),
    }
}

/// Type and name of the fields in a `.msg` file, without constants.
fn fields_of(definition: &str) -> Vec<(String, String)> {
    let code = definition
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default().trim());
    let fields = code.filter(|line| !line.is_empty() && !line.contains('='));
    fields
        .map(|line| {
            let mut words = line.split_whitespace().map(str::to_owned);
            (words.next().expect("a type"), words.next().expect("a name"))
        })
        .collect()
}

#[test]
fn every_struct_on_the_wire_is_in_step_with_its_msg_file() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("msg");
    let (registry, _) = registry();
    for (name, format) in &registry {
        let ContainerFormat::Struct(fields) = format else {
            panic!("{name} is not a struct with named fields")
        };
        let ours: Vec<_> = fields
            .iter()
            .map(|field| (ros_type(&field.value), field.name.clone()))
            .collect();
        let file = folder.join(format!("{name}.msg"));
        let text =
            std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        assert_eq!(ours, fields_of(&text), "{name}.msg");
    }
    let files = std::fs::read_dir(folder)
        .expect("the folder is there")
        .count();
    assert_eq!(files, registry.len(), "a .msg file without a struct");
}

#[test]
fn definitions_belong_to_their_messages() {
    for schema in registry().1 {
        let name = schema.rsplit('/').next().expect("a name");
        let text = std::fs::read_to_string(
            Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("msg/{name}.msg")),
        );
        let definition = messages::ros::full_definition(schema).expect("it is one of ours");
        assert!(
            definition.starts_with(&text.expect("it is there")),
            "{schema}"
        );
    }
}

fn stamp<M: Message>() -> Stamp {
    Stamp {
        valid_ns: SimTime(1_250_000_000),
        seq: 12,
        version: M::VERSION,
    }
}

fn orders() -> Orders {
    let steer = Order::Steer {
        heading_rad: 0.1 + 0.2,
        speed_m_s: 1.0 / 3.0,
    };
    let orders = vec![
        VehicleOrder::new(VehicleId(3), steer),
        VehicleOrder::new(VehicleId(4), Order::Hold),
    ];
    Orders {
        stamp: stamp::<Orders>(),
        ticket: u64::MAX - 5,
        orders,
    }
}

#[test]
fn the_bytes_are_cdr_as_other_programs_read_it() {
    // Written by hand from the CDR rules: the header, then every number at a multiple of its size.
    let mut want = vec![0, 1, 0, 0];
    want.extend(1_250_000_000_i64.to_le_bytes());
    want.extend(12_u64.to_le_bytes());
    want.extend([2, 0, 0, 0, 0, 0, 0, 0]);
    want.extend((u64::MAX - 5).to_le_bytes());
    want.extend(1_u32.to_le_bytes());
    want.extend([3, 0, 1, 0]);
    [0.5_f64, 2.0, 0.0, 0.0]
        .iter()
        .for_each(|number| want.extend(number.to_le_bytes()));
    let steer = Order::Steer {
        heading_rad: 0.5,
        speed_m_s: 2.0,
    };
    assert_eq!(
        encode(&Orders {
            orders: vec![VehicleOrder::new(VehicleId(3), steer)],
            ..orders()
        }),
        want
    );
}

fn say() -> Say {
    let word = |vehicle, value| Word {
        vehicle: VehicleId(vehicle),
        key: u64::MAX - 3,
        value,
    };
    Say {
        stamp: stamp::<Say>(),
        words: vec![word(0, -0.0), word(7, 1.0 / 3.0)],
    }
}

fn proposal() -> PolicyProposal {
    let stamp = stamp::<PolicyProposal>();
    PolicyProposal {
        stamp,
        vehicle: VehicleId(3),
        course_rad: -0.1,
        speed_m_s: 0.1 + 0.2,
    }
}

#[test]
fn inputs_are_read_as_they_were_written_before_orders_had_a_time_and_no_older() {
    let inputs = |version| Inputs {
        stamp: Stamp {
            version,
            ..stamp::<Inputs>()
        },
        inputs: vec![],
    };
    for (version, is_read) in [(0, false), (1, true), (2, true), (3, false)] {
        let read = decode::<Inputs>(&encode(&inputs(version)));
        assert_eq!(
            read.is_ok_and(|read| read == inputs(version)),
            is_read,
            "version {version}"
        );
    }
}

/// A message survives a round trip. If it is truncated, extended, in a different byte order or from
/// a different version, it is rejected with the reason.
fn survives_or_is_refused<M>(message: &M)
where
    M: Message + serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
{
    let good = encode(message);
    assert_eq!(&decode::<M>(&good).expect("it was just encoded"), message);
    assert_eq!(
        encode(&decode::<M>(&good).expect("it was just encoded")),
        good
    );
    for cut in 0..good.len() {
        assert!(
            decode::<M>(&good[..cut]).is_err(),
            "{} cut at {cut}",
            M::SCHEMA
        );
    }
    let longer = [&good[..], &[0]].concat();
    assert!(
        matches!(decode::<M>(&longer), Err(DecodeError::Layout { .. })),
        "{} with more",
        M::SCHEMA
    );
    let big_endian = [&[0, 0, 0, 0], &good[4..]].concat();
    assert!(
        matches!(
            decode::<M>(&big_endian),
            Err(DecodeError::Encapsulation { .. })
        ),
        "{}",
        M::SCHEMA
    );
    let mut newer = good;
    newer[4 + 16] += 1;
    let version = DecodeError::Version {
        schema: M::SCHEMA,
        found: M::VERSION + 1,
        expected: M::VERSION,
    };
    assert_eq!(decode::<M>(&newer), Err(version));
}

#[test]
fn messages_survive_and_damaged_ones_are_refused() {
    survives_or_is_refused(&orders());
    survives_or_is_refused(&say());
    survives_or_is_refused(&Say {
        words: vec![],
        ..say()
    });
    survives_or_is_refused(&proposal());
    let nav = Nav {
        north_m: 0.1 + 0.2,
        surge_m_s: -0.0,
        ..Nav::default()
    };
    let stamp = stamp::<NavReport>();
    let ticket = u64::MAX - 5;
    survives_or_is_refused(&NavReport {
        stamp,
        ticket,
        vehicle: VehicleId(3),
        valid: true,
        age_ns: 30_000_000,
        nav,
    });
    let order = VehicleOrder::new(
        VehicleId(3),
        Order::Thrust {
            port: -1.0,
            starboard: 1.0 / 3.0,
        },
    );
    survives_or_is_refused(&ExternalOrder {
        stamp: self::stamp::<ExternalOrder>(),
        given_ns: SimTime(7),
        order,
        others_m: vec![12.5, -3.0],
    });
}

#[test]
fn words_and_proposals_are_cdr_as_other_programs_write_it() {
    // Written by hand from the CDR rules: every number is aligned to its size.
    let mut start = vec![0, 1, 0, 0];
    start.extend(1_250_000_000_i64.to_le_bytes());
    start.extend(12_u64.to_le_bytes());
    let mut want = [
        &start[..],
        &[1, 0, 0, 0],
        &1_u32.to_le_bytes(),
        &[7, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    want.extend((u64::MAX - 3).to_le_bytes());
    want.extend((1.0_f64 / 3.0).to_le_bytes());
    assert_eq!(
        encode(&Say {
            words: vec![say().words[1]],
            ..say()
        }),
        want
    );
    let mut want = [&start[..], &[1, 0, 3, 0, 0, 0, 0, 0]].concat();
    want.extend((-0.1_f64).to_le_bytes());
    want.extend((0.1_f64 + 0.2).to_le_bytes());
    assert_eq!(encode(&proposal()), want);
}

#[test]
fn every_event_survives_its_record() {
    let v = VehicleId(7);
    for event in [
        Event::Grabbed {
            vehicle: v,
            flag: FlagId(1),
        },
        Event::Captured {
            vehicle: v,
            flag: FlagId(2),
        },
        Event::Tagged {
            vehicle: v,
            cause: TagCause::Opponent(VehicleId(9)),
        },
        Event::Tagged {
            vehicle: v,
            cause: TagCause::Boundary,
        },
        Event::Tagged {
            vehicle: v,
            cause: TagCause::Obstacle,
        },
        Event::Untagged(v),
        Event::FlagReturned {
            vehicle: v,
            flag: FlagId(0),
        },
        Event::LeftField(v),
        Event::ReturnedToField(v),
        Event::Collided {
            first: v,
            second: VehicleId(8),
        },
        Event::EnteredKeepout(v),
        Event::Disabled(v),
        Event::Enabled(v),
        Event::AgentLost(v),
        Event::AgentBack(v),
        Event::Quarantined(v),
        Event::NavLost(v),
        Event::NavBack(v),
        Event::EStopped,
        Event::Released,
        Event::Halted,
        Event::WentOn,
        Event::Ended {
            winner: Some(TeamId(1)),
        },
        Event::Ended { winner: None },
    ] {
        let logged = Logged {
            tick: 4,
            at: SimTime(5),
            event,
        };
        assert_eq!(
            EventRecord::from(logged).logged(),
            Some(logged),
            "{event:?}"
        );
    }
    assert_eq!(
        EventRecord {
            tick: 0,
            at_ns: SimTime(0),
            kind: 99,
            subject: 0,
            object: 0
        }
        .logged(),
        None
    );
}

#[test]
fn what_names_nothing_in_the_game_is_left_out_of_a_frame() {
    let game =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    let scenario = scenario::load(&game).unwrap_or_else(|e| panic!("{e}"));
    let left = |subject: i32, object: i32| {
        let record = |kind| EventRecord {
            tick: 1,
            at_ns: SimTime(5),
            kind,
            subject,
            object,
        };
        let frame = Frame {
            events: (0..=23).map(record).collect(),
            ..Frame::default()
        };
        frame
            .logged(&scenario)
            .map(|logged| EventRecord::from(logged).kind)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        left(1, 1),
        (0..=22).collect::<Vec<_>>(),
        "there are four boats, two flags and two teams"
    );
    assert_eq!(left(4, 1), [18, 19, 20, 21], "no such boat, no such team");
    assert_eq!(
        left(3, 4),
        [
            3, 4, 6, 7, 9, 10, 11, 12, 13, 14, 16, 17, 18, 19, 20, 21, 22
        ],
        "no such flag, no such other boat"
    );
}

prop_compose! {
    fn nav()(a in any::<[f64; 6]>()) -> Nav {
        Nav { north_m: a[0], east_m: a[1], psi_rad: a[2], surge_m_s: a[3], sway_m_s: a[4], yaw_rate_rad_s: a[5] }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_a_message_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..300), header in any::<bool>()) {
        let bytes = if header { [&[0, 1, 0, 0], &bytes[..]].concat() } else { bytes };
        let _ = decode::<Orders>(&bytes);
        let _ = decode::<Picture>(&bytes);
        let _ = decode::<Frame>(&bytes);
        let _ = decode::<Say>(&bytes);
        let _ = decode::<PolicyProposal>(&bytes);
    }

    #[test]
    fn pictures_and_frames_come_back_to_the_bit(nav in nav(), tagged in any::<bool>(), carrying in -1_i16..4, n in 0_usize..5) {
        let own = OwnBoat { vehicle: VehicleId(1), nav, fix_ns: SimTime(7), imu: Imu { down_m_s2: -9.81, ..Imu::default() }, tagged, carrying, disabled: false, outside: true, tag_ready_ns: SimTime::LONG_AGO };
        let contact = Contact {
            vehicle: VehicleId(2), team: TeamId(1), seen_ns: SimTime(3), north_m: nav.north_m, east_m: nav.east_m,
            psi_rad: nav.psi_rad, velocity_north_m_s: 1.0, velocity_east_m_s: -0.0, tagged, carrying,
        };
        let picture = Picture {
            stamp: stamp::<Picture>(), team: 1, own: vec![own; n], contacts: vec![contact; n], flags: vec![FlagView { carrier: -1 }; 2],
            score: vec![1, 2], events: vec![], over: tagged,
        };
        let bytes = encode(&picture);
        prop_assert_eq!(encode(&decode::<Picture>(&bytes).expect("it was just encoded")), bytes);
        let frame = Frame { stamp: stamp::<Frame>(), vehicles: vec![VehicleTruth { nav, tagged, carrying, ..VehicleTruth::default() }; n], ..Frame::default() };
        let bytes = encode(&frame);
        prop_assert_eq!(encode(&decode::<Frame>(&bytes).expect("it was just encoded")), bytes);
    }
}
