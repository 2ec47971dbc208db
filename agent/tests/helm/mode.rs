//! Modes, rules, variables, and the life cycle of behaviours.

use crate::scene::{Boat, alone, decided, helm, picture, scenario, steered, without_safety};
use agent::{HelmMind, Mind};
use messages::helm::{HelmReport, RunState};
use messages::{EventRecord, Word};
use primitives::{SimTime, VehicleId};
use rules::event::{Event, Logged, TagCause};

const PROGRAM: &str = include_str!("mode.toml");

fn variable(report: &HelmReport, name: &str) -> String {
    report
        .variables
        .iter()
        .find(|variable| variable.name == name)
        .expect("the variable exists")
        .value
        .clone()
}

fn run_state(report: &HelmReport, name: &str) -> RunState {
    report
        .behaviours
        .iter()
        .find(|behaviour| behaviour.name == name)
        .expect("the behaviour exists")
        .run_state
}

fn at(helm: &mut HelmMind, at_s: f64, x: f64) -> HelmReport {
    decided(helm, &alone(at_s, Boat::at(x, 0.0)))
}

#[test]
fn the_first_mode_whose_condition_holds_is_the_one() {
    let mut helm = helm(&without_safety(PROGRAM));
    assert_eq!(at(&mut helm, 0.0, -30.0).mode, "home");
    assert_eq!(at(&mut helm, 0.1, 30.0).mode, "away:roam");
    let mut tagged = alone(0.2, Boat::at(30.0, 0.0));
    tagged.own[0].tagged = true;
    assert_eq!(decided(&mut helm, &tagged).mode, "tagged");
}

#[test]
fn every_shipped_strategy_takes_a_flag_home() {
    // The medium defender may come across a flag while pursuing; once, it held its station while
    // carrying one.
    for strategy in [
        "easy_attacker",
        "medium_attacker",
        "medium_defender",
        "observer",
        "options",
        "strategy_4",
        "strategy_5",
        "strategy_6",
    ] {
        let mut helm = helm(&scenario(&format!(
            "base = \"SCENARIOS/strategies/{strategy}.toml\"\n"
        )));
        let mut carrying = alone(0.0, Boat::at(30.0, 0.0));
        carrying.own[0].carrying = 1;
        assert_eq!(
            decided(&mut helm, &carrying).mode,
            "returning",
            "{strategy}"
        );
    }
}

#[test]
fn events_and_conditions_give_values_to_variables() {
    let mut helm = helm(&without_safety(PROGRAM));
    assert_eq!(variable(&at(&mut helm, 0.0, 30.0), "alarmed"), "false");
    for (vehicle, want) in [(0, "false"), (2, "false"), (1, "true")] {
        let mut tagged = alone(0.1, Boat::at(30.0, 0.0));
        let event = Event::Tagged {
            vehicle: VehicleId(vehicle),
            cause: TagCause::Boundary,
        };
        tagged.events = vec![EventRecord::from(Logged {
            tick: 2,
            at: SimTime::ZERO,
            event,
        })];
        assert_eq!(
            variable(&decided(&mut helm, &tagged), "alarmed"),
            want,
            "vehicle {vehicle}"
        );
    }
    let alarm = at(&mut helm, 0.2, 30.0);
    assert_eq!(
        (alarm.mode.as_str(), variable(&alarm, "phase").as_str()),
        ("away:alarm", "rest")
    );
    let later = at(&mut helm, 100.0, 30.0);
    assert_eq!(
        (
            variable(&later, "alarmed").as_str(),
            variable(&later, "laps").as_str()
        ),
        ("false", "10")
    );
}

