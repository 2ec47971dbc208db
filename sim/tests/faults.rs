//! Faults during a game: they affect the right boat at the right time, and end.

mod common;

use common::scenarios;
use messages::Order;
use primitives::{SimTime, VehicleId};
use rules::event::Event;
use scenario::{Overrides, Scenario, Setting, load_with};
use sim::Contest;

const HIT: VehicleId = VehicleId(0);
const SPARED: VehicleId = VehicleId(1);

/// Two against two; the first boat has a fault from 20 s to 40 s.
fn scenario(kind: &str, more: &str) -> Scenario {
    let fault = format!(
        "fault.tried={{ kind = \"{kind}\", boats = [\"blue_1\"], at_s = 20, for_s = 20{more} }}"
    );
    let overrides = Overrides {
        settings: vec![Setting::parse(&fault).expect("the fault is valid")],
        ..Overrides::default()
    };
    load_with(&scenarios().join("games/surveyor_2v2.toml"), &overrides)
        .unwrap_or_else(|problems| panic!("{problems}"))
        .of_seed(3)
        .expect("the fault is valid")
}

/// Plays until a time; all boats steer a slow circle.
fn play_to(contest: &mut Contest, until_s: f64) {
    while contest.now() < SimTime::from_s(until_s) {
        let at = contest.pictures()[0].stamp.valid_ns;
        for i in 0..4 {
            let heading_rad = 0.05 * at.as_s();
            contest
                .order(
                    VehicleId(i),
                    Order::Steer {
                        heading_rad,
                        speed_m_s: 2.0,
                    },
                    at,
                )
                .expect("the order is valid");
        }
        contest.advance();
    }
}

fn speed_m_s(contest: &Contest, vehicle: VehicleId) -> f64 {
    contest.world().state().boats[vehicle.index()].nu.surge
}

/// Errors of a boat's reported position (m) and of its compass heading (rad).
fn errors(contest: &Contest, vehicle: VehicleId) -> (f64, f64) {
    let pose = contest.world().state().boats[vehicle.index()].pose;
    let nav = contest
        .world()
        .reading(vehicle)
        .expect("the boat has sensors")
        .nav;
    (
        nav.at().distance(pose.at),
        primitives::angle::wrap_pi(nav.psi_rad - pose.psi_rad),
    )
}

#[test]
fn an_agent_that_is_lost_leaves_its_boat_holding_until_it_is_back() {
    let scenario = scenario("agent_lost", "");
    let mut contest = Contest::new(&scenario, 3).unwrap();
    play_to(&mut contest, 19.9);
    assert!(speed_m_s(&contest, HIT) > 1.0);
    play_to(&mut contest, 39.0);
    assert!(speed_m_s(&contest, HIT) < 0.5 && speed_m_s(&contest, SPARED) > 1.0);
    play_to(&mut contest, 50.0);
    assert!(speed_m_s(&contest, HIT) > 1.0);
    let told: Vec<(f64, bool)> = contest
        .events()
        .iter()
        .filter_map(|logged| match logged.event {
            Event::AgentLost(HIT) => Some((logged.at.as_s(), true)),
            Event::AgentBack(HIT) => Some((logged.at.as_s(), false)),
            Event::AgentLost(other) | Event::AgentBack(other) => panic!("{other:?} has no fault"),
            _ => None,
        })
        .collect();
    assert_eq!(told, [(20.0, true), (40.0, false)]);
}

#[test]
fn without_its_link_a_boat_is_neither_heard_nor_ordered() {
    let scenario = scenario("link_lost", "");
    let mut contest = Contest::new(&scenario, 3).unwrap();
    let known = |contest: &mut Contest, i: usize| contest.pictures()[0].own[i].nav;
    play_to(&mut contest, 21.0);
    let before = [0, 1].map(|i| known(&mut contest, i));
    play_to(&mut contest, 39.0);
    assert_eq!(known(&mut contest, 0), before[0]);
    assert_ne!(known(&mut contest, 1), before[1]);
    // Its last order has expired, so it holds.
    assert!(speed_m_s(&contest, HIT) < 0.5 && speed_m_s(&contest, SPARED) > 1.0);
    play_to(&mut contest, 50.0);
    assert_ne!(known(&mut contest, 0), before[0]);
    assert!(speed_m_s(&contest, HIT) > 1.0);
}

