//! What goes wrong, one row a test: the boat ends stopped, or under valid command, within the time stated.
//!
//! The oracle looks at every sentence all the while; here is when and why the boat is stopped. Times are those until the
//! boat has been told standby. What a whole process does when it dies is tested with real processes.

use crate::pool::{Pool, steer};
use game::external::OperatorCommand;
use game::frame::Ned;
use game::{Order, SimTime};
use gateway::bridge::{FleetCommand, Input};
use gateway::nmea::Operator;

/// Runs until the boat has taken up standby; says after how long. It must come to rest, and stay.
fn stops_within(pool: &mut Pool, limit_s: f64, why: &str) -> f64 {
    let after_s = pool.run_until(limit_s, |pool| pool.mode() == 'L');
    assert!(pool.state().contains(why), "{:?} is not {why:?}", pool.state());
    pool.run(10.0);
    assert!(pool.is_at_rest() && pool.mode() == 'L', "{:?}", pool.boat);
    after_s
}

#[test]
fn orders_that_no_longer_come_stop_the_boat_after_their_time_to_live() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.mind = None;
    let after_s = stops_within(&mut pool, 1.2, "no fresh order");
    assert!(after_s > 0.8, "{after_s}");
    let zero_first = pool
        .sent
        .iter()
        .any(|(_, bytes)| bytes.starts_with(b"$PSEAC,T,0,0,0,*") && bytes.ends_with(b"L,0,0,0,*14\r\n"));
    assert!(zero_first, "thrust zero, then standby");
    pool.mind = Some(steer(0.0, 2.0));
    pool.run(5.0);
    assert_eq!((pool.mode(), pool.is_at_rest()), ('L', true), "new orders alone do not set it going");
    pool.operate(OperatorCommand::Arm);
    pool.run(5.0);
    assert!(pool.mode() == 'T' && !pool.is_at_rest());
}

#[test]
fn a_mind_that_hangs_and_repeats_itself_is_as_good_as_dead() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.hangs = true;
    stops_within(&mut pool, 1.2, "no fresh order");
}

#[test]
fn orders_that_make_no_sense_are_no_orders() {
    for bad in [
        steer(f64::NAN, 1.0),
        steer(90.0, f64::INFINITY),
        steer(90.0, -1.0),
        Order::Thrust { port: 1.5, starboard: 0.0 },
        Order::Thrust { port: f64::NAN, starboard: 0.0 },
    ] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        pool.mind = Some(bad);
        stops_within(&mut pool, 1.2, "no fresh order");
    }
}

#[test]
fn a_hold_stops_the_thrusters_at_the_next_sentence_and_keeps_the_boat_armed() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.mind = Some(Order::Hold);
    let after_s = pool.run_until(0.3, |pool| pool.oracle.last.starts_with("$PSEAC,T,0,0,0,"));
    assert!(after_s <= 0.16, "{after_s}");
    pool.run(10.0);
    assert!(pool.is_at_rest() && pool.state() == "armed");
}

#[test]
fn frozen_fixes_stop_the_boat() {
    // A receiver that repeats its fix, time and all.
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.frozen = true;
    stops_within(&mut pool, 1.8, "fix");
    // One that repeats its fix and still calls it good.
    let mut pool = Pool::under_way("surveyor.toml", None);
    let mut first = None;
    pool.tamper = Some(Box::new(move |_, bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (fix, rest) = text.split_once('\n').expect("several sentences");
        let fix = first.get_or_insert_with(|| fix.to_owned());
        vec![format!("{fix}\n{rest}").into_bytes()]
    }));
    // To the oracle it looks sound.
    stops_within(&mut pool, 1.8, "fix is");
    // One that stamps the old position anew.
    let mut pool = Pool::under_way("surveyor.toml", None);
    let held = pool.boat.at;
    let after_s = {
        let start = pool.now;
        while pool.mode() != 'L' {
            pool.offset = held - pool.boat.at;
            pool.run(0.01);
            assert!((pool.now - start).as_s() < 4.0, "{}", pool.state());
        }
        (pool.now - start).as_s()
    };
    assert!(pool.state().contains("has not changed for") && after_s > 3.0, "{} after {after_s}", pool.state());
}

#[test]
fn a_boat_at_rest_may_have_the_same_position_for_ever() {
    let mut pool = Pool::new("surveyor.toml", None);
    pool.mind = Some(Order::Hold);
    pool.run(1.0);
    pool.operate(OperatorCommand::Arm);
    pool.run(60.0);
    assert_eq!(pool.state(), "armed");
}

