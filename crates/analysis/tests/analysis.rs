//! Analysis of a small synthetic recording: statistics, and tables and logs byte by byte where
//! other programs read them.

mod game;

use analysis::{Comparison, GameSeries, Incomparable, Summary, alog, gateway_of, table};
use game::{bytes_of, decision, ending, header, recording};
use messages::Order;
use messages::input::Input;
use primitives::{SimTime, VehicleId};
use recording::{Bag, Entry, Facts, Header, Kind, Opening, Recording, Writer};
use std::io::Cursor;

/// A gateway's recording of messages on this topic.
fn gateway_bag(topic: &str, schema: Option<&'static str>, messages: &[String]) -> Bag {
    let opening = Opening {
        kind: Kind::Gateway,
        began_utc_ns: 0,
        facts: Facts::new(),
        more: vec![],
        teams: vec![],
    };
    let mut writer = Writer::begin(Cursor::new(Vec::new()), &opening).expect("it begins");
    for message in messages {
        let entry = Entry::Message {
            topic: topic.to_owned(),
            schema,
            bytes: message.clone().into_bytes(),
            at: SimTime(1),
        };
        writer.write(&entry, 1).expect("it is written");
    }
    Bag::of(writer.end(Facts::new()).expect("it ends").into_inner()).expect("a recording")
}

#[test]
fn a_topic_of_earlier_versions_is_listed_but_has_no_table() {
    let schema = "squall_msgs/msg/PayloadBytes";
    let bag = gateway_bag("payload/camera", Some(schema), &["bytes".to_owned()]);
    assert_eq!(table::topics(&bag), ["payload/camera"]);
    let refused = table::write(&bag, None, "payload/camera", &mut |_| Ok(()));
    assert!(refused.is_err_and(|e| e.to_string().contains("has no table")));
}

#[test]
fn a_gateways_own_recording_begins_disarmed_and_tells_each_change() {
    let state_after = |changes: &[&str]| {
        let event = |to: &&str| {
            format!("{{\"event\":{{\"state\":{{\"from\":\"disarmed\",\"to\":\"{to}\"}}}}}}")
        };
        let events: Vec<String> = changes.iter().map(event).collect();
        let gateway = gateway_of(&gateway_bag("event", None, &events), "blue_one");
        (
            gateway.state.expect("it begins disarmed"),
            gateway.failsafes,
        )
    };
    assert_eq!(state_after(&[]), ("disarmed".to_owned(), vec![]));
    assert_eq!(
        state_after(&["armed", "e-stopped"]),
        ("e-stopped".to_owned(), vec![])
    );
    let (state, failsafes) = state_after(&["armed", "failsafe: the link is down", "disarmed"]);
    let causes: Vec<&str> = failsafes
        .iter()
        .map(|failsafe| failsafe.cause.as_str())
        .collect();
    assert_eq!(
        (state.as_str(), causes),
        ("disarmed", vec!["the link is down"])
    );
}

#[test]
fn a_summary_has_the_figures_of_the_game() {
    let summary = Summary::of(&recording());
    let series = GameSeries::of(&recording());
    assert_eq!(
        (summary.game.as_str(), summary.seed, summary.commit.as_str()),
        ("pav01-1", 1, "c0ffee")
    );
    assert!((summary.duration_s - 0.3).abs() < 1e-9 && (summary.wall_s - 3.0).abs() < 1e-9);
    assert_eq!(
        (summary.is_cut, summary.dropped, summary.winner.as_deref()),
        (false, Some(3), Some("blue"))
    );
    assert_eq!(summary.score.get("blue"), Some(&1));
    assert_eq!(summary.events.len(), 1);
    assert_eq!(summary.events[0].sentence(), "blue_one grabs the red flag");
    let blue_one = &summary.boats[0];
    assert!(
        (blue_one.distance_m - 0.6).abs() < 1e-9 && (blue_one.speed_max_m_s - 2.0).abs() < 1e-9
    );
    assert!((blue_one.carrying_s - 0.2).abs() < 1e-9 && blue_one.counts.grabs == 1);
    let navigation = blue_one.navigation.expect("it was in pictures");
    assert!((navigation.rms_m - 5.0).abs() < 1e-9 && (navigation.p95_m - 5.0).abs() < 1e-9);
    let steering = blue_one.steering.expect("it was ordered");
    assert!((steering.speed_rms_m_s - 0.5).abs() < 1e-9 && steering.heading_rms_deg < 1e-9);
    assert_eq!(summary.boats[1].steering, None);
    let rates: Vec<(&str, u64)> = summary
        .topics
        .iter()
        .map(|(name, topic)| (name.as_str(), topic.count))
        .collect();
    let want = [
        ("frame", 4),
        ("inputs", 4),
        ("link/blue_one", 3),
        ("picture/blue", 3),
        ("status/blue_one", 3),
    ];
    assert_eq!(rates, want);
    assert!(
        summary.topics["frame"]
            .rate_hz
            .is_some_and(|rate_hz| (rate_hz - 10.0).abs() < 1e-9)
    );
    assert_eq!(summary.topics["link/blue_one"].rate_hz, None);
    assert_eq!(
        series.boats[0].samples[3].order,
        Order::Steer {
            heading_rad: 0.0,
            speed_m_s: 2.5
        }
    );
    assert_eq!(series.boats[0].samples[0].order, Order::Hold);
}

