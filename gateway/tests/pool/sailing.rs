//! In fair weather: the boat does what it is ordered, and only when it is armed.

use crate::pool::{Pool, plan, steer};
use game::Order;
use game::external::OperatorCommand;

#[test]
fn a_boat_that_nobody_armed_hears_standby_ten_times_a_second() {
    let mut pool = Pool::new("surveyor.toml", None);
    pool.mind = Some(steer(90.0, 2.0));
    pool.run(10.0);
    assert!((98..=103).contains(&pool.oracle.all), "{}", pool.oracle.all);
    assert_eq!((pool.oracle.driving, pool.mode(), pool.state().as_str()), (0, 'L', "safed"));
    assert!(pool.sent.iter().skip(1).all(|(_, bytes)| bytes == b"$PSEAC,L,0,0,0,*14\r\n"));
}

#[test]
fn the_first_word_on_a_new_link_is_thrust_zero_and_standby() {
    let pool = Pool::new("surveyor.toml", None);
    assert_eq!(pool.sent[0].1, b"$PSEAC,T,0,0,0,*0C\r\n$PSEAC,L,0,0,0,*14\r\n");
}

#[test]
fn what_is_missing_for_arming_is_told_in_words() {
    let mut pool = Pool::new("surveyor.toml", None);
    pool.operate(OperatorCommand::Arm);
    let refused = pool.refused.take().expect("nothing is there yet");
    for missing in ["secondary control", "navigation: no fix yet", "a fresh order"] {
        assert!(refused.contains(missing), "{refused}");
    }
    pool.run(1.0);
    pool.operate(OperatorCommand::Arm);
    assert_eq!(pool.refused.take().as_deref(), Some("missing: a fresh order"));
    pool.mind = Some(Order::Hold);
    pool.run(0.2);
    pool.operate(OperatorCommand::Arm);
    assert_eq!((pool.refused, pool.bridge.state().to_string().as_str()), (None, "armed"));
}

#[test]
fn both_ways_of_driving_bring_the_boat_on_course_and_speed() {
    for (file, letter) in [("surveyor.toml", 'T'), ("surveyor_speed.toml", 'G')] {
        let mut pool = Pool::under_way(file, None);
        assert_eq!(pool.mode(), letter);
        for (heading_deg, speed_m_s) in [(180.0, 1.0), (300.0, 2.0), (40.0, 0.6)] {
            pool.mind = Some(steer(heading_deg, speed_m_s));
            pool.run(20.0);
            let error_rad = game::angle::wrap_pi(f64::to_radians(heading_deg) - pool.boat.psi_rad);
            assert!(error_rad.abs() < 0.03, "{file}: {heading_deg} and {error_rad} rad off");
            assert!((pool.boat.speed_m_s - speed_m_s).abs() < 0.1, "{file}: {speed_m_s} and {:?}", pool.boat);
        }
        assert_eq!(pool.state(), "armed");
    }
}

#[test]
fn what_the_sim_is_told_is_where_the_boat_is() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.run(5.0);
    let (_, told) = pool.navs.last().expect("it is told");
    let apart_m = told.nav.at().distance(pool.boat.at);
    // Minutes have five decimals: 18.5 mm in latitude.
    assert!(apart_m < 0.05 && told.valid, "{apart_m} m, {told:?}");
    // The compass is magnetic, the sim's heading true.
    assert!((told.nav.psi_rad - pool.boat.psi_rad).abs() < 0.002, "{told:?} {:?}", pool.boat);
    assert!((told.nav.surge_m_s - pool.boat.speed_m_s).abs() < 0.02, "{told:?} {:?}", pool.boat);
    let told_a_second = pool.navs.len() as f64 / pool.now.as_s();
    assert!((9.0..=11.0).contains(&told_a_second), "{told_a_second}");
}

#[test]
fn thrust_orders_reach_the_thrusters_within_the_limits() {
    let mut pool = Pool::under_way("surveyor.toml", None);
    pool.mind = Some(Order::Thrust { port: 0.5, starboard: 0.1 });
    pool.run(2.0);
    assert_eq!(pool.oracle.last, "$PSEAC,T,0,30,20,*0D\r\n");
    pool.mind = Some(Order::Thrust { port: 1.0, starboard: 1.0 });
    pool.run(2.0);
    assert_eq!(pool.oracle.last, "$PSEAC,T,0,70,0,*3B\r\n");
}

#[test]
fn a_gateway_may_arm_itself_once_and_no_more() {
    let mut pool = Pool::of(plan("surveyor.toml", true), None);
    pool.oracle.armed = true;
    pool.mind = Some(steer(90.0, 1.0));
    pool.run(3.0);
    assert_eq!(pool.state(), "armed");
    pool.mind = None;
    pool.run(3.0);
    assert_eq!(pool.state(), "tripped: no fresh order");
    pool.mind = Some(steer(90.0, 1.0));
    pool.run(5.0);
    assert_eq!((pool.state().as_str(), pool.mode()), ("tripped: no fresh order", 'L'));
    pool.operate(OperatorCommand::Arm);
    assert_eq!(pool.state(), "armed");
}