#[test]
fn a_position_that_jumps_stops_the_boat_at_once() {
    for (jump_m, trips) in [(4.0, false), (8.0, true), (2000.0, true)] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        pool.offset = Ned { north: jump_m, east: 0.0 };
        pool.run(0.25);
        assert_eq!(pool.mode() == 'L', trips, "{jump_m} m: {}", pool.state());
        if trips {
            assert!(pool.state().contains("jumped by"), "{}", pool.state());
        }
    }
}

#[test]
fn no_fix_a_bad_one_or_zero_zero_stop_the_boat_at_once() {
    let replaced = |from: &'static str, to: &'static str| {
        move |_: SimTime, bytes: Vec<u8>| {
            vec![resummed(&String::from_utf8_lossy(&bytes).replace(from, to)).into_bytes()]
        }
    };
    for (from, to, why, limit_s) in [
        (",W,2,11,", ",W,0,11,", "quality 0", 0.3),
        (",0.98,", ",9.80,", "dilution of precision is 9.8", 0.3),
        ("PSEAA,0.0,0.0,", "PSEAA,0.0,0.0,,,,", "heading is", 1.8),
        ("GPGGA", "GPXXX", "fix is", 1.8),
    ] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        pool.tamper = Some(Box::new(replaced(from, to)));
        stops_within(&mut pool, limit_s, why);
    }
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.tamper = Some(Box::new(|_, bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let lines = text.lines().map(|line| match line.starts_with("$GPGGA") {
            true => format!("{}0000.00000,N,00000.00000,W,2,11,0.98,5.5,M,-33.2,M,,*00", &line[..17]),
            false => line.to_owned(),
        });
        vec![resummed(&(lines.collect::<Vec<_>>().join("\r\n") + "\r\n")).into_bytes()]
    }));
    stops_within(&mut pool, 0.3, "0 N 0 E");
}

/// The same sentences with their checksums made right.
fn resummed(text: &str) -> String {
    let line = |line: &str| {
        let body = line.trim_start_matches('$').split('*').next().unwrap_or_default().to_owned();
        let sum = body.bytes().fold(0, |a, b| a ^ b);
        format!("${body}*{sum:02X}\r\n")
    };
    text.lines().map(line).collect()
}

#[test]
fn outside_of_the_fence_or_unable_to_stop_inside_the_boat_is_stopped() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.mind = Some(steer(90.0, 2.25));
    pool.run_until(120.0, |pool| pool.mode() == 'L');
    assert!(pool.state().contains("outside of the fence"), "{}", pool.state());
    // The fence is 30 m beyond the field's end at 160 m; at 2.25 m/s the boat needs 12.4 m.
    assert!((175.0..181.0).contains(&pool.boat.at.east), "{:?}", pool.boat);
    pool.run(20.0);
    assert!(pool.is_at_rest() && pool.boat.at.east < 190.0, "{:?}", pool.boat);
}

#[test]
fn a_boat_before_the_bow_halts_this_one_until_it_has_gone() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    let other = pool.boat.at + Ned { north: 0.0, east: 4.0 };
    pool.others = Some(vec![other]);
    let after_s = pool.run_until(0.3, |pool| pool.oracle.last.starts_with("$PSEAC,T,0,0,0,"));
    assert!(after_s <= 0.16 && pool.state() == "armed" && pool.told("Blocked(true)"));
    pool.others = Some(vec![other + Ned { north: 30.0, east: 0.0 }]);
    pool.run(0.5);
    assert!(pool.oracle.last.starts_with("$PSEAC,T,0,0,0,"), "not clear for long enough");
    pool.run(3.0);
    assert!(!pool.oracle.last.starts_with("$PSEAC,T,0,0,0,") && pool.told("Blocked(false)"));
}

#[test]
fn a_low_battery_stops_the_boat_or_sends_it_where_its_file_says() {
    for (action, letter) in [("standby", 'L'), ("station_keep", 'R'), ("go_to_erp", 'H')] {
        let mut plan = crate::pool::plan("surveyor.toml", false);
        plan.gateway.battery.action = match action {
            "station_keep" => game::gateway::LowBattery::StationKeep,
            "go_to_erp" => game::gateway::LowBattery::GoToErp,
            _ => game::gateway::LowBattery::Standby,
        };
        let mut pool = Pool::of(plan, None);
        pool.mind = Some(steer(90.0, 1.5));
        pool.run(1.0);
        pool.operate(OperatorCommand::Arm);
        pool.run(5.0);
        pool.emulator.set_volts(21.0);
        pool.run(4.8);
        assert_eq!(pool.mode(), 'T', "a dip under load is none");
        pool.run(0.6);
        assert_eq!(pool.mode(), letter, "{action}");
        pool.run(30.0);
        assert_eq!(pool.mode(), letter, "{action}");
    }
}

