//! Faults of the link: cut, half open, garbage, fragments, floods.

use crate::rig::{Rig, steer};
use game::external::OperatorCommand;
use game::{Ned, Order, SimTime};
use gateway::bridge::{FleetCommand, Input};
use gateway::nmea::Operator;
use proptest::prelude::*;
use proptest::sample::select;

#[test]
fn a_cut_link_stops_a_boat_with_a_watchdog_and_the_first_command_after_it_stops_any() {
    let mut with = Rig::under_way("surveyor.toml", Some(2.0));
    with.link(false);
    with.run_until(2.2, |rig| {
        // The emulator's watchdog acts when it is asked what to do.
        rig.mode() == 'L'
    });
    assert_eq!(with.state(), "failsafe: the link is lost");
    let mut without = Rig::under_way("surveyor.toml", None);
    without.link(false);
    without.run(20.0);
    assert_eq!(without.mode(), 'T', "nobody can stop it");
    without.link(true);
    assert_eq!(without.mode(), 'L', "the first command does");
    assert!(without.sent.last().is_some_and(|(_, bytes)| bytes.starts_with(b"$PSEAC,T,0,0,0,")));
    without.run(20.0);
    assert!(without.is_at_rest() && without.state().contains("the link is lost"));
}

#[test]
fn a_half_open_link_is_a_failsafe_before_it_is_detected() {
    // Nothing comes from the boat any more; what is sent still goes through.
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.open = (true, false);
    let after_s = rig.run_until(1.8, |rig| rig.mode() == 'L');
    assert!(rig.state().contains("navigation") && after_s > 1.3, "{} after {after_s}", rig.state());
    // Nothing reaches the boat any more: it shows so.
    let mut rig = Rig::under_way("surveyor.toml", Some(1.0));
    rig.open = (false, true);
    rig.run_until(1.2, |rig| rig.mode() == 'L');
    rig.run_until(1.8, |rig| rig.state().contains("does not follow the commands it is sent"));
}

#[test]
fn a_storm_of_reconnections_never_sets_the_boat_going() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    for _ in 0..200 {
        rig.link(false);
        rig.run(0.02);
        rig.link(true);
        rig.run(0.05);
        assert_eq!(rig.mode(), 'L');
    }
    rig.run(10.0);
    assert!(rig.is_at_rest());
}

#[test]
fn garbage_between_and_within_sentences_is_skipped() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    let mut count = 0_u8;
    rig.tamper = Some(Box::new(move |_, bytes| {
        let noise: Vec<u8> = (0..200)
            .map(|i: u8| {
                count = count.wrapping_mul(97).wrapping_add(i);
                count
            })
            .collect();
        vec![[noise, b"\r\n".to_vec(), bytes, b"\x00\xff$PGRMCE*0E\x8e$PSRF100,".to_vec(), b"\r\n".to_vec()].concat()]
    }));
    rig.run(10.0);
    assert_eq!(rig.state(), "armed");
    assert!(count_of(&mut rig, "bytes of garbage") > 1000);
}

#[test]
fn a_burst_of_garbage_alone_stops_the_boat_when_navigation_is_too_old() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = Some(Box::new(|_, bytes| vec![bytes.iter().map(|byte| byte ^ 0x55).collect()]));
    let after_s = rig.run_until(1.8, |rig| rig.mode() == 'L');
    assert!(after_s > 1.3, "{after_s}");
}

#[test]
fn sentences_with_wrong_checksums_do_not_count() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = Some(Box::new(|_, bytes| {
        vec![String::from_utf8_lossy(&bytes).replace(",W,2,", ",E,2,").replace("PSEAD,T", "PSEAD,L").into_bytes()]
    }));
    rig.run_until(1.8, |rig| rig.mode() == 'L');
    assert!(count_of(&mut rig, "bad checksums") >= 14);
}

fn count_of(rig: &mut Rig, name: &str) -> u64 {
    let status = rig.bridge.status(rig.now);
    status.counts.iter().find(|(known, _)| known == name).map_or(0, |(_, count)| *count)
}

#[test]
fn one_byte_a_packet_or_all_in_one_is_the_same() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    let before = count_of(&mut rig, "sentences in");
    // The oracle cannot read single bytes: the test tells it that they are sound.
    rig.tamper = Some(Box::new(|_, bytes| bytes.into_iter().map(|byte| vec![byte]).collect()));
    for _ in 0..50 {
        (rig.oracle.fixed, rig.oracle.headed, rig.oracle.granted) = (rig.now, rig.now, rig.now);
        rig.run(0.1);
    }
    assert_eq!((rig.state().as_str(), count_of(&mut rig, "sentences in") - before), ("armed", 300));
    // 64 KiB in one packet: what came late, all of it.
    let mut late = Vec::new();
    rig.tamper = None;
    while late.len() < 64 * 1024 {
        rig.emulator.telemetry(rig.now, &mut late);
    }
    rig.put(&Input::Bytes(late));
    rig.run(5.0);
    assert_eq!(rig.state(), "armed");
}

#[test]
fn ten_thousand_orders_a_second_come_out_as_twenty_sentences() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = None;
    let (start, before) = (rig.now, rig.oracle.all);
    let mut last_deg = 0.0;
    for i in 0..300 {
        for k in 0..100 {
            last_deg = f64::from((i * 100 + k) % 360);
            let given = start + SimTime(i64::from(i) * 10_000_000 + i64::from(k) * 1000 + 1);
            rig.put(&Input::Order(steer(last_deg, 1.0), given));
        }
        rig.run(0.01);
    }
    let a_second = (rig.oracle.all - before) as f64 / 3.0;
    assert!((15.0..=25.0).contains(&a_second), "{a_second} with the last at {last_deg}");
    assert_eq!(rig.state(), "armed");
}

