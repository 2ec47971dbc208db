//! Sightings compared with the scenario's settings: range, field of view, delay, noise, loss and
//! memory; they are lost or delayed together with the report that carries them.

mod common;

use common::{alone, order, started};
use messages::Order;
use messages::picture::Contact;
use primitives::angle::rad_from_compass_deg;
use primitives::{Ned, Pose, SimTime, VehicleId};
use rules::Sharing;
use scenario::link::{Link, Loss};
use scenario::{Scenario, StartPosition};
use sim::Contest;

const BLUE: VehicleId = VehicleId(0);
const RED: VehicleId = VehicleId(1);
const DECISION: SimTime = SimTime(100_000_000);

/// Settings without delay, error or loss that still differ from the default.
fn clear_sight() -> Sharing {
    Sharing {
        range_m: Some(1e6),
        memory_s: 1e4,
        ..Sharing::default()
    }
}

fn start_position((x, y, heading_deg): (f64, f64, f64)) -> StartPosition {
    StartPosition::At(Pose {
        at: Ned::from_xy(x, y),
        psi_rad: rad_from_compass_deg(heading_deg),
    })
}

/// One boat per side, at x (m), y (m) and a compass heading (deg).
fn facing(sharing: Sharing, blue: (f64, f64, f64), red: (f64, f64, f64)) -> Scenario {
    let mut scenario = alone("surveyor_m1_8", "calm");
    scenario.rules.sharing = sharing;
    scenario.rules.time_limit = SimTime::from_s(80_000.0);
    scenario.vehicles[BLUE.index()].start_position = start_position(blue);
    scenario.vehicles[RED.index()].start_position = start_position(red);
    scenario
}

/// Blue's contact for red.
fn shown(contest: &mut Contest) -> Option<Contact> {
    contest.pictures()[0]
        .contacts
        .iter()
        .find(|contact| contact.vehicle == RED)
        .copied()
}

fn at(contact: &Contact) -> Ned {
    Ned {
        north: contact.north_m,
        east: contact.east_m,
    }
}

fn place(contest: &Contest, vehicle: VehicleId) -> Ned {
    contest.world().state().boats[vehicle.index()].pose.at
}

#[test]
fn a_boat_is_seen_within_the_range_and_not_beyond() {
    for (distance_m, is_seen) in [(20.0, true), (99.9, true), (100.1, false), (300.0, false)] {
        let sharing = Sharing {
            range_m: Some(100.0),
            ..clear_sight()
        };
        let mut contest = started(&facing(
            sharing,
            (300.0, 200.0, 0.0),
            (300.0 + distance_m, 200.0, 0.0),
        ));
        assert_eq!(shown(&mut contest).is_some(), is_seen, "{distance_m} m off");
    }
}

#[test]
fn a_boat_is_seen_within_the_angle_of_view_whatever_the_heading() {
    for (view_deg, edge_deg) in [(120.0_f64, 60.0), (350.0, 175.0), (10.0, 5.0)] {
        for heading_deg in [0.0, 90.0, 175.0, 179.0, 180.0, 181.0, 270.0, 359.0] {
            for off_bow_deg in [0.0, edge_deg - 0.5, edge_deg + 0.5, 180.0] {
                for side in [-1.0, 1.0] {
                    let sharing = Sharing {
                        view_rad: Some(view_deg.to_radians()),
                        ..clear_sight()
                    };
                    let bearing_rad = rad_from_compass_deg(heading_deg + side * off_bow_deg);
                    let (sin, cos) = primitives::math::sin_cos(bearing_rad);
                    let red = (400.0 + 50.0 * sin, 200.0 + 50.0 * cos, 0.0);
                    let mut contest = started(&facing(sharing, (400.0, 200.0, heading_deg), red));
                    assert_eq!(
                        shown(&mut contest).is_some(),
                        off_bow_deg < edge_deg,
                        "view {view_deg}, heading {heading_deg}, {} off the bow",
                        side * off_bow_deg
                    );
                }
            }
        }
    }
}