#[test]
fn a_long_game_is_thinned_out_evenly_with_its_end_and_all_its_events() {
    let recording = Recording::of(bytes_of(&header(), 12)).expect("a recording");
    let whole = GameSeries::of(&recording);
    assert_eq!(
        (whole.every, whole.times_s.len(), whole.remark()),
        (1, 12, None)
    );
    // At most 20 of 48 samples of four boats: every third decision, and the last.
    let thinned = GameSeries::of_at_most(&recording, 20);
    let kept = [0, 3, 6, 9, 11];
    assert_eq!(
        (thinned.every, &thinned.times_s),
        (3, &kept.map(|i| whole.times_s[i]).to_vec())
    );
    assert!(
        thinned
            .remark()
            .is_some_and(|remark| remark.contains("one decision in 3")),
        "{:?}",
        thinned.remark()
    );
    assert_eq!(
        (&thinned.events, thinned.score.len()),
        (&whole.events, kept.len())
    );
    for (boat, all) in thinned.boats.iter().zip(&whole.boats) {
        assert_eq!(boat.samples, kept.map(|i| all.samples[i]), "{}", boat.name);
    }
}

#[test]
fn a_gateway_is_known_by_its_bytes_and_failsafes() {
    let summary = Summary::of(&recording());
    let [gateway] = summary.gateways.as_slice() else {
        panic!("{:?}", summary.gateways)
    };
    assert_eq!(
        (gateway.boat.as_str(), gateway.state.as_deref()),
        ("blue_one", Some("armed"))
    );
    assert_eq!((gateway.from_boat.bytes, gateway.to_boat.bytes), (26, 15));
    let kinds: Vec<(&str, u64)> = gateway
        .from_boat
        .sentences
        .iter()
        .map(|(kind, n)| (kind.as_str(), *n))
        .collect();
    assert_eq!(kinds, [("GPRMC", 1), ("PSEAA", 1)]);
    let causes: Vec<&str> = gateway
        .failsafes
        .iter()
        .map(|failsafe| failsafe.cause.as_str())
        .collect();
    assert_eq!(causes, ["link down", "no orders"]);
}

/// The table of a topic, rows as lines.
fn rows_of(recording: &Recording, topic: &str) -> Vec<String> {
    let mut lines = vec![];
    let mut sink = |cells: &[String]| {
        lines.push(cells.join(","));
        Ok(())
    };
    table::write(
        recording.bag(),
        Some(recording.scenario()),
        topic,
        &mut sink,
    )
    .unwrap_or_else(|e| panic!("{topic}: {e}"));
    lines
}

