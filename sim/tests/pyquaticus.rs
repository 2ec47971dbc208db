//! Games of point boats under Pyquaticus' rules, compared with runs of its own environment (main,
//! November 2025, and the branch of the 2026 competition; power play off, steps of 0.1 s).

mod common;

use common::{order, started, written};
use messages::Order;
use primitives::reseed::Reseed;
use primitives::{Ned, SimTime, VehicleId};
use rules::event::TagCause;
use rules::{Contact, Event, Rules};
use scenario::Scenario;
use sim::Contest;
use std::collections::BTreeMap;
use std::f64::consts::PI;

const BLUE: VehicleId = VehicleId(0);
const RED: VehicleId = VehicleId(1);

/// One boat per side with steps of 0.1 s: blue at (x, y) with a heading in degrees, red out of the
/// way.
fn game(rules: &str, boat: &str, (x, y, heading_deg): (f64, f64, f64)) -> Scenario {
    let scenario = written(&format!(
        "base = \"../games/pav01_kinematic.toml\"\nrules = \"../rules/{rules}.toml\"\n\
         boat = \"../boats/{boat}_kinematic.toml\"\ndecision_s = 0.1\n\
         [[vehicle]]\nname = \"blue_one\"\nteam = \"blue\"\nat = [{x}, {y}]\nheading_deg = {heading_deg}\n\
         [[vehicle]]\nname = \"red_one\"\nteam = \"red\"\nat = [150, 10]\nheading_deg = -90\n"
    ));
    let rules = Rules {
        power_play: SimTime::ZERO,
        ..scenario.rules.clone()
    };
    Scenario { rules, ..scenario }
}

/// One decision of one tick, in which blue's boat follows an order.
fn step(contest: &mut Contest, blue: Order) {
    order(contest, BLUE, blue);
    contest.advance();
}

fn steer(heading_deg: f64, speed_m_s: f64) -> Order {
    Order::Steer {
        heading_rad: heading_deg.to_radians(),
        speed_m_s,
    }
}

/// A boat's position (x, y), speed, and heading in degrees.
fn state(contest: &Contest, vehicle: VehicleId) -> [f64; 4] {
    let boat = &contest.world().state().boats[vehicle.index()];
    [
        boat.pose.at.east,
        boat.pose.at.north,
        boat.nu.surge,
        boat.pose.psi_rad.to_degrees(),
    ]
}

fn assert_near(what: &str, got: [f64; 4], want: [f64; 4], within: f64) {
    assert!(
        got.iter()
            .zip(want)
            .all(|(got, want)| (got - want).abs() < within),
        "{what}: {got:?}, want {want:?}"
    );
}

#[test]
fn a_boat_that_leaves_at_the_side_comes_back_as_soon_as_in_the_competition() {
    // Full ahead from (40, 70) to the north: when the boat leaves the field, how long it stays
    // outside, and when it is untagged. Checks are made at every step of 0.1 s or, as in the
    // competition, at every tenth step.
    for (boat, speed_m_s, looks_s, want_s) in [
        ("heron", 2.0, 0.0, [8.9, 8.8, 28.6]),
        ("heron", 2.0, 1.0, [9.0, 9.0, 29.0]),
        ("surveyor", 3.0, 0.0, [16.3, 16.9, 33.2]),
        ("surveyor", 3.0, 1.0, [17.0, 18.0, 35.0]),
    ] {
        let mut scenario = game("mctf_2026", boat, (40.0, 70.0, 0.0));
        assert_eq!(
            scenario.rules.tag_look_period.as_s(),
            1.0,
            "the period of the competition"
        );
        scenario.rules.tag_look_period = SimTime::from_s(looks_s);
        scenario.rules.flag_look_period = SimTime::from_s(looks_s);
        let mut contest = started(&scenario);
        let mut left_s = 0.0;
        let mut back_s = 0.0;
        let mut freed_s = 0.0;
        while freed_s == 0.0 && contest.now().as_s() < 120.0 {
            let known = contest.events().len();
            // Steer ahead on the present heading, like the actions of Pyquaticus.
            step(
                &mut contest,
                Order::Turn {
                    by_rad: 0.0,
                    speed_m_s,
                },
            );
            for logged in &contest.events()[known..] {
                match logged.event {
                    Event::LeftField(BLUE) => left_s = logged.at.as_s(),
                    Event::ReturnedToField(BLUE) => back_s = logged.at.as_s(),
                    Event::Untagged(BLUE) => freed_s = logged.at.as_s(),
                    _ => {}
                }
            }
        }
        let got_s = [left_s, back_s - left_s, freed_s];
        let is_near = got_s
            .iter()
            .zip(want_s)
            .all(|(got, want)| (got - want).abs() < 0.01);
        assert!(
            is_near,
            "{boat}, looks every {looks_s} s: {got_s:?}, not {want_s:?}"
        );
    }
}

