//! Faults and their failsafes, one row of the table in the gateway's manual per test: the boat stops within the stated time.
//!
//! The oracle checks every sentence; the tests check when and why the boat is stopped. Times are until the boat has been
//! sent standby. The death of whole processes is tested with real processes.

use crate::rig::{Rig, refixed, rewritten, steer};
use game::Order;
use game::external::OperatorCommand;
use game::frame::Ned;
use game::gateway::LowBattery;
use gateway::bridge::{FleetCommand, Input};
use gateway::nmea::Operator;

/// Runs until the boat is in standby; returns after how long. It must come to rest, and stay.
fn stops_within(rig: &mut Rig, limit_s: f64, why: &str) -> f64 {
    let after_s = rig.run_until(limit_s, |rig| rig.mode() == 'L');
    assert!(rig.state().contains(why), "{:?} is not {why:?}", rig.state());
    rig.run(10.0);
    assert!(rig.is_at_rest() && rig.mode() == 'L', "{:?}", rig.boat);
    after_s
}

#[test]
fn orders_that_no_longer_come_stop_the_boat_after_their_time_to_live() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = None;
    let after_s = stops_within(&mut rig, 1.2, "no fresh order");
    assert!(after_s > 0.8, "{after_s}");
    let zero_first =
        rig.sent.iter().any(|(_, bytes)| bytes.starts_with(b"$PSEAC,T,0,0,0,*") && bytes.ends_with(b"L,0,0,0,*14\r\n"));
    assert!(zero_first, "thrust zero, then standby");
    rig.order = Some(steer(0.0, 2.0));
    rig.run(5.0);
    assert_eq!((rig.mode(), rig.is_at_rest()), ('L', true), "new orders alone do not set it going");
    rig.operate(OperatorCommand::Arm);
    rig.run(5.0);
    assert!(rig.mode() == 'T' && !rig.is_at_rest());
}

#[test]
fn an_agent_that_hangs_and_repeats_its_order_stops_the_boat() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.hangs = true;
    stops_within(&mut rig, 1.2, "no fresh order");
}

#[test]
fn invalid_orders_are_not_followed() {
    for bad in [
        steer(f64::NAN, 1.0),
        steer(90.0, f64::INFINITY),
        steer(90.0, -1.0),
        Order::Thrust { port: 1.5, starboard: 0.0 },
        Order::Thrust { port: f64::NAN, starboard: 0.0 },
    ] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        rig.order = Some(bad);
        stops_within(&mut rig, 1.2, "no fresh order");
    }
}

#[test]
fn a_hold_stops_the_thrusters_at_the_next_sentence_and_keeps_the_boat_armed() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = Some(Order::Hold);
    let after_s = rig.run_until(0.3, |rig| rig.oracle.last.starts_with("$PSEAC,T,0,0,0,"));
    assert!(after_s <= 0.16, "{after_s}");
    rig.run(10.0);
    assert!(rig.is_at_rest() && rig.state() == "armed");
}

#[test]
fn frozen_fixes_stop_the_boat() {
    // A receiver that repeats its fix, time and all.
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.frozen = true;
    stops_within(&mut rig, 1.8, "fix");
    // One that repeats its fix and still calls it good.
    let mut rig = Rig::under_way("surveyor.toml", None);
    let mut first = None;
    rig.tamper = Some(Box::new(move |_, bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (fix, rest) = text.split_once('\n').expect("several sentences");
        let fix = first.get_or_insert_with(|| fix.to_owned());
        vec![format!("{fix}\n{rest}").into_bytes()]
    }));
    // To the oracle it looks sound.
    stops_within(&mut rig, 1.8, "fix is");
    // One that stamps the old position anew.
    let mut rig = Rig::under_way("surveyor.toml", None);
    let held = rig.boat.at;
    let after_s = {
        let start = rig.now;
        while rig.mode() != 'L' {
            rig.offset = held - rig.boat.at;
            rig.run(0.01);
            assert!((rig.now - start).as_s() < 4.0, "{}", rig.state());
        }
        (rig.now - start).as_s()
    };
    assert!(rig.state().contains("has not changed for") && after_s > 3.0, "{} after {after_s}", rig.state());
}