#[test]
fn every_topic_is_a_table() {
    let recording = recording();
    for (topic, rows) in [
        ("frame", 4),
        ("inputs", 9),
        ("picture/blue", 6),
        ("link/blue_one", 3),
        ("status/blue_one", 3),
        ("events", 1),
    ] {
        let lines = rows_of(&recording, topic);
        assert_eq!(lines.len(), rows + 1, "{topic}");
        let columns = lines[0].split(',').count();
        assert!(
            lines
                .iter()
                .all(|line| line.split(',').count() >= columns && line.starts_with(['t', '0'])),
            "{lines:?}"
        );
    }
    let frame = rows_of(&recording, "frame");
    assert!(
        frame[0].starts_with("t_s,seq,blue_one.north_m,blue_one.east_m,blue_one.psi_rad,"),
        "{}",
        frame[0]
    );
    assert!(
        frame[0].ends_with(
            ",flag.blue.carrier,flag.red.carrier,score.blue,score.red,events,stopped,over"
        )
    );
    assert!(
        frame[3].starts_with("0.2,2,10.4,0,0,2,")
            && frame[3].contains("blue_one grabs the red flag")
    );
    assert!(frame[3].contains(",,blue_one,1,0,"), "{}", frame[3]);
    assert_eq!(
        rows_of(&recording, "events")[1],
        "0.15,3,grabbed,blue_one,,red,blue_one grabs the red flag"
    );
    assert_eq!(
        rows_of(&recording, "link/blue_one"),
        [
            "t_s,direction,text",
            "0.25,from_boat,$GPRMC,1*00",
            "0.25,to_boat,$PSEAC,T,0*0D",
            "0.25,from_boat,$PSEAA,2*11"
        ]
    );
    let inputs = rows_of(&recording, "inputs");
    assert!(
        inputs[2].starts_with("0.1,1,steer,blue_one,0,2.5,,"),
        "{}",
        inputs[2]
    );
    let picture = rows_of(&recording, "picture/blue");
    assert!(
        picture[1].starts_with("0,0,own,blue_one,0,13,4,"),
        "{}",
        picture[1]
    );
    assert!(
        picture[2].starts_with("0,0,contact,red_one,0.05,1,2,0.5,,,,0.25,0,true,"),
        "{}",
        picture[2]
    );
    let status = rows_of(&recording, "status/blue_one");
    assert!(
        status[0].contains(",failsafes.1.cause,") && status[3].contains(",no orders,"),
        "{status:?}"
    );
}

/// The logs of a recording, with their names.
fn logs(recording: &Recording, wants_vehicles: bool) -> Vec<(String, String)> {
    let dir = tempfile::tempdir().expect("a temporary directory");
    let mut names = vec![];
    let written = alog::write(recording, wants_vehicles, &mut |name| {
        names.push(name.to_owned());
        Ok(Box::new(std::fs::File::create(dir.path().join(name))?))
    });
    assert_eq!(written.expect("they are written").0, names.len());
    names
        .into_iter()
        .map(|name| {
            (
                name.clone(),
                std::fs::read_to_string(dir.path().join(name)).expect("text"),
            )
        })
        .collect()
}

#[test]
fn the_log_of_a_vehicle_is_what_moos_tools_read() {
    let recording = recording();
    let logs = logs(&recording, true);
    let log = &logs[1].1;
    assert!(log.starts_with(include_str!("blue_one.alog")), "{log}");
    assert!(
        log.contains("\n0.10000         DESIRED_HEADING      squall          0.0000\n"),
        "{log}"
    );
    assert!(
        log.contains("\n0.20000         HAS_FLAG             squall          true\n"),
        "{log}"
    );
    let names: Vec<&str> = logs.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ["shoreside", "blue_one", "blue_two", "red_one", "red_two"]
    );
}

#[test]
fn the_log_of_the_shoreside_has_reports_and_what_happened() {
    let recording = recording();
    let logs = logs(&recording, false);
    let [(_, log)] = &logs[..] else {
        panic!("one log")
    };
    let length_m = recording.scenario().boat_of(VehicleId(0)).length_m;
    let report = format!(
        "NAME=blue_one,TYPE=kayak,TIME=1700000000.00,X=0.00,Y=10.00,SPD=2.00,HDG=0.00,DEPTH=0,LENGTH={length_m},MODE=PLAYING,GROUP=blue"
    );
    for row in [
        "0.00000         AQUATICUS_GAME_ALL   squall          play".to_owned(),
        format!("0.00000         NODE_REPORT          squall          {report}"),
        "0.15000         HAS_FLAG_BLUE_ONE    squall          true".to_owned(),
        "0.15000         RED_FLAG_GRABBED     squall          true".to_owned(),
        "0.15000         SQUALL_EVENT         squall          event=grabbed,vname=blue_one,team=red,game=pav01_vs_pav01"
            .to_owned(),
        "0.20000         BLUE_SCORES          squall          1".to_owned(),
    ] {
        assert!(log.lines().any(|line| line == row), "{row}\nis not in\n{log}");
    }
    let rows: Vec<&str> = log.lines().skip(5).collect();
    assert!(
        rows.iter().all(|row| row.split_whitespace().count() == 4),
        "no value has blanks"
    );
    let times: Vec<f64> = rows
        .iter()
        .filter_map(|row| row.split(' ').next()?.parse().ok())
        .collect();
    assert!(times.len() == rows.len() && times.is_sorted());
}