#[test]
fn tags_succeed_at_random_with_the_seed_of_the_game() {
    // Red can attempt a tag every second, with a cooldown of 2 s.
    let mut scenario = game("mctf_2026", "surveyor", (145.0, 15.0, 0.0));
    assert!(!scenario.is_random());
    scenario.rules.tag_probability = 0.25;
    assert!(scenario.is_random());
    scenario.rules.tag_cooldown = SimTime::from_s(2.0);
    let tagged_s = |scenario: &Scenario, seed| {
        let mut contest = Contest::new(scenario, seed).expect("the boats fit");
        while contest.events().is_empty() {
            contest.advance();
        }
        let [first, ..] = contest.events() else {
            panic!("no event")
        };
        assert!(matches!(first.event, Event::Tagged { vehicle: BLUE, .. }));
        first.at.0 as f64 / 1e9
    };
    let all_s: Vec<f64> = (0..400).map(|seed| tagged_s(&scenario, seed)).collect();
    // Geometric: attempts at 1, 3, 5, … s, on average 1 / 0.25 of them; the standard error of the
    // mean is sqrt(1 - 0.25) / 0.25 / 20.
    let attempts = all_s.iter().map(|s| (s + 1.0) / 2.0);
    assert!(attempts.clone().all(|n| n.fract() == 0.0), "{all_s:?}");
    let mean = attempts.sum::<f64>() / all_s.len() as f64;
    assert!((mean - 4.0).abs() < 4.0 * 0.173, "{mean} attempts");
    let again: Vec<f64> = (0..400).map(|seed| tagged_s(&scenario, seed)).collect();
    assert_eq!(again, all_s);
    // A later seed changes only later attempts.
    scenario.reseed = vec![Reseed {
        after_s: 4.0,
        seed: 99,
    }];
    let reseeded = (0..400).map(|seed| tagged_s(&scenario, seed));
    let changed = all_s.iter().zip(reseeded).filter(|(a, b)| **a != *b);
    let changed: Vec<f64> = changed.map(|(a, b)| a.min(b)).collect();
    assert!(
        changed.len() > 100 && changed.iter().all(|s| *s > 4.0),
        "{changed:?}"
    );
}