#[test]
fn a_boat_at_rest_may_have_the_same_position_for_ever() {
    let mut rig = Rig::new("surveyor.toml", None);
    rig.order = Some(Order::Hold);
    rig.run(1.0);
    rig.operate(OperatorCommand::Arm);
    rig.run(60.0);
    assert_eq!(rig.state(), "armed");
}

#[test]
fn a_position_that_jumps_stops_the_boat_at_once() {
    for (jump_m, stops) in [(4.0, false), (8.0, true), (2000.0, true)] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        rig.offset = Ned { north: jump_m, east: 0.0 };
        rig.run(0.25);
        assert_eq!(rig.mode() == 'L', stops, "{jump_m} m: {}", rig.state());
        if stops {
            assert!(rig.state().contains("jumped by"), "{}", rig.state());
        }
    }
}

#[test]
fn no_fix_a_bad_one_or_zero_zero_stop_the_boat_at_once() {
    for (from, to, why, limit_s) in [
        (",W,2,11,", ",W,0,11,", "quality 0", 0.3),
        (",0.98,", ",9.80,", "dilution of precision is 9.8", 0.3),
        ("PSEAA,0.0,0.0,", "PSEAA,0.0,0.0,,,,", "heading is", 1.8),
        ("GPGGA", "GPXXX", "fix is", 1.8),
    ] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        rig.tamper = rewritten(move |line| line.replace(from, to));
        stops_within(&mut rig, limit_s, why);
    }
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = refixed(|fix| format!("{}0000.00000,N,00000.00000,W,2,11,0.98,5.5,M,-33.2,M,,", &fix[..17]));
    stops_within(&mut rig, 0.3, "0 N 0 E");
}

#[test]
fn outside_of_the_geofence_or_unable_to_stop_inside_the_boat_is_stopped() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = Some(steer(90.0, 2.25));
    rig.run_until(120.0, |rig| rig.mode() == 'L');
    assert!(rig.state().contains("outside of the geofence"), "{}", rig.state());
    // The geofence is 30 m beyond the field's end at 160 m; at 2.25 m/s the boat needs 12.4 m.
    assert!((175.0..181.0).contains(&rig.boat.at.east), "{:?}", rig.boat);
    rig.run(20.0);
    assert!(rig.is_at_rest() && rig.boat.at.east < 190.0, "{:?}", rig.boat);
}

#[test]
fn a_boat_before_the_bow_halts_this_one_until_it_has_gone() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    let other = rig.boat.at + Ned { north: 0.0, east: 4.0 };
    rig.others = Some(vec![other]);
    let after_s = rig.run_until(0.3, |rig| rig.oracle.last.starts_with("$PSEAC,T,0,0,0,"));
    assert!(after_s <= 0.16 && rig.state() == "armed" && rig.has_event("Blocked(true)"));
    rig.others = Some(vec![other + Ned { north: 30.0, east: 0.0 }]);
    rig.run(0.5);
    assert!(rig.oracle.last.starts_with("$PSEAC,T,0,0,0,"), "not clear for long enough");
    rig.run(3.0);
    assert!(!rig.oracle.last.starts_with("$PSEAC,T,0,0,0,") && rig.has_event("Blocked(false)"));
}

#[test]
fn a_low_battery_stops_the_boat_or_sends_it_where_its_file_says() {
    for (action, letter) in [(LowBattery::Standby, 'L'), (LowBattery::StationKeep, 'R'), (LowBattery::GoToErp, 'H')] {
        let mut plan = crate::rig::plan("surveyor.toml", false);
        plan.gateway.battery.action = action;
        let mut rig = Rig::of(plan, None);
        rig.order = Some(steer(90.0, 1.5));
        rig.run(1.0);
        rig.operate(OperatorCommand::Arm);
        rig.run(5.0);
        rig.emulator.set_volts(21.0);
        rig.run(4.8);
        assert_eq!(rig.mode(), 'T', "a dip under load is none");
        rig.run(0.6);
        assert_eq!(rig.mode(), letter, "{action:?}");
        rig.run(30.0);
        assert_eq!(rig.mode(), letter, "{action:?}");
    }
}