#[test]
fn an_order_ends_with_the_mind_that_gave_it() {
    let mut writer =
        Writer::begin(Cursor::new(Vec::new()), &header().opening()).expect("it begins");
    for seq in 0..3 {
        let mut decision = decision(seq);
        if seq == 2 {
            decision.inputs = vec![Input::AgentLost(VehicleId(0)), Input::Played];
        }
        writer
            .write(&Entry::Decision(Box::new(decision)), 1)
            .expect("it is written");
    }
    let series = GameSeries::of(
        &Recording::of(writer.end(ending().facts()).expect("it ends").into_inner())
            .expect("a recording"),
    );
    let orders: Vec<Order> = series.boats[0]
        .samples
        .iter()
        .map(|moment| moment.order)
        .collect();
    assert_eq!(
        orders,
        [
            Order::Hold,
            Order::Steer {
                heading_rad: 0.0,
                speed_m_s: 2.5
            },
            Order::Hold
        ]
    );
}

#[test]
fn a_game_differs_in_nothing_from_itself() {
    let recording = recording();
    let series = GameSeries::of(&recording);
    let same = Comparison::of([recording.header(); 2], [&series; 2], 0.0)
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((same.boats.len(), same.notes.len()), (4, 0));
    for pair in &same.boats {
        let apart = pair.apart;
        assert_eq!(
            [
                apart.mean_m,
                apart.rms_m,
                apart.max_m,
                apart.final_m,
                apart.frechet_m
            ],
            [0.0; 5],
            "{}",
            pair.boat
        );
        assert_eq!(pair.response[0], pair.response[1]);
    }
    assert_eq!(
        (
            same.events.in_both,
            same.events.only_in_a.len(),
            same.events.only_in_b.len()
        ),
        (1, 0, 0)
    );
    assert_eq!(same.score.get("blue"), Some(&[Some(1), Some(1)]));
}

#[test]
fn games_that_differ_say_in_what_and_strangers_are_refused() {
    let a = recording();
    let mut other = header();
    other.info.scenario.seed = 7;
    other.info.scenario.vehicles[3].name = "red_three".to_owned();
    let b = Recording::of(bytes_of(&other, 3)).unwrap_or_else(|e| panic!("{e}"));
    let series = [&a, &b].map(GameSeries::of);
    let compare = |header: &Header, b: &GameSeries| {
        Comparison::of([a.header(), header], [&series[0], b], 1.0)
    };
    let found = compare(b.header(), &series[1]).unwrap_or_else(|e| panic!("{e}"));
    let notes = found.notes.join("\n");
    for part in [
        "seed: 1 in A, 7 in B",
        "only in A: red_two",
        "only in B: red_three",
        "A lasts 0.3 s, B 0.2 s",
    ] {
        assert!(notes.contains(part), "{part} is not in {notes}");
    }
    assert!(found.boats.len() == 3 && (found.common_s - 0.2).abs() < 1e-9);
    let mut far = header();
    far.info.scenario.field.plan.datum.lat_deg += 0.1;
    assert!(matches!(
        compare(&far, &series[1]),
        Err(Incomparable::Datum { .. })
    ));
    let strangers = GameSeries {
        boats: vec![],
        ..series[1].clone()
    };
    assert!(matches!(
        compare(b.header(), &strangers),
        Err(Incomparable::Boats { .. })
    ));
    let mut empty = series[1].clone();
    empty.times_s.clear();
    empty.boats.iter_mut().for_each(|boat| boat.samples.clear());
    assert_eq!(compare(b.header(), &empty), Err(Incomparable::Time));
}