#[test]
fn a_point_boat_slides_along_the_keepout_circle_as_in_pyquaticus() {
    // Start and constant ordered heading; the first step at which the boat is set back, with x, y,
    // speed and heading then; and x, y at 30 s, long after the boat has passed the flag.
    type Case = (&'static str, (f64, f64, f64), f64, [f64; 4], [f64; 2]);
    let cases: [Case; 6] = [
        (
            "heron",
            (20.0, 25.0, 0.0),
            8.9,
            [20.0, 34.9, 0.0, 90.0],
            [25.63014, 59.421063],
        ),
        (
            "heron",
            (23.0, 25.0, 0.0),
            9.5,
            [23.0, 35.875682, 0.990426, 53.968121],
            [25.65013, 70.038497],
        ),
        (
            "heron",
            (10.0, 36.0, 90.0),
            7.0,
            [16.836142, 36.0, 1.188203, 128.342749],
            [59.091979, 34.361834],
        ),
        (
            "surveyor",
            (20.0, 25.0, 0.0),
            16.3,
            [20.0, 34.9, 0.0, 90.0],
            [23.630539, 36.506268],
        ),
        (
            "surveyor",
            (23.0, 25.0, 0.0),
            17.1,
            [23.0, 35.875682, 0.754412, 53.968121],
            [28.426364, 50.322392],
        ),
        (
            "surveyor",
            (10.0, 36.0, 90.0),
            13.7,
            [16.836142, 36.0, 0.805882, 128.342749],
            [38.955392, 31.435267],
        ),
    ];
    for (boat, start, at_s, want, end) in cases {
        let mut contest = started(&game("pyquaticus", boat, start));
        let speed_m_s = contest.scenario().boat_of(BLUE).speed_max_m_s();
        while contest.now().as_s() < 29.99 {
            step(&mut contest, steer(start.2, speed_m_s));
            if (contest.now().as_s() - at_s).abs() < 0.01 {
                assert_near(
                    &format!("{boat} {start:?}"),
                    state(&contest, BLUE),
                    want,
                    1e-5,
                );
            }
        }
        let [x, y, ..] = state(&contest, BLUE);
        // Pyquaticus has single-precision headings and speeds, and every set-back enlarges the
        // difference.
        assert!(
            (x - end[0]).abs() < 0.01 && (y - end[1]).abs() < 0.01,
            "{boat} {start:?}: ({x}, {y}), not {end:?}"
        );
    }
}

#[test]
fn a_hull_held_at_the_keepout_circle_does_not_go_on_pushing() {
    let mut scenario = game("pyquaticus", "heron", (20.0, 25.0, 0.0));
    scenario.boats = vec![common::boat("heron")];
    let mut contest = started(&scenario);
    for _ in 0..300 {
        step(&mut contest, steer(0.0, 2.0));
        let boat = &contest.world().state().boats[0];
        assert!(
            boat.pose.at.distance(Ned::from_xy(20.0, 40.0)) > 5.0 - 1e-9,
            "{:?}",
            boat.pose
        );
    }
    let boat = &contest.world().state().boats[0];
    assert!(
        boat.pose.at.distance(Ned::from_xy(20.0, 40.0)) < 5.2 && boat.nu.surge.abs() < 0.1,
        "{boat:?}"
    );
}

#[test]
fn boats_pass_through_each_other_where_the_rules_say_so() {
    for contact in [Contact::Ghost, Contact::Solid] {
        let mut scenario = game("pyquaticus", "heron", (100.0, 60.0, 90.0));
        // No boat is close enough to be tagged.
        (scenario.rules.contact, scenario.rules.tag_radius_m) = (contact, 0.1);
        let mut contest = started(&scenario);
        common::set_in(&mut contest, |state| {
            state.boats[1].pose = primitives::Pose {
                at: Ned::from_xy(120.0, 60.5),
                psi_rad: -PI / 2.0,
            };
            state.points[1] = sim::kinematic::KinematicState::at_rest(-PI / 2.0);
        });
        let mut gap_m = f64::INFINITY;
        for _ in 0..200 {
            order(&mut contest, RED, steer(-90.0, 2.0));
            step(&mut contest, steer(90.0, 2.0));
            gap_m = gap_m.min(common::gap_m(contest.world(), &scenario, 0, 1));
        }
        // Their centre lines pass half a metre apart, and the hulls are a metre wide.
        let want_m = if contact == Contact::Ghost {
            -0.5..-0.45
        } else {
            -0.02..0.05
        };
        assert!(want_m.contains(&gap_m), "{contact:?}: {gap_m} m");
        let collided =
            |logged: &rules::event::Logged| matches!(logged.event, Event::Collided { .. });
        assert_eq!(
            contest
                .events()
                .iter()
                .filter(|logged| collided(logged))
                .count(),
            1,
            "{contact:?}"
        );
    }
}

#[test]
fn half_a_turn_is_an_order_of_its_own_to_either_side() {
    // Actions 0 and 8 of Pyquaticus, half a turn at full and at half speed, held from rest: x, y,
    // speed and heading after a few seconds. A turn to port is the mirror image.
    for (boat, speed_m_s, at_s, [x, y, speed, heading_deg]) in [
        (
            "heron",
            2.0,
            3.0,
            [50.21517, 40.155718, 0.188223, 108.030393],
        ),
        ("heron", 2.0, 12.0, [50.081557, 40.114398, 0.3, 48.49927]),
        ("heron", 2.0, 30.0, [50.081557, 40.114398, 0.3, 48.49927]),
        (
            "heron",
            1.0,
            3.0,
            [50.070658, 40.135417, 0.103561, 54.001006],
        ),
        (
            "heron",
            1.0,
            12.0,
            [50.08282, 40.095825, 0.297411, 45.493965],
        ),
        ("heron", 1.0, 30.0, [50.082599, 40.095712, 0.3, 45.493965]),
        (
            "surveyor",
            3.0,
            3.0,
            [50.041019, 40.339859, 0.223125, 13.621031],
        ),
        (
            "surveyor",
            3.0,
            12.0,
            [52.593356, 40.306473, 0.45, 170.444517],
        ),
        (
            "surveyor",
            3.0,
            30.0,
            [52.593356, 40.306473, 0.45, 170.444517],
        ),
        (
            "surveyor",
            1.5,
            3.0,
            [50.014211, 40.236562, 0.15205, 6.750141],
        ),
        (
            "surveyor",
            1.5,
            12.0,
            [51.623766, 41.601201, 0.362435, 97.475],
        ),
        (
            "surveyor",
            1.5,
            30.0,
            [51.441386, 41.600823, 0.45, 88.349223],
        ),
    ] {
        for side in [1.0, -1.0] {
            let mut contest = started(&game("pyquaticus", boat, (50.0, 40.0, 0.0)));
            while contest.now().as_s() < at_s - 0.05 {
                step(
                    &mut contest,
                    Order::Turn {
                        by_rad: side * PI,
                        speed_m_s,
                    },
                );
            }
            let want = [50.0 + side * (x - 50.0), y, speed, side * heading_deg];
            let what = format!("{boat} at {speed_m_s} m/s, side {side}, after {at_s} s");
            assert_near(&what, state(&contest, BLUE), want, 1e-5);
        }
    }
}

/// A game played by Pyquaticus: starting positions, actions at every step, events, final positions.
#[derive(Default)]
struct Trace {
    /// x, y, heading in degrees, by boat.
    starts: Vec<[f64; 3]>,
    /// Action numbers, by step and boat.
    actions: Vec<Vec<usize>>,
    /// Events, by number of steps played.
    events: BTreeMap<usize, Vec<String>>,
    /// x, y, by boat.
    ends: Vec<[f64; 2]>,
}

impl Trace {
    fn read(text: &str) -> Trace {
        let mut trace = Trace::default();
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let words: Vec<&str> = line.split(' ').collect();
            let number = |i: usize| {
                words[i]
                    .parse::<f64>()
                    .unwrap_or_else(|e| panic!("{line}: {e}"))
            };
            match words[0] {
                "start" => trace.starts.push([number(2), number(3), number(4)]),
                "end" => trace.ends.push([number(2), number(3)]),
                "go" => {
                    let actions: Vec<usize> =
                        (2..words.len()).map(|i| number(i) as usize).collect();
                    trace.actions.extend(vec![actions; number(1) as usize]);
                }
                _ => trace
                    .events
                    .entry(trace.actions.len())
                    .or_default()
                    .push(line.to_owned()),
            }
        }
        trace
    }
}