#[test]
fn whoever_takes_the_boat_has_it_until_we_are_armed_again() {
    for (operator, words) in [(Operator::Primary, "primary operator"), (Operator::Rc, "remote control")] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        pool.emulator.give_control(pool.now, operator);
        pool.run_until(0.3, |pool| pool.state().contains(words));
        pool.run(5.0);
        pool.operate(OperatorCommand::Arm);
        assert!(pool.refused.take().is_some_and(|refused| refused.contains(words)));
        pool.emulator.give_control(pool.now, Operator::Secondary);
        pool.run(5.0);
        assert_eq!(pool.mode(), 'L', "given back, it does not drive off");
        pool.operate(OperatorCommand::Arm);
        pool.run(5.0);
        assert_eq!((pool.state().as_str(), pool.mode()), ("armed", 'T'));
    }
}

#[test]
fn a_boat_that_does_not_do_what_it_is_sent_is_not_driven_on() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.tamper = Some(Box::new(|_, bytes| {
        vec![resummed(&String::from_utf8_lossy(&bytes).replace("PSEAD,T,", "PSEAD,N,")).into_bytes()]
    }));
    let after_s = pool.run_until(1.8, |pool| pool.state().contains("it is in mode N"));
    assert!(after_s > 1.4, "{after_s}");
}

#[test]
fn an_e_stop_stops_the_boat_at_once_and_stays() {
    for fleet in [false, true] {
        let mut pool = Pool::under_way("surveyor.toml", None);
        let (stop, release) = match fleet {
            true => (Input::Fleet(FleetCommand::EStop), Input::Fleet(FleetCommand::Release)),
            false => (Input::Operator(OperatorCommand::EStop), Input::Operator(OperatorCommand::Release)),
        };
        pool.put(&stop);
        assert_eq!((pool.mode(), pool.state().as_str()), ('L', "e-stopped"), "in the very same step");
        pool.operate(OperatorCommand::Arm);
        assert!(pool.refused.take().is_some_and(|refused| refused.contains("release it first")));
        pool.run(10.0);
        assert!(pool.is_at_rest());
        pool.put(&release);
        pool.run(5.0);
        assert_eq!((pool.mode(), pool.state().as_str()), ('L', "safed"));
        pool.operate(OperatorCommand::Arm);
        pool.run(3.0);
        assert_eq!(pool.mode(), 'T');
    }
}

#[test]
fn two_e_stops_need_two_releases_and_it_is_said_which_is_in_force() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.operate(OperatorCommand::EStop);
    pool.put(&Input::Fleet(FleetCommand::EStop));
    pool.put(&Input::Fleet(FleetCommand::Release));
    let refused = pool.refused.take().unwrap_or_default();
    assert_eq!(refused, "an E-stop of this boat is in force: release it first");
    pool.oracle.stopped = true;
    assert_eq!(pool.bridge.status(pool.now).state, "e-stopped (by an E-stop of this boat)");
    pool.operate(OperatorCommand::Release);
    assert_eq!((pool.state().as_str(), pool.refused.take()), ("safed", None));
}

#[test]
fn a_receiver_that_stamps_whole_seconds_is_heard_ten_times_a_second() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.tamper = Some(Box::new(|_, bytes| {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let lines = text.lines().map(|line| match line.starts_with("$GPGGA") {
            true => format!("{}.00{}", &line[..13], &line[16..]),
            false => line.to_owned(),
        });
        vec![resummed(&(lines.collect::<Vec<_>>().join("\r\n") + "\r\n")).into_bytes()]
    }));
    pool.run(2.0);
    let before = pool.navs.len();
    let places: Vec<f64> = (0..10)
        .map(|_| {
            pool.run(0.1);
            pool.navs.last().map_or(0.0, |(_, nav)| nav.nav.east_m)
        })
        .collect();
    assert!(places.windows(2).all(|pair| pair[1] > pair[0]), "{places:?}");
    assert!(pool.navs.len() >= before + 10 && pool.state() == "armed");
}

#[test]
fn a_step_of_the_receivers_clock_is_told_and_harmless() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.tamper = Some(Box::new(|_, bytes| {
        vec![resummed(&String::from_utf8_lossy(&bytes).replace("GPGGA,15", "GPGGA,03")).into_bytes()]
    }));
    pool.run(5.0);
    assert!(pool.told("clock stepped by"), "{:?}", pool.events);
    assert_eq!(pool.state(), "armed");
}