#[derive(Clone, Debug)]
enum Move {
    Run(u8),
    /// The agent's order, and whether the agent hangs.
    Order(Option<Order>, bool),
    Put(Input),
    Link(bool),
    Open(bool, bool),
    Tamper(u8),
    Jump(u8),
    Freeze(bool),
    Operator(Operator),
    Volts(bool),
    Others(bool),
}

fn moves() -> impl Strategy<Value = Vec<Move>> {
    use OperatorCommand::{Arm, Disarm, EStop, GoToErp, Release, StationKeep};
    let orders = vec![
        (None, false),
        (Some(Order::Hold), false),
        (Some(steer(f64::NAN, 1.0)), false),
        (Some(Order::Thrust { port: -0.5, starboard: 0.7 }), false),
        (Some(steer(200.0, 2.0)), false),
        (Some(steer(200.0, 2.0)), true),
    ];
    let commands = vec![Disarm, EStop, Release, StationKeep, GoToErp, Arm, Arm];
    let operators = vec![Operator::Secondary, Operator::Secondary, Operator::Primary, Operator::Rc];
    let one = prop_oneof![
        4 => (1..40_u8).prop_map(Move::Run),
        2 => select(orders).prop_map(|(order, hangs)| Move::Order(order, hangs)),
        4 => select(commands).prop_map(|command| Move::Put(Input::Operator(command))),
        1 => any::<bool>().prop_map(Move::Link),
        1 => any::<(bool, bool)>().prop_map(|(to, from)| Move::Open(to, from)),
        1 => (0..4_u8).prop_map(Move::Tamper),
        1 => any::<u8>().prop_map(Move::Jump),
        1 => any::<bool>().prop_map(Move::Freeze),
        1 => select(operators).prop_map(Move::Operator),
        1 => any::<bool>().prop_map(Move::Volts),
        1 => any::<bool>().prop_map(Move::Others),
        1 => select(vec![FleetCommand::EStop, FleetCommand::Release]).prop_map(|all| Move::Put(Input::Fleet(all))),
    ];
    proptest::collection::vec(one, 1..60)
}

fn play(rig: &mut Rig, one: &Move) {
    match one {
        Move::Run(tenths) => rig.run(0.1 * f64::from(*tenths)),
        Move::Order(order, hangs) => (rig.order, rig.hangs) = (*order, *hangs),
        Move::Put(input) => rig.put(input),
        Move::Link(up) => {
            if rig.oracle.link_up != *up {
                rig.link(*up);
            }
        }
        Move::Open(to, from) => rig.open = (*to, *from),
        Move::Tamper(0) => rig.tamper = None,
        Move::Tamper(1) => rig.tamper = Some(Box::new(|_, _| vec![])),
        Move::Tamper(2) => rig.tamper = Some(Box::new(|_, bytes| vec![bytes[..bytes.len() / 2].to_vec()])),
        Move::Tamper(_) => rig.tamper = Some(Box::new(|_, bytes| vec![bytes.iter().map(|byte| byte ^ 8).collect()])),
        Move::Jump(far) => rig.offset = Ned { north: f64::from(*far), east: 0.0 },
        Move::Freeze(frozen) => rig.frozen = *frozen,
        Move::Operator(operator) => rig.emulator.give_control(rig.now, *operator),
        Move::Volts(low) => rig.emulator.set_volts(if *low { 20.0 } else { 25.0 }),
        Move::Others(near) => rig.others = near.then(|| vec![rig.boat.at]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// The oracle looks at every sentence; here anything may happen, in any order.
    #[test]
    fn whatever_happens_nothing_forbidden_is_sent(watchdog in any::<bool>(), moves in moves()) {
        let mut rig = Rig::under_way("surveyor.toml", watchdog.then_some(2.0));
        for one in &moves {
            play(&mut rig, one);
        }
        // And when everything is quiet again, the boat can be set going.
        play(&mut rig, &Move::Open(true, true));
        (rig.tamper, rig.others, rig.frozen, rig.hangs) = (None, None, false, false);
        rig.emulator.set_volts(25.0);
        rig.emulator.give_control(rig.now, Operator::Secondary);
        if !rig.oracle.link_up {
            rig.link(true);
        }
        rig.order = Some(Order::Hold);
        rig.offset = Ned::from_xy(60.0, 40.0) - rig.boat.at;
        rig.operate(OperatorCommand::Release);
        rig.put(&Input::Fleet(FleetCommand::Release));
        rig.run(12.0);
        rig.refused = None;
        rig.operate(OperatorCommand::Arm);
        prop_assert_eq!(rig.state(), "armed", "{:?}", rig.refused);
    }
}

#[test]
fn a_new_order_does_not_wait_for_the_period_of_repetitions() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = None;
    for i in 0..30 {
        // Orders come at ten a second, but at no fixed place between the repetitions.
        rig.run(0.1 + 0.01 * f64::from(i % 3));
        let (order, given) = (steer(f64::from(90 + i), 1.5), rig.now + SimTime(1));
        let before = rig.sent.len();
        rig.put(&Input::Order(order, given));
        assert_eq!(rig.sent.len(), before + 1, "{i}: sent in the very same step");
    }
}