#[test]
fn a_receiver_freezes_falls_silent_and_errs_at_its_time() {
    for (kind, more, least_m) in [
        ("gps_frozen", "", 8.0),
        ("gps_lost", "", 8.0),
        ("gps_offset", ", offset_m = 25", 20.0),
    ] {
        let scenario = scenario(kind, more);
        let mut contest = Contest::new(&scenario, 3).unwrap();
        play_to(&mut contest, 19.9);
        assert!(
            errors(&contest, HIT).0 < 8.0,
            "{kind}: {:?}",
            errors(&contest, HIT)
        );
        let mut most_m: f64 = 0.0;
        for tenth in 210..395 {
            play_to(&mut contest, f64::from(tenth) / 10.0);
            most_m = most_m.max(errors(&contest, HIT).0);
            assert!(errors(&contest, SPARED).0 < 8.0, "{kind}");
        }
        assert!(most_m > least_m && most_m < 60.0, "{kind}: {most_m} m");
        play_to(&mut contest, 45.0);
        assert!(
            errors(&contest, HIT).0 < 8.0,
            "{kind}: {:?}",
            errors(&contest, HIT)
        );
    }
}

#[test]
fn a_compass_is_off_by_what_is_said_at_its_time() {
    let with = scenario("compass_offset", ", offset_deg = 30");
    let without = scenario("agent_lost", "");
    let [mut with, mut without] =
        [with, without].map(|scenario| Contest::new(&scenario, 3).unwrap());
    for contest in [&mut with, &mut without] {
        play_to(contest, 20.1);
    }
    // The boats have barely separated, so the readings differ by the fault.
    let off = |contest: &Contest| errors(contest, HIT).1;
    assert!(
        (off(&with) - off(&without) - 30_f64.to_radians()).abs() < 0.05,
        "{} {}",
        off(&with),
        off(&without)
    );
    play_to(&mut with, 41.0);
    assert!(off(&with).abs() < 0.3);
}

#[test]
fn a_thruster_stands_still_or_goes_on_as_it_went() {
    for (kind, is_stuck) in [("port_lost", false), ("starboard_stuck", true)] {
        let scenario = scenario(kind, "");
        let mut contest = Contest::new(&scenario, 3).unwrap();
        let shaft = |contest: &Contest| {
            let boat = &contest.world().state().boats[HIT.index()];
            if is_stuck {
                boat.starboard.command
            } else {
                boat.port.command
            }
        };
        play_to(&mut contest, 20.0);
        let before = shaft(&contest);
        assert!(before != 0.0);
        let mut seen = vec![];
        for tenth in 230..395 {
            play_to(&mut contest, f64::from(tenth) / 10.0);
            seen.push(shaft(&contest));
        }
        let want = if is_stuck { before } else { 0.0 };
        assert!(
            seen.iter()
                .all(|command| (command - want).abs() < 1e-9 * before.abs()),
            "{kind}: {seen:?}, not {want}"
        );
        play_to(&mut contest, 45.0);
        assert!(shaft(&contest) != want, "{kind}");
    }
}

#[test]
fn a_fault_that_cannot_be_is_refused_with_its_place() {
    for (game, fault, want) in [
        (
            "surveyor_2v2",
            "{ kind = \"link_lost\" }",
            "has neither at_s nor every_s",
        ),
        (
            "surveyor_2v2",
            "{ kind = \"link_lost\", at_s = 1, every_s = 2 }",
            "has both at_s and every_s",
        ),
        (
            "surveyor_2v2",
            "{ kind = \"gps_offset\", at_s = 1 }",
            "offset_m is missing",
        ),
        (
            "surveyor_2v2",
            "{ kind = \"gps_lost\", at_s = 1, offset_deg = 3 }",
            "offset_deg is given",
        ),
        (
            "surveyor_2v2",
            "{ kind = \"sunk\", at_s = 1 }",
            "kind is \"sunk\"",
        ),
        (
            "surveyor_2v2",
            "{ kind = \"gps_lost\", at_s = 1, boats = [\"blue_7\"] }",
            "boats has \"blue_7\"",
        ),
        (
            "pyquaticus_2v2",
            "{ kind = \"port_lost\", at_s = 1 }",
            "has no thrusters",
        ),
        (
            "pyquaticus_2v2",
            "{ kind = \"gps_lost\", at_s = 1 }",
            "has no gps",
        ),
    ] {
        let setting = Setting::parse(&format!("fault.tried={fault}")).unwrap();
        let overrides = Overrides {
            settings: vec![setting],
            ..Overrides::default()
        };
        let said = load_with(&scenarios().join(format!("games/{game}.toml")), &overrides)
            .expect_err(fault)
            .to_string();
        assert!(said.contains(want), "{fault}: {said}");
    }
}