#[test]
fn behaviours_live_and_post() {
    let mut helm = helm(&without_safety(PROGRAM));
    let first = at(&mut helm, 0.0, -30.0);
    assert_eq!(
        (run_state(&first, "drive"), run_state(&first, "rest")),
        (RunState::Active, RunState::Active)
    );
    // The duration is over.
    assert_eq!(
        run_state(&at(&mut helm, 0.9, -30.0), "rest"),
        RunState::Active
    );
    assert_eq!(
        run_state(&at(&mut helm, 1.0, -30.0), "rest"),
        RunState::Complete
    );
    // Each point reached counts; after the last one, the list restarts.
    for (at_s, x, laps) in [
        (2.0, -1.0, "1"),
        (3.0, 9.0, "2"),
        (4.0, 9.0, "2"),
        (5.0, 1.0, "3"),
    ] {
        assert_eq!(variable(&at(&mut helm, at_s, x), "laps"), laps, "{at_s} s");
    }
    let done = at(&mut helm, 6.0, -30.0);
    assert_eq!(
        (run_state(&done, "drive"), done.hold.as_deref()),
        (RunState::Idle, Some("no behaviour has a preference"))
    );
}

#[test]
fn mates_count_when_they_have_sent_everything_that_is_asked() {
    let scenario = without_safety(PROGRAM);
    let mut mine = helm(&scenario);
    let mut words = vec![];
    let weight = |helm: &mut HelmMind| {
        let report = at(helm, 0.0, -30.0);
        report
            .behaviours
            .iter()
            .find(|behaviour| behaviour.name == "rest")
            .expect("the behaviour exists")
            .weight
    };
    assert_eq!(weight(&mut mine), 1.0);
    let mate = HelmMind::new(
        &scenario,
        VehicleId(1),
        agent::roles::role_of(&scenario, VehicleId(1)),
    );
    mate.send(&mut words);
    assert_eq!(words.len(), 2, "two variables are shared");
    assert!(words.iter().all(|word| word.vehicle == VehicleId(1)));
    let sent = |laps: f64, phase: f64| {
        [
            Word {
                value: laps,
                ..words[0]
            },
            Word {
                value: phase,
                ..words[1]
            },
        ]
    };
    for (received, want) in [
        (&sent(2.0, 1.0)[..1], 1.0),
        (&sent(2.0, 0.0)[..], 1.0),
        (&sent(2.0, 1.0)[..], 101.0),
        (&sent(f64::NAN, 1.0)[..], 101.0),
        (&sent(1.0, 1.0)[..], 1.0),
    ] {
        mine.receive(received);
        assert_eq!(weight(&mut mine), want, "{received:?}");
    }
    // Messages from a boat that is not a teammate, and messages about an unknown variable.
    mine.receive(&[
        Word {
            vehicle: VehicleId(2),
            ..sent(5.0, 1.0)[0]
        },
        Word {
            key: 7,
            ..sent(5.0, 1.0)[0]
        },
    ]);
    assert_eq!(weight(&mut mine), 1.0);
}

#[test]
fn a_collision_is_one_for_both_boats() {
    let rule = |who: &str| {
        format!(
            "[variables]\nhit = 0\n\
             [[rule]]\non = \"{who} collides\"\nset = {{ hit = \"hit + 1\" }}\n[behaviour.wait]\nkind = \"full_stop\"\n"
        )
    };
    let mut seen = alone(1.0, Boat::at(-20.0, 0.0));
    for (first, second, who, want) in [
        (0, 2, "i", 1.0),
        (0, 2, "enemy", 1.0),
        (0, 2, "mate", 0.0),
        (1, 3, "mate", 1.0),
        (1, 3, "i", 0.0),
    ] {
        let event = Event::Collided {
            first: VehicleId(first),
            second: VehicleId(second),
        };
        seen.events = vec![EventRecord::from(Logged {
            tick: 2,
            at: SimTime::ZERO,
            event,
        })];
        let report = decided(&mut helm(&without_safety(&rule(who))), &seen);
        assert_eq!(
            report.variables[0].value,
            want.to_string(),
            "{first} and {second}: {who}"
        );
    }
}