/// The order for a Pyquaticus action: from a half-turn to an eighth of a turn to port, at full and
/// half speed.
fn order_of(action: usize, speed_max_m_s: f64) -> Order {
    let by_rad = (180.0 - 45.0 * (action % 8) as f64).to_radians();
    match action {
        0..8 => Order::Turn {
            by_rad,
            speed_m_s: speed_max_m_s,
        },
        8..16 => Order::Turn {
            by_rad,
            speed_m_s: 0.5 * speed_max_m_s,
        },
        _ => Order::Turn {
            by_rad: 0.0,
            speed_m_s: 0.0,
        },
    }
}

/// The name of an event in the trace.
fn told(event: Event) -> Option<String> {
    Some(match event {
        Event::Tagged {
            vehicle,
            cause: TagCause::Opponent(by),
        } => format!("tag {} {}", by.0, vehicle.0),
        Event::Grabbed { vehicle, .. } => format!("grab {}", vehicle.0),
        Event::Captured { vehicle, .. } => format!("capture {}", vehicle.0),
        Event::LeftField(vehicle) => format!("out {}", vehicle.0),
        Event::ReturnedToField(vehicle) => format!("in {}", vehicle.0),
        Event::Untagged(vehicle) => format!("free {}", vehicle.0),
        _ => return None,
    })
}

