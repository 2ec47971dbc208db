//! Nominal operation: the boat follows its orders, and only when it is armed.

use crate::rig::{Rig, plan, steer};
use game::Order;
use game::external::OperatorCommand;

#[test]
fn a_boat_that_is_not_armed_is_sent_standby_ten_times_a_second() {
    let mut rig = Rig::new("surveyor.toml", None);
    rig.order = Some(steer(90.0, 2.0));
    rig.run(10.0);
    assert!((98..=103).contains(&rig.oracle.all), "{}", rig.oracle.all);
    assert_eq!((rig.oracle.driving, rig.mode(), rig.state().as_str()), (0, 'L', "safed"));
    assert!(rig.sent.iter().skip(1).all(|(_, bytes)| bytes == b"$PSEAC,L,0,0,0,*14\r\n"));
}

#[test]
fn a_new_link_begins_with_thrust_zero_and_standby() {
    let rig = Rig::new("surveyor.toml", None);
    assert_eq!(rig.sent[0].1, b"$PSEAC,T,0,0,0,*0C\r\n$PSEAC,L,0,0,0,*14\r\n");
}

#[test]
fn what_is_missing_for_arming_is_reported_in_words() {
    let mut rig = Rig::new("surveyor.toml", None);
    rig.operate(OperatorCommand::Arm);
    let refused = rig.refused.take().expect("nothing is there yet");
    for missing in ["secondary control", "navigation: no fix yet", "a fresh order"] {
        assert!(refused.contains(missing), "{refused}");
    }
    rig.run(1.0);
    rig.operate(OperatorCommand::Arm);
    assert_eq!(rig.refused.take().as_deref(), Some("missing: a fresh order"));
    rig.order = Some(Order::Hold);
    rig.run(0.2);
    rig.operate(OperatorCommand::Arm);
    assert_eq!((rig.refused, rig.bridge.state().to_string().as_str()), (None, "armed"));
}

#[test]
fn both_ways_of_driving_bring_the_boat_on_course_and_speed() {
    for (file, letter) in [("surveyor.toml", 'T'), ("surveyor_speed.toml", 'G')] {
        let mut rig = Rig::under_way(file, None);
        assert_eq!(rig.mode(), letter);
        for (heading_deg, speed_m_s) in [(180.0, 1.0), (300.0, 2.0), (40.0, 0.6)] {
            rig.order = Some(steer(heading_deg, speed_m_s));
            rig.run(20.0);
            let error_rad = game::angle::wrap_pi(f64::to_radians(heading_deg) - rig.boat.psi_rad);
            assert!(error_rad.abs() < 0.03, "{file}: {heading_deg} and {error_rad} rad off");
            assert!((rig.boat.speed_m_s - speed_m_s).abs() < 0.1, "{file}: {speed_m_s} and {:?}", rig.boat);
        }
        assert_eq!(rig.state(), "armed");
    }
}

#[test]
fn navigation_reports_agree_with_the_boat() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.run(5.0);
    let (_, report) = rig.navs.last().expect("it is reported");
    let apart_m = report.nav.at().distance(rig.boat.at);
    // Minutes have five decimals: 18.5 mm in latitude.
    assert!(apart_m < 0.05 && report.valid, "{apart_m} m, {report:?}");
    // The compass is magnetic, the sim's heading true.
    assert!((report.nav.psi_rad - rig.boat.psi_rad).abs() < 0.002, "{report:?} {:?}", rig.boat);
    assert!((report.nav.surge_m_s - rig.boat.speed_m_s).abs() < 0.02, "{report:?} {:?}", rig.boat);
    let reports_per_s = rig.navs.len() as f64 / rig.now.as_s();
    assert!((9.0..=11.0).contains(&reports_per_s), "{reports_per_s}");
}

#[test]
fn thrust_orders_reach_the_thrusters_within_the_limits() {
    let mut rig = Rig::under_way("surveyor.toml", None);
    rig.order = Some(Order::Thrust { port: 0.5, starboard: 0.1 });
    rig.run(2.0);
    assert_eq!(rig.oracle.last, "$PSEAC,T,0,30,20,*0D\r\n");
    rig.order = Some(Order::Thrust { port: 1.0, starboard: 1.0 });
    rig.run(2.0);
    assert_eq!(rig.oracle.last, "$PSEAC,T,0,70,0,*3B\r\n");
}

#[test]
fn a_gateway_may_arm_itself_once_and_no_more() {
    let mut rig = Rig::of(plan("surveyor.toml", true), None);
    rig.oracle.armed = true;
    rig.order = Some(steer(90.0, 1.0));
    rig.run(3.0);
    assert_eq!(rig.state(), "armed");
    rig.order = None;
    rig.run(3.0);
    assert_eq!(rig.state(), "failsafe: no fresh order");
    rig.order = Some(steer(90.0, 1.0));
    rig.run(5.0);
    assert_eq!((rig.state().as_str(), rig.mode()), ("failsafe: no fresh order", 'L'));
    rig.operate(OperatorCommand::Arm);
    assert_eq!(rig.state(), "armed");
}