#[test]
fn a_report_tells_the_truth_of_as_long_ago_as_stated() {
    let late = 15;
    let sharing = Sharing {
        delay_s: 1.5,
        ..clear_sight()
    };
    let mut contest = started(&facing(sharing, (300.0, 200.0, 0.0), (500.0, 200.0, 90.0)));
    let mut past = vec![];
    for k in 0..200 {
        past.push((contest.now(), place(&contest, RED)));
        let want = (k >= late).then(|| past[k - late]);
        assert_eq!(
            shown(&mut contest).map(|contact| (contact.seen_ns, at(&contact))),
            want,
            "at decision {k}"
        );
        order(
            &mut contest,
            RED,
            Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 2.0,
            },
        );
        contest.advance();
    }
    assert!(past[0].1.distance(past[199].1) > 20.0, "red did not move");
}

#[test]
fn reports_err_by_the_stated_noise_and_anew_each_time() {
    const REPORTS: usize = 20_000;
    let noise_m = 3.0;
    let velocity_noise_m_s = 0.5;
    let sharing = Sharing {
        noise_m,
        velocity_noise_m_s,
        ..clear_sight()
    };
    let mut contest = started(&facing(sharing, (300.0, 200.0, 0.0), (500.0, 200.0, 90.0)));
    // Errors in standard deviations.
    let mut errors: [Vec<f64>; 4] = Default::default();
    for _ in 0..REPORTS {
        let off = at(&shown(&mut contest).unwrap()) - place(&contest, RED);
        let contact = shown(&mut contest).unwrap();
        let velocity = (contact.velocity_north_m_s, contact.velocity_east_m_s);
        assert_eq!(
            contest.world().state().boats[RED.index()].nu,
            sim::hull::Planar::default(),
            "red is at rest"
        );
        errors[0].push(off.north / noise_m);
        errors[1].push(off.east / noise_m);
        errors[2].push(velocity.0 / velocity_noise_m_s);
        errors[3].push(velocity.1 / velocity_noise_m_s);
        contest.advance();
    }
    let mean = |f: &dyn Fn(usize) -> f64| common::mean_of(REPORTS - 1, f);
    // Five standard errors each.
    let within = 5.0 / (REPORTS as f64).sqrt();
    for (axis, error) in errors.iter().enumerate() {
        let next = &errors[(axis + 1) % 4];
        assert!(mean(&|i| error[i]).abs() < within, "axis {axis}");
        assert!(
            (mean(&|i| error[i] * error[i]) - 1.0).abs() < within * 2.0_f64.sqrt(),
            "axis {axis}"
        );
        assert!(
            mean(&|i| error[i] * error[i + 1]).abs() < within,
            "axis {axis}: correlated over time"
        );
        assert!(
            mean(&|i| error[i] * next[i]).abs() < within,
            "axis {axis}: correlated with the other axis"
        );
    }
}

#[test]
fn the_stated_share_of_reports_is_lost() {
    const REPORTS: u32 = 20_000;
    let sharing = Sharing {
        loss: 0.3,
        memory_s: 0.0,
        ..clear_sight()
    };
    let mut contest = started(&facing(sharing, (300.0, 200.0, 0.0), (500.0, 200.0, 90.0)));
    let mut lost = 0;
    for _ in 0..REPORTS {
        lost += u32::from(shown(&mut contest).is_none());
        contest.advance();
    }
    let share = f64::from(lost) / f64::from(REPORTS);
    // Five standard errors.
    assert!(
        (share - 0.3).abs() < 5.0 * (0.21 / f64::from(REPORTS)).sqrt(),
        "{share}"
    );
}