#[test]
fn whole_games_go_event_for_event_as_in_pyquaticus() {
    for (boat, text) in [
        ("surveyor", include_str!("pyquaticus/surveyor.txt")),
        ("heron", include_str!("pyquaticus/heron.txt")),
    ] {
        let trace = Trace::read(text);
        let half = trace.starts.len() / 2;
        let vehicles = trace.starts.iter().enumerate().map(|(i, [x, y, heading_deg])| {
            let team = if i < half { "blue" } else { "red" };
            format!("[[vehicle]]\nname = \"b{i}\"\nteam = \"{team}\"\nat = [{x}, {y}]\nheading_deg = {heading_deg}\n")
        });
        let mut scenario = written(&format!(
            "base = \"../games/pav01_kinematic.toml\"\nrules = \"../rules/pyquaticus.toml\"\n\
             boat = \"../boats/{boat}_kinematic.toml\"\ndecision_s = 0.1\n{}",
            vehicles.collect::<String>()
        ));
        // Pyquaticus sets boats back with single-precision headings, and every set-back enlarges
        // the difference.
        scenario.rules.flag_keepout_m = 0.0;
        let mut contest = started(&scenario);
        let speed_max_m_s = scenario.boat_of(BLUE).speed_max_m_s();
        let (mut got, mut known) = (BTreeMap::<usize, Vec<String>>::new(), 0);
        for (step, actions) in trace.actions.iter().enumerate() {
            for (i, action) in actions.iter().enumerate() {
                order(
                    &mut contest,
                    VehicleId::at(i),
                    order_of(*action, speed_max_m_s),
                );
            }
            contest.advance();
            let new: Vec<String> = contest.events()[known..]
                .iter()
                .filter_map(|logged| told(logged.event))
                .collect();
            known = contest.events().len();
            if !new.is_empty() {
                got.insert(step + 1, new);
            }
        }
        let sorted = |events: BTreeMap<usize, Vec<String>>| -> Vec<(usize, String)> {
            let mut events: Vec<_> = events
                .into_iter()
                .flat_map(|(step, words)| words.into_iter().map(move |word| (step, word)))
                .collect();
            events.sort_unstable();
            events
        };
        assert!(trace.events.len() > 30, "{boat}: too few events");
        assert_eq!(sorted(got), sorted(trace.events), "{boat}");
        for (i, [x, y]) in trace.ends.iter().enumerate() {
            let apart_m = contest.world().state().boats[i]
                .pose
                .at
                .distance(Ned::from_xy(*x, *y));
            assert!(
                apart_m < 1e-6,
                "{boat}: boat {i} ends {apart_m} m from its place in Pyquaticus"
            );
        }
    }
}