#[test]
fn a_takeover_lasts_until_we_are_armed_again() {
    for (operator, words) in [(Operator::Primary, "primary operator"), (Operator::Rc, "remote control")] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        rig.emulator.give_control(rig.now, operator);
        rig.run_until(0.3, |rig| rig.state().contains(words));
        rig.run(5.0);
        rig.operate(OperatorCommand::Arm);
        assert!(rig.refused.take().is_some_and(|refused| refused.contains(words)));
        rig.emulator.give_control(rig.now, Operator::Secondary);
        rig.run(5.0);
        assert_eq!(rig.mode(), 'L', "given back, it does not drive off");
        rig.operate(OperatorCommand::Arm);
        rig.run(5.0);
        assert_eq!((rig.state().as_str(), rig.mode()), ("armed", 'T'));
    }
}

#[test]
fn a_boat_that_does_not_follow_commands_is_not_driven_on() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = rewritten(|line| line.replace("PSEAD,T,", "PSEAD,N,"));
    let after_s = rig.run_until(1.8, |rig| rig.state().contains("it is in mode N"));
    assert!(after_s > 1.4, "{after_s}");
}

#[test]
fn an_e_stop_stops_the_boat_at_once_and_stays() {
    for fleet in [false, true] {
        let mut rig = Rig::under_way("surveyor.toml", None);
        let (stop, release) = match fleet {
            true => (Input::Fleet(FleetCommand::EStop), Input::Fleet(FleetCommand::Release)),
            false => (Input::Operator(OperatorCommand::EStop), Input::Operator(OperatorCommand::Release)),
        };
        rig.put(&stop);
        assert_eq!((rig.mode(), rig.state().as_str()), ('L', "e-stopped"), "in the very same step");
        rig.operate(OperatorCommand::Arm);
        assert!(rig.refused.take().is_some_and(|refused| refused.contains("release it first")));
        rig.run(10.0);
        assert!(rig.is_at_rest());
        rig.put(&release);
        rig.run(5.0);
        assert_eq!((rig.mode(), rig.state().as_str()), ('L', "safed"));
        rig.operate(OperatorCommand::Arm);
        rig.run(3.0);
        assert_eq!(rig.mode(), 'T');
    }
}

#[test]
fn two_e_stops_need_two_releases_and_the_refusal_names_the_one_in_force() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.operate(OperatorCommand::EStop);
    rig.put(&Input::Fleet(FleetCommand::EStop));
    rig.put(&Input::Fleet(FleetCommand::Release));
    let refused = rig.refused.take().unwrap_or_default();
    assert_eq!(refused, "an E-stop of this boat is in force: release it first");
    rig.oracle.stopped = true;
    assert_eq!(rig.bridge.status(rig.now).state, "e-stopped (by an E-stop of this boat)");
    rig.operate(OperatorCommand::Release);
    assert_eq!((rig.state().as_str(), rig.refused.take()), ("safed", None));
}

#[test]
fn a_receiver_that_stamps_whole_seconds_gives_ten_fixes_a_second() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = refixed(|fix| format!("{}.00{}", &fix[..13], &fix[16..]));
    rig.run(2.0);
    let before = rig.navs.len();
    let places: Vec<f64> = (0..10)
        .map(|_| {
            rig.run(0.1);
            rig.navs.last().map_or(0.0, |(_, nav)| nav.nav.east_m)
        })
        .collect();
    assert!(places.windows(2).all(|pair| pair[1] > pair[0]), "{places:?}");
    assert!(rig.navs.len() >= before + 10 && rig.state() == "armed");
}

#[test]
fn a_step_of_the_receivers_clock_is_a_warning_and_harmless() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.tamper = rewritten(|line| line.replace("GPGGA,15", "GPGGA,03"));
    rig.run(5.0);
    assert!(rig.has_event("clock stepped by"), "{:?}", rig.events);
    assert_eq!(rig.state(), "armed");
}
