//! Tests the rates at which orders become sentences, and sentences become reports.

use crate::script::played;
use gateway::bridge::Input;
use messages::Order;
use primitives::SimTime;

fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer {
        heading_rad: heading_deg.to_radians(),
        speed_m_s,
    }
}

#[test]
fn ten_thousand_orders_a_second_become_twenty_sentences() {
    let mut rig = played("under-way\norder none");
    let start = rig.now;
    let before = rig.oracle.all;
    let mut last_deg = 0.0;
    for i in 0..300 {
        for k in 0..100 {
            last_deg = f64::from((i * 100 + k) % 360);
            let given = start + SimTime(i64::from(i) * 10_000_000 + i64::from(k) * 1000 + 1);
            rig.give(&Input::Order(steer(last_deg, 1.0), given));
        }
        rig.run(0.01);
    }
    let a_second = (rig.oracle.all - before) as f64 / 3.0;
    assert!(
        (15.0..=25.0).contains(&a_second),
        "{a_second} with the last at {last_deg}"
    );
    assert_eq!(rig.bridge.state().to_string(), "armed");
}

#[test]
fn a_new_order_does_not_wait_for_the_period_of_repetitions() {
    let mut rig = played("under-way\norder none");
    for i in 0..30 {
        // Orders arrive ten times a second, at varying times between the repetitions.
        rig.run(0.1 + 0.01 * f64::from(i % 3));
        let order = steer(f64::from(90 + i), 1.5);
        let given = rig.now + SimTime(1);
        let before = rig.sent.len();
        rig.give(&Input::Order(order, given));
        assert_eq!(rig.sent.len(), before + 1, "{i}: sent in the same step");
    }
}

#[test]
fn navigation_reports_agree_with_the_boat() {
    let rig = played("under-way\nrun 5");
    let (_, report) = rig.navs.last().expect("it is reported");
    let apart_m = report.nav.at().distance(rig.boat.at);
    // Minutes have five decimal places: 18.5 mm in latitude.
    assert!(apart_m < 0.05 && report.valid, "{apart_m} m, {report:?}");
    // The compass reading is magnetic, the sim's heading true.
    assert!(
        (report.nav.psi_rad - rig.boat.psi_rad).abs() < 0.002,
        "{report:?} {:?}",
        rig.boat
    );
    assert!(
        (report.nav.surge_m_s - rig.boat.speed_m_s).abs() < 0.02,
        "{report:?} {:?}",
        rig.boat
    );
    let reports_per_s = rig.navs.len() as f64 / rig.now.as_s();
    assert!((9.0..=11.0).contains(&reports_per_s), "{reports_per_s}");
}