#[test]
fn a_behaviour_reaches_the_end_of_its_time_and_time_is_counted_from_the_first_picture() {
    let reached =
        "[behaviour.wait]\nkind = \"timer\"\nduration_s = 5\non_reach = { it = \"it + 1\" }\n";
    let waited_s = "[[rule]]\nwhen = \"true\"\nset = { it = \"it + step_s\" }\n";
    for (program, steps) in [
        (
            reached,
            [(0.0, "0"), (4.9, "0"), (5.0, "1"), (9.0, "1")].as_slice(),
        ),
        (waited_s, &[(300.0, "0"), (300.5, "0.5"), (301.0, "1")]),
    ] {
        let stop = "[behaviour.stop]\nkind = \"full_stop\"\n";
        let mut mind = helm(&without_safety(&format!(
            "[variables]\nit = 0\n{program}{stop}"
        )));
        for (at_s, want) in steps {
            let report = decided(&mut mind, &alone(*at_s, Boat::at(0.0, 0.0)));
            assert_eq!(report.variables[0].value, *want, "{program} at {at_s} s");
        }
    }
}

/// North or south: on the boat's own side one has a slightly higher utility, beyond it the other.
const TWO_WAYS: &str = "[behaviour.speed]\nkind = \"constant_speed\"\nspeed_m_s = 2\nweight = 10\n\
    [behaviour.north]\nkind = \"constant_heading\"\nheading_deg = 0\nbase_width_deg = 60\nweight = \"own_side ? 50 : 49\"\n\
    [behaviour.south]\nkind = \"constant_heading\"\nheading_deg = 180\nbase_width_deg = 60\nweight = \"own_side ? 49 : 50\"\n";

#[test]
fn of_two_ways_that_are_nearly_as_good_a_steady_helm_takes_the_one_it_is_on() {
    for (hysteresis, turns) in [(0.0, 9), (0.01, 9), (0.03, 0)] {
        let mut helm = helm(&without_safety(&format!(
            "helm = {{ hysteresis = {hysteresis} }}\n{TWO_WAYS}"
        )));
        let mut course_deg = |i: u32| {
            let own = Boat::at(if i.is_multiple_of(2) { -1.0 } else { 1.0 }, 0.0);
            steered(&mut helm, &alone(f64::from(i) * 0.1, own)).0
        };
        let courses: Vec<f64> = (0..10).map(&mut course_deg).collect();
        let got = courses
            .windows(2)
            .filter(|pair| (pair[0] - pair[1]).abs() > 90.0)
            .count();
        assert_eq!(got, turns, "hysteresis {hysteresis}: {courses:?}");
    }
}

#[test]
fn a_steady_helm_follows_what_moves_and_turns_round_for_what_is_better() {
    let go = "[behaviour.go]\nkind = \"waypoint\"\npoints = [[60, 0]]\nspeed_m_s = 2\n";
    let mut mind = helm(&without_safety(&format!(
        "helm = {{ hysteresis = 0.1 }}\n{go}"
    )));
    assert!((steered(&mut mind, &alone(0.0, Boat::at(0.0, 0.0))).0 - 90.0).abs() < 0.51);
    // From this position the point bears 100 degrees, and from behind it 270.
    let report = decided(&mut mind, &alone(0.1, Boat::at(0.0, 60.0 * 0.176_326_98)));
    assert!(
        (report.course_deg.expect("a course") - 100.0).abs() < 0.51,
        "{report:?}"
    );
    assert!(
        (report.value.expect("a value") - 100.0 * 100.0).abs() < 50.0,
        "the report includes the steadiness bonus: {report:?}"
    );
    let behind = steered(&mut mind, &alone(0.2, Boat::at(75.0, 0.0)));
    assert!((behind.0 - 270.0).abs() < 0.51, "{behind:?}");
}

#[test]
fn a_boat_that_is_not_in_the_picture_holds() {
    let mut helm = helm(&without_safety(PROGRAM));
    let mut without = picture(0.0, [Boat::at(0.0, 0.0); 2], [Boat::at(50.0, 0.0); 2]);
    without.own.remove(0);
    assert_eq!(
        decided(&mut helm, &without).hold.as_deref(),
        Some("this boat is missing from the picture")
    );
}