#[test]
fn a_contact_is_remembered_as_long_as_stated() {
    let memory_s = 4.05;
    let sharing = Sharing {
        range_m: Some(100.0),
        memory_s,
        ..clear_sight()
    };
    let mut contest = started(&facing(sharing, (300.0, 200.0, 0.0), (395.0, 200.0, 90.0)));
    let mut last_seen = SimTime::ZERO;
    let mut remembered = 0;
    let mut forgotten = 0;
    for k in 0..300 {
        let now = contest.now();
        let is_near = place(&contest, BLUE).distance(place(&contest, RED)) <= 100.0;
        if is_near {
            last_seen = now;
        }
        let is_known = (now - last_seen).as_s() <= memory_s;
        remembered += u32::from(is_known && !is_near);
        forgotten += u32::from(!is_known);
        assert_eq!(
            shown(&mut contest).map(|contact| contact.seen_ns),
            is_known.then_some(last_seen),
            "at {k}"
        );
        order(
            &mut contest,
            RED,
            Order::Steer {
                heading_rad: std::f64::consts::FRAC_PI_2,
                speed_m_s: 2.0,
            },
        );
        contest.advance();
    }
    assert_eq!(remembered, 40, "4.05 s are 40 decisions");
    assert!(forgotten > 100);
}

#[test]
fn sightings_are_late_or_lost_with_the_report_of_the_boat_that_saw() {
    let loss = Loss {
        good: 0.2,
        bad: 0.9,
        good_time_s: 5.0,
        bad_time_s: 2.0,
    };
    let mut scenario = facing(clear_sight(), (300.0, 200.0, 0.0), (500.0, 200.0, 90.0));
    scenario.link = Some(Link {
        delay_s: 0.25,
        jitter_s: 0.3,
        loss,
        range_m: None,
        station: Ned::default(),
    });
    let mut contest = started(&scenario);
    let mut seen = 0;
    let mut stale = 0;
    for k in 0..5_000 {
        let reported = contest.pictures()[0].own[0].fix_ns;
        match shown(&mut contest) {
            Some(contact) => {
                assert_eq!(contact.seen_ns, reported, "at decision {k}");
                seen += 1;
                stale += u32::from(contest.now() - reported > DECISION * 10);
            }
            None => assert_eq!(reported, SimTime::ZERO, "at decision {k}"),
        }
        contest.advance();
    }
    assert!(seen > 4_900 && stale > 100, "{seen} {stale}");
}

#[test]
fn a_boat_out_of_radio_range_tells_nobody_what_it_sees() {
    for (range_m, is_told) in [(Some(100.0), false), (Some(200.0), true), (None, true)] {
        // blue_one is at the station and sees nothing; blue_two, 140 m away, sees red.
        let sharing = Sharing {
            range_m: Some(50.0),
            ..clear_sight()
        };
        let mut scenario = facing(sharing, (400.0, 200.0, 0.0), (560.0, 200.0, 90.0));
        let mut second = scenario.vehicles[BLUE.index()].clone();
        second.name = "blue_two".to_owned();
        second.start_position = start_position((540.0, 200.0, 0.0));
        scenario.vehicles.push(second);
        let station = Ned::from_xy(400.0, 200.0);
        scenario.link = Some(Link {
            delay_s: 0.0,
            jitter_s: 0.0,
            loss: Loss::default(),
            range_m,
            station,
        });
        let mut contest = started(&scenario);
        for k in 0..50_i64 {
            assert_eq!(
                shown(&mut contest).is_some(),
                is_told,
                "range {range_m:?}, decision {k}"
            );
            let heard: Vec<SimTime> = contest.pictures()[0]
                .own
                .iter()
                .map(|own| own.fix_ns)
                .collect();
            let second = if is_told { DECISION * k } else { SimTime::ZERO };
            assert_eq!(
                heard,
                [DECISION * k, second],
                "range {range_m:?}, decision {k}"
            );
            contest.advance();
        }
    }
}

#[test]
fn the_referee_announces_a_carrier_that_nobody_sees() {
    let mut scenario = facing(
        Sharing {
            range_m: Some(1.0),
            ..clear_sight()
        },
        (400.0, 100.0, 0.0),
        (0.0, 0.0, 0.0),
    );
    let flag = scenario.field.flags[0].start;
    scenario.vehicles[RED.index()].start_position = StartPosition::At(Pose {
        at: flag,
        psi_rad: 0.0,
    });
    let mut contest = started(&scenario);
    contest.advance();
    assert_eq!(shown(&mut contest), None);
    assert_eq!(contest.pictures()[0].flags[0].carrier, i32::from(RED.0));
}
